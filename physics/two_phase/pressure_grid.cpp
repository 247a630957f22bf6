#include "physics/two_phase/pressure_grid.h"

#include <algorithm>

namespace sluice {

namespace {

constexpr int dilation = 2;  // cells beyond the wet ones

/// Calls visit(place) for all places of a box, both ends included, first axis fastest.
template <int Dim, class Visit>
void for_box(const Index<Dim>& low, const Index<Dim>& high, const Visit& visit) {
  Index<Dim> i = low;
  for (int a = 0; a < Dim; ++a)
    if (low[a] > high[a]) return;
  for (;;) {
    visit(i);
    int a = 0;
    while (a < Dim && i[a] == high[a]) {
      i[a] = low[a];
      ++a;
    }
    if (a == Dim) return;
    ++i[a];
  }
}

/// The place that lies `number`, in a box of `width` places an axis, from `origin`.
template <int Dim>
Index<Dim> place_in_box(const Index<Dim>& origin, int number, int width) {
  Index<Dim> place;
  for (int a = 0; a < Dim; ++a, number /= width) place[a] = origin[a] + number % width;
  return place;
}

template <int Dim>
Index<Dim> moved(Index<Dim> place, int by) {
  for (int& i : place) i += by;
  return place;
}

}  // namespace

template <int Dim>
void PressureGrid<Dim>::Numbers::cover(const Index<Dim>& low, const Index<Dim>& high) {
  low_ = low;
  high_ = high;
  std::size_t size = 1;
  for (int a = 0; a < Dim; ++a) size *= static_cast<std::size_t>(high[a] - low[a] + 1);
  number_.assign(size, -1);
}

template <int Dim>
std::size_t PressureGrid<Dim>::Numbers::position(const Index<Dim>& place) const {
  std::size_t position = 0;
  for (int a = Dim - 1; a >= 0; --a)
    position =
        position * static_cast<std::size_t>(high_[a] - low_[a] + 1) + static_cast<std::size_t>(place[a] - low_[a]);
  return position;
}

template <int Dim>
std::int32_t PressureGrid<Dim>::Numbers::find(const Index<Dim>& place) const {
  for (int a = 0; a < Dim; ++a)
    if (place[a] < low_[a] || place[a] > high_[a]) return -1;
  return number_[position(place)];
}

template <int Dim>
void PressureGrid<Dim>::build(const std::vector<Index<Dim>>& wet, const GridGeometry<Dim>& grid) {
  geometry_ = grid;
  number_cells(wet);
  number_vertices();
  link_vertices();
  make_pattern();
  find_runs();
}

template <int Dim>
void PressureGrid<Dim>::number_cells(const std::vector<Index<Dim>>& wet) {
  Index<Dim> low = wet.front(), high = wet.front();
  for (int a = 0; a < Dim; ++a) {
    for (const auto& place : wet) {
      low[a] = std::min(low[a], std::max(0, place[a] - dilation));
      high[a] = std::max(high[a], std::min(geometry_.cells[a] - 1, place[a] + dilation));
    }
    if (geometry_.periodic[a]) low[a] = 0, high[a] = geometry_.cells[a] - 1;
  }
  cell_numbers_.cover(low, high);
  for (const auto& place : wet) {
    Index<Dim> from = place, to = place;
    for (int a = 0; a < Dim; ++a) {
      from[a] = geometry_.periodic[a] ? place[a] - dilation : std::max(low[a], place[a] - dilation);
      to[a] = geometry_.periodic[a] ? place[a] + dilation : std::min(high[a], place[a] + dilation);
    }
    for_box<Dim>(from, to, [&](const Index<Dim>& cell) { cell_numbers_.at(geometry_.wrapped(cell)) = 0; });
  }
  cells_.clear();
  for_box<Dim>(low, high, [&](const Index<Dim>& place) {
    if (cell_numbers_.at(place) < 0) return;
    cell_numbers_.at(place) = static_cast<std::int32_t>(cells_.size());
    cells_.push_back({place, {}});
  });
}

template <int Dim>
void PressureGrid<Dim>::number_vertices() {
  Index<Dim> high = moved<Dim>(cell_numbers_.high(), 1);
  for (int a = 0; a < Dim; ++a) high[a] -= geometry_.periodic[a] ? 1 : 0;
  const auto corner = [&](const Cell& cell, int k) { return geometry_.wrapped(place_in_box<Dim>(cell.place, k, 2)); };
  vertex_numbers_.cover(cell_numbers_.low(), high);
  for (const Cell& cell : cells_)
    for (int k = 0; k < corners; ++k) vertex_numbers_.at(corner(cell, k)) = 0;
  vertices_.clear();
  for_box<Dim>(vertex_numbers_.low(), vertex_numbers_.high(), [&](const Index<Dim>& place) {
    if (vertex_numbers_.at(place) < 0) return;
    vertex_numbers_.at(place) = static_cast<std::int32_t>(vertices_.size());
    vertices_.push_back({place, {}, {}, {}, 1});
  });
  for (Cell& cell : cells_)
    for (int k = 0; k < corners; ++k) cell.vertex[static_cast<std::size_t>(k)] = vertex_numbers_.at(corner(cell, k));
}

template <int Dim>
void PressureGrid<Dim>::link_vertices() {
  for (Vertex& vertex : vertices_) {
    for (int k = 0; k < corners; ++k)
      vertex.cell[static_cast<std::size_t>(k)] =
          cell_numbers_.find(geometry_.wrapped(place_in_box<Dim>(moved<Dim>(vertex.place, -1), k, 2)));
    for (int n = 0; n < stencil; ++n)
      vertex.neighbour[static_cast<std::size_t>(n)] =
          vertex_numbers_.find(geometry_.wrapped(place_in_box<Dim>(moved<Dim>(vertex.place, -1), n, 3)));
    vertex.share = 1;
    for (int a = 0; a < Dim; ++a)
      if (!geometry_.periodic[a] && (vertex.place[a] == 0 || vertex.place[a] == geometry_.cells[a]))
        vertex.share *= 0.5;
  }
}

/// Columns by number. Neighbours are numbered in the order of the stencil, but across the seam of a periodic axis.
template <int Dim>
void PressureGrid<Dim>::make_pattern() {
  pattern_ = {};
  pattern_.column_begin.push_back(0);
  for (Vertex& vertex : vertices_) {
    vertex.slot.fill(-1);
    const std::int32_t own = vertex.neighbour[centre];
    std::vector<std::pair<std::int32_t, std::size_t>> below;  // row, place in the stencil
    for (std::size_t n = 0; n < stencil; ++n)
      if (vertex.neighbour[n] >= own) below.emplace_back(vertex.neighbour[n], n);
    std::ranges::sort(below);
    for (const auto& [row, n] : below) {
      vertex.slot[n] = static_cast<std::int32_t>(pattern_.row.size());
      pattern_.row.push_back(row);
    }
    pattern_.column_begin.push_back(static_cast<int>(pattern_.row.size()));
  }
}

template <int Dim>
void PressureGrid<Dim>::find_runs() {
  const auto complete = [&](const Vertex& v) {
    bool at_seam = false;
    for (int a = 0; a < Dim; ++a)
      at_seam = at_seam || (geometry_.periodic[a] && (v.place[a] == 0 || v.place[a] == geometry_.cells[a] - 1));
    return !at_seam && v.share == 1 && std::ranges::min(v.cell) >= 0 && std::ranges::min(v.neighbour) >= 0;
  };
  run_end_.resize(vertices_.size());
  for (std::size_t i = vertices_.size(); i-- > 0;) {
    const bool whole = complete(vertices_[i]);
    // With all neighbours, the next vertex is the neighbour behind; cells and vertices of a line are numbered in order.
    run_end_[i] = !whole ? i : std::max(i + 1, i + 1 < vertices_.size() ? run_end_[i + 1] : 0);
  }
}

template <int Dim>
void PressureGrid<Dim>::locate(const Blocks<Dim>& blocks) {
  const auto link = [&](const Numbers& numbers, int width, std::size_t tile, std::size_t count,
                        std::vector<std::int32_t>& tiles, std::vector<Entries>& entries) {
    Entries none;
    none.fill(-1);
    entries.assign(count, none);
    tiles.assign(blocks.particle_blocks().size() * tile, -1);
    for (std::size_t b = 0; b < blocks.particle_blocks().size(); ++b) {
      const Index<Dim> origin = moved<Dim>(blocks.particle_blocks()[b].first_cell, -tile_margin);
      for (std::size_t n = 0; n < tile; ++n) {
        const std::int32_t number =
            numbers.find(geometry_.wrapped(place_in_box<Dim>(origin, static_cast<int>(n), width)));
        const std::size_t at = b * tile + n;
        tiles[at] = number;
        if (number < 0) continue;
        auto& own = entries[static_cast<std::size_t>(number)];
        *std::find(own.begin(), own.end(), -1) = static_cast<std::int32_t>(at);
      }
    }
  };
  link(cell_numbers_, cell_tile_width<Dim>, cell_tile<Dim>, cells_.size(), tile_cells_, cell_entries_);
  link(vertex_numbers_, tile_width<Dim>(1), vertex_tile<Dim>, vertices_.size(), tile_vertices_, vertex_entries_);
  const auto behind = static_cast<std::int32_t>(blocks.particle_blocks().size() * vertex_tile<Dim>);
  for (Entries& own : vertex_entries_) std::ranges::replace(own, -1, behind);
  has_gaps_.resize(blocks.particle_blocks().size());
  for (std::size_t b = 0; b < has_gaps_.size(); ++b) {
    const std::int32_t* const cells = cells_of_tile(b);
    has_gaps_[b] = std::find(cells, cells + cell_tile<Dim>, -1) != cells + cell_tile<Dim> ? 1 : 0;
  }
}

template <int Dim>
std::vector<std::array<int, Dim>> PressureGrid<Dim>::places() const {
  std::vector<std::array<int, Dim>> places;
  for (const Vertex& vertex : vertices_) places.push_back(vertex.place);
  return places;
}

template class PressureGrid<2>;
template class PressureGrid<3>;

}  // namespace sluice
