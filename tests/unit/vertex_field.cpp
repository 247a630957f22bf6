/// Fields at the vertices of cells, at particles.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "core/transfer/vertex_field.h"

namespace sluice::test {

namespace {

/// A field that is linear along each axis, with products: what linear functions represent without error. Points lie in
/// the block, in its margin, on vertices inside, and on the walls of the grid, the upper of which belongs to the last
/// cell.
/// Tolerance: round-off of values up to some 1e3, and of their differences over cells of some 0.3 m.
template <int Dim>
void expect_products_are_exact() {
  GridGeometry<Dim> grid;
  for (int a = 0; a < Dim; ++a) {
    grid.min[a] = 0.4 - a;
    grid.cell[a] = 0.25 + 0.1 * a;
    grid.cells[a] = 3 * block_width<Dim>;
    grid.max[a] = grid.min[a] + grid.cells[a] * grid.cell[a];
  }
  const auto field = [](const Vector<Dim>& x) {
    return 3 - 2 * x[0] + x[1] + 0.5 * x[0] * x[1] + (Dim == 3 ? (1 - x[0]) * (2 + x[1]) * x[Dim - 1] : 0);
  };
  for (const int block : {0, 1, 2}) {
    Index<Dim> first_cell;
    first_cell.fill(block * block_width<Dim>);
    VertexTile<Dim> tile;
    for (std::size_t n = 0; n < tile.size(); ++n) {
      Index<Dim> place;
      for (int a = 0, rest = static_cast<int>(n); a < Dim; ++a, rest /= tile_width<Dim>(1))
        place[a] = first_cell[a] - tile_margin + rest % tile_width<Dim>(1);
      tile[n] = field(grid.vertex(place));
    }
    constexpr std::size_t count = 333;
    std::mt19937 generator(5);
    std::array<std::vector<double>, Dim> x, slope;
    std::vector<double> value(count);
    BlockParticles<Dim> particles{&grid, first_cell, 0, count, {}};
    FieldAtParticles<Dim> out{value.data(), {}};
    for (int a = 0; a < Dim; ++a) {
      const int low = std::max(0, first_cell[a] - tile_margin),
                high = std::min(grid.cells[a], first_cell[a] + block_width<Dim> + tile_margin);
      std::uniform_real_distribution<double> cells(low, high);
      for (std::size_t p = 0; p < count; ++p) {
        double at = cells(generator);
        if (p % 7 == 0) at = std::max(low + 1.0, std::floor(at));
        if (p == 0 && block != 1) at = block == 0 ? 0 : grid.cells[a];
        x[a].push_back(grid.min[a] + at * grid.cell[a]);
      }
      slope[a].resize(count);
      particles.position[a] = x[a].data();
      out.gradient[a] = slope[a].data();
    }
    interpolate<Dim>(tile, particles, out);
    for (std::size_t p = 0; p < count; ++p) {
      Vector<Dim> at;
      for (int a = 0; a < Dim; ++a) at[a] = x[a][p];
      ASSERT_NEAR(value[p], field(at), 1e-11) << p;
      for (int a = 0; a < Dim; ++a) {
        Vector<Dim> next = at;
        next[a] += 1;  // linear along the axis
        ASSERT_NEAR(slope[a][p], field(next) - field(at), 1e-11) << p << ", axis " << a;
      }
    }
  }
}

}  // namespace

TEST(VertexField, is_linear_between_vertices) {
  expect_products_are_exact<2>();
  expect_products_are_exact<3>();
}

}  // namespace sluice::test
