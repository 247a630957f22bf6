/// The vertices of the pore pressure: their numbers, links and pattern, and the entries of tiles that belong to them.
#include "physics/two_phase/pressure_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>

namespace sluice {
namespace {

constexpr int margin = 2;  // cells beyond the wet ones

template <int Dim>
GridGeometry<Dim> geometry(int cells) {
  GridGeometry<Dim> g;
  g.min.fill(0);
  g.cell.fill(0.5);
  g.cells.fill(cells);
  g.max.fill(0.5 * cells);
  return g;
}

/// Two clouds of cells far from each other, one of them in a corner of the grid.
template <int Dim>
std::vector<Index<Dim>> wet_cells(int cells) {
  std::mt19937 generator(3);
  std::vector<Index<Dim>> wet;
  for (int n = 0; n < 40; ++n) {
    Index<Dim> place;
    for (int a = 0; a < Dim; ++a) {
      const int near = static_cast<int>(generator() % 4);
      place[a] = n % 2 == 0 ? near : cells - 8 + near;
    }
    wet.push_back(place);
  }
  return wet;
}

template <int Dim>
int distance(const Index<Dim>& i, const Index<Dim>& j) {
  int largest = 0;
  for (int a = 0; a < Dim; ++a) largest = std::max(largest, std::abs(i[a] - j[a]));
  return largest;
}

template <int Dim>
Index<Dim> shifted(Index<Dim> place, int number, int width, int by) {
  for (int a = 0; a < Dim; ++a, number /= width) place[a] += number % width + by;
  return place;
}

/// Calls check(grid, wet cells, geometry) for a pressure grid of each dimension.
template <int Dim, class Check>
void with_grid(const Check& check) {
  SCOPED_TRACE(std::to_string(Dim) + "-D");
  const int cells = Dim == 2 ? 40 : 22;
  PressureGrid<Dim> grid;
  EXPECT_TRUE(grid.empty());
  const auto wet = wet_cells<Dim>(cells);
  grid.build(wet, geometry<Dim>(cells));
  EXPECT_FALSE(grid.empty());
  check(grid, wet, geometry<Dim>(cells));
}

template <class Check>
void with_grids(const Check& check) {
  with_grid<2>(check);
  with_grid<3>(check);
}

TEST(PressureGrid, CoversTheWetCellsAndTheMarginAndNothingElse) {
  with_grids([]<int Dim>(const PressureGrid<Dim>& grid, const auto& wet, const GridGeometry<Dim>& g) {
    std::set<Index<Dim>> expected, found;
    const int width = 2 * margin + 1;
    for (const auto& place : wet)
      for (int n = 0; n < power(width, Dim); ++n) {
        const auto cell = shifted<Dim>(place, n, width, -margin);
        bool inside = true;
        for (int a = 0; a < Dim; ++a) inside = inside && cell[a] >= 0 && cell[a] < g.cells[a];
        if (inside) expected.insert(cell);
      }
    for (const auto& cell : grid.cells()) EXPECT_TRUE(found.insert(cell.place).second) << "twice";
    EXPECT_EQ(found, expected);
  });
}

TEST(PressureGrid, HasTheCornersOfItsCellsAsVertices) {
  with_grids([]<int Dim>(const PressureGrid<Dim>& grid, const auto&, const auto&) {
    std::set<Index<Dim>> corners, found;
    for (const auto& cell : grid.cells())
      for (int k = 0; k < grid.corners; ++k) {
        const auto corner = shifted<Dim>(cell.place, k, 2, 0);
        corners.insert(corner);
        const auto v = static_cast<std::size_t>(cell.vertex[static_cast<std::size_t>(k)]);
        ASSERT_LT(v, grid.vertices().size());
        ASSERT_EQ(grid.vertices()[v].place, corner);
      }
    for (const auto& vertex : grid.vertices()) EXPECT_TRUE(found.insert(vertex.place).second) << "twice";
    EXPECT_EQ(found, corners);
    const auto places = grid.places();
    ASSERT_EQ(places.size(), grid.vertices().size());
    for (std::size_t v = 0; v < places.size(); ++v) ASSERT_EQ(places[v], grid.vertices()[v].place);
  });
}

TEST(PressureGrid, LinksVerticesBothWays) {
  with_grids([]<int Dim>(const PressureGrid<Dim>& grid, const auto&, const GridGeometry<Dim>& g) {
    std::map<Index<Dim>, std::int32_t> number;
    for (std::size_t v = 0; v < grid.vertices().size(); ++v)
      number[grid.vertices()[v].place] = static_cast<std::int32_t>(v);
    for (std::size_t v = 0; v < grid.vertices().size(); ++v) {
      const auto& vertex = grid.vertices()[v];
      double share = 1;
      for (int a = 0; a < Dim; ++a)
        if (vertex.place[a] == 0 || vertex.place[a] == g.cells[a]) share /= 2;
      ASSERT_EQ(vertex.share, share);
      for (int n = 0; n < grid.stencil; ++n) {
        const auto found = number.find(shifted<Dim>(vertex.place, n, 3, -1));
        const std::int32_t neighbour = vertex.neighbour[static_cast<std::size_t>(n)];
        ASSERT_EQ(neighbour, found == number.end() ? -1 : found->second);
        if (neighbour < 0) continue;
        const auto& back = grid.vertices()[static_cast<std::size_t>(neighbour)].neighbour;
        ASSERT_EQ(back[static_cast<std::size_t>(grid.stencil - 1 - n)], static_cast<std::int32_t>(v));
      }
      for (int k = 0; k < grid.corners; ++k) {
        const std::int32_t cell = vertex.cell[static_cast<std::size_t>(k)];
        if (cell < 0) continue;
        const auto& corners = grid.cells()[static_cast<std::size_t>(cell)].vertex;
        ASSERT_EQ(corners[static_cast<std::size_t>(grid.corners - 1 - k)], static_cast<std::int32_t>(v));
      }
      ASSERT_EQ(vertex.neighbour[static_cast<std::size_t>(grid.centre)], static_cast<std::int32_t>(v));
    }
  });
}

// The lower triangle by columns, each with its diagonal first: every pair of linked vertices has one slot.
TEST(PressureGrid, HasOneSlotForEveryPairAscendingInItsColumn) {
  with_grids([]<int Dim>(const PressureGrid<Dim>& grid, const auto&, const auto&) {
    const SymmetricPattern pattern = grid.pattern();
    ASSERT_EQ(pattern.column_begin.size(), grid.vertices().size() + 1);
    ASSERT_EQ(static_cast<std::size_t>(pattern.column_begin.back()), pattern.row.size());
    std::vector<int> uses(pattern.row.size(), 0);
    for (std::size_t v = 0; v < grid.vertices().size(); ++v) {
      const auto begin = static_cast<std::size_t>(pattern.column_begin[v]);
      const auto end = static_cast<std::size_t>(pattern.column_begin[v + 1]);
      ASSERT_EQ(pattern.row[begin], static_cast<int>(v));
      for (std::size_t s = begin + 1; s < end; ++s) ASSERT_GT(pattern.row[s], pattern.row[s - 1]);
      const auto& vertex = grid.vertices()[v];
      for (std::size_t n = 0; n < vertex.slot.size(); ++n) {
        const std::int32_t other = vertex.neighbour[n], slot = vertex.slot[n];
        ASSERT_EQ(slot >= 0, other >= static_cast<std::int32_t>(v)) << "of the couple one holds the slot";
        if (slot < 0) continue;
        ASSERT_GE(static_cast<std::size_t>(slot), begin);
        ASSERT_LT(static_cast<std::size_t>(slot), end);
        ASSERT_EQ(pattern.row[static_cast<std::size_t>(slot)], other);
        ++uses[static_cast<std::size_t>(slot)];
      }
    }
    EXPECT_TRUE(std::all_of(uses.begin(), uses.end(), [](int n) { return n == 1; }));
  });
}

/// Particles that fill the cells, one each, sorted into blocks.
template <int Dim>
Blocks<Dim> blocks_of(const std::vector<Index<Dim>>& cells, const GridGeometry<Dim>& g) {
  Particles particles(Dim);
  particles.material_names = {"soil"};
  particles.resize(cells.size());
  for (std::size_t p = 0; p < cells.size(); ++p)
    for (int a = 0; a < Dim; ++a)
      particles.columns.data(particles.position, a)[p] = g.min[a] + (cells[p][a] + 0.5) * g.cell[a];
  Blocks<Dim> blocks;
  blocks.sort(particles, g, 2);
  return blocks;
}

/// Every place of a tile that lies on a known cell or vertex is listed there, once, and nothing else is.
template <int Dim, class Places, class Entries>
void expect_entries(const Blocks<Dim>& blocks, std::size_t tile, int width, std::size_t count, const Places& place_of,
                    const Entries& entries, const std::function<const std::int32_t*(std::size_t)>& of_tile) {
  std::map<Index<Dim>, std::size_t> number;
  for (std::size_t i = 0; i < count; ++i) number[place_of(i)] = i;
  std::map<std::int32_t, std::size_t> owner;
  for (std::size_t i = 0; i < count; ++i)
    for (const std::int32_t entry : entries(i))
      if (entry >= 0 && static_cast<std::size_t>(entry) < blocks.particle_blocks().size() * tile) {
        ASSERT_TRUE(owner.emplace(entry, i).second) << "entry " << entry << " belongs to two";
      }
  std::size_t found = 0;
  for (std::size_t b = 0; b < blocks.particle_blocks().size(); ++b)
    for (std::size_t n = 0; n < tile; ++n) {
      const auto place = shifted<Dim>(blocks.particle_blocks()[b].first_cell, static_cast<int>(n), width, -tile_margin);
      const auto known = number.find(place);
      ASSERT_EQ(of_tile(b)[n], known == number.end() ? -1 : static_cast<std::int32_t>(known->second));
      if (known == number.end()) continue;
      const auto own = owner.find(static_cast<std::int32_t>(b * tile + n));
      ASSERT_NE(own, owner.end());
      ASSERT_EQ(own->second, known->second);
      ++found;
    }
  EXPECT_EQ(found, owner.size());
}

TEST(PressureGrid, FindsTheEntriesOfAllTiles) {
  with_grids([]<int Dim>(PressureGrid<Dim>& grid, const auto&, const GridGeometry<Dim>& g) {
    // Particles everywhere: blocks on all sides of every block, so that as many tiles meet as can.
    std::vector<Index<Dim>> everywhere;
    for (int n = 0; n < power(g.cells[0], Dim); ++n) everywhere.push_back(shifted<Dim>({}, n, g.cells[0], 0));
    const auto blocks = blocks_of<Dim>(everywhere, g);
    grid.locate(blocks);
    expect_entries<Dim>(
        blocks, cell_tile<Dim>, cell_tile_width<Dim>, grid.cells().size(),
        [&](std::size_t i) { return grid.cells()[i].place; }, [&](std::size_t i) { return grid.cell_entries(i); },
        [&](std::size_t b) { return grid.cells_of_tile(b); });
    expect_entries<Dim>(
        blocks, vertex_tile<Dim>, tile_width<Dim>(1), grid.vertices().size(),
        [&](std::size_t i) { return grid.vertices()[i].place; }, [&](std::size_t i) { return grid.vertex_entries(i); },
        [&](std::size_t b) { return grid.vertices_of_tile(b); });
  });
}

// Rows of a run are written together: what holds for the first must hold for all, so many places on.
TEST(PressureGrid, RunsAreConsecutiveInAllThatTheyLinkTo) {
  with_grids([]<int Dim>(PressureGrid<Dim>& grid, const auto&, const GridGeometry<Dim>&) {
    const auto& vertices = grid.vertices();
    std::size_t in_runs = 0, complete = 0;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      const auto all = [](const auto& numbers) { return std::ranges::min(numbers) >= 0; };
      const bool whole = vertices[i].share == 1 && all(vertices[i].cell) && all(vertices[i].neighbour);
      complete += whole ? 1 : 0;
      ASSERT_EQ(grid.run_end(i) > i, whole);
      for (std::size_t j = i; j < grid.run_end(i); ++j) {
        const auto on = static_cast<std::int32_t>(j - i);
        for (std::size_t k = 0; k < vertices[i].cell.size(); ++k)
          ASSERT_EQ(vertices[j].cell[k], vertices[i].cell[k] + on);
        for (std::size_t n = 0; n < vertices[i].neighbour.size(); ++n)
          ASSERT_EQ(vertices[j].neighbour[n], vertices[i].neighbour[n] + on);
        for (int n = 0; n < grid.stencil - grid.centre; ++n) {
          const auto at = static_cast<std::size_t>(grid.centre + n);
          ASSERT_EQ(vertices[j].slot[at],
                    vertices[i].slot[static_cast<std::size_t>(grid.centre)] + on * (grid.stencil - grid.centre) + n);
        }
      }
      if (grid.run_end(i) > i && (i == 0 || grid.run_end(i - 1) <= i)) in_runs += grid.run_end(i) - i;
    }
    EXPECT_EQ(in_runs, complete);
  });
}

// A second build forgets the first.
TEST(PressureGrid, CanBeBuiltAgain) {
  with_grids([]<int Dim>(PressureGrid<Dim>& grid, const auto& wet, const GridGeometry<Dim>& g) {
    const auto first = grid.places();
    grid.build({wet.front()}, g);
    EXPECT_LT(grid.vertices().size(), first.size());
    grid.build(wet, g);
    EXPECT_EQ(grid.places(), first);
  });
}

}  // namespace
}  // namespace sluice
