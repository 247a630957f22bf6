/// What obstacles leave of the cells of the pressure: integrals over the open part against those by hand.
#include "physics/two_phase/open_cells.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace sluice {
namespace {

/// Four by four unit cells, and one obstacle below a plane.
struct Scene2 {
  GridGeometry<2> geometry{.min = {0, 0}, .max = {4, 4}, .cell = {1, 1}, .cells = {4, 4}};
  PressureGrid<2> grid;
  OpenCells<2> open;
  CornerIntegrals<2> whole{geometry};

  Scene2(std::array<double, 3> point, std::array<double, 3> normal) {
    ObstacleCase floor;
    floor.name = "floor";
    const double length = std::hypot(normal[0], normal[1]);
    floor.region.parts.push_back(HalfSpace{{point[0], point[1]}, {normal[0] / length, normal[1] / length}});
    std::array<std::vector<double>, 2> places;
    for (auto& axis : places)
      for (int i = 0; i <= 4; ++i) axis.push_back(i);
    const Obstacles<2> obstacles({floor}, places, 1);
    grid.build({{1, 1}, {2, 2}}, geometry);
    open.find(obstacles, grid, geometry);
    open.make_room(std::vector<CellSums<2>>(grid.cells().size()), geometry, whole);
  }
  /// Null: it is not cut.
  const OpenCell<2>* cell(int i, int j) const {
    for (std::size_t c = 0; c < grid.cells().size(); ++c)
      if (grid.cells()[c].place == Index<2>{i, j}) return open.of(c);
    return nullptr;
  }
  double around(int i, int j) const {
    for (const auto& vertex : grid.vertices())
      if (vertex.place == Index<2>{i, j}) return open.around(vertex, geometry);
    return NAN;
  }
};

// The open part is y > 1.3: the integrals are those of polynomials over 0 < s < 1, 0.3 < t < 1. Values are sums over
// samples, exact for linear functions where no sample is cut; the one at 0.25 < t < 0.5 is, and counts with its middle.
TEST(OpenCells, CutAlongAnAxis) {
  const Scene2 scene({0, 1.3}, {0, 1});
  EXPECT_EQ(scene.cell(1, 2), nullptr);
  EXPECT_NEAR(scene.cell(1, 0)->volume(), 0, 1e-12);
  const OpenCell<2>& cut = *scene.cell(1, 1);
  EXPECT_NEAR(cut.volume(), 0.7, 1e-12);
  EXPECT_NEAR(cut.weight[0], 0.5 * 0.245, 0.01);        // int (1 - s)(1 - t)
  EXPECT_NEAR(cut.slope[1][2], 0.5 * 0.7, 1e-12);       // int (1 - s)
  EXPECT_NEAR(cut.products[1][0][0], 0.7 / 3, 1e-12);   // int (1 - s)^2
  EXPECT_NEAR(cut.products[0][2][2], 0.973 / 3, 0.01);  // int t^2
  EXPECT_NEAR(scene.around(2, 2), 0.5 + 2 * 0.5 * 0.455, 0.02);
  EXPECT_NEAR(scene.around(2, 1), 2 * 0.5 * 0.245, 0.02);
  EXPECT_NEAR(scene.around(2, 0), 0, 1e-12);
}

// Whatever the cut is, a uniform pressure has no gradient and a linear one the same everywhere: sums over corners.
TEST(OpenCells, KeepUniformAndLinearFields) {
  const Scene2 scene({0, 2.2}, {1, 2});
  int cut = 0;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) {
      const OpenCell<2>* const cell = scene.cell(i, j);
      if (cell == nullptr) continue;
      cut += cell->volume() > 1e-9 && cell->volume() < 1 - 1e-9 ? 1 : 0;
      for (std::size_t a = 0; a < 2; ++a) {
        EXPECT_NEAR(std::accumulate(cell->slope[a].begin(), cell->slope[a].end(), 0.0), 0, 1e-12);
        for (std::size_t m = 0; m < 4; ++m) {
          double uniform = 0, linear = 0;
          for (std::size_t n = 0; n < 4; ++n) {
            uniform += cell->products[a][m][n];
            linear += cell->products[a][m][n] * (n >> a & 1);
          }
          EXPECT_NEAR(uniform, 0, 1e-12);
          EXPECT_NEAR(linear, cell->slope[a][m], 1e-12);
        }
      }
    }
  EXPECT_GE(cut, 4);
}

// The plane x + 2 y = 4.4 leaves of the rectangle what lies above it.
TEST(OpenCells, AddUpToTheOpenVolume) {
  const Scene2 scene({0, 2.2}, {1, 2});
  double open = 0;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) {
      const OpenCell<2>* const cell = scene.cell(i, j);
      open += cell == nullptr ? 1 : cell->volume();
    }
  EXPECT_NEAR(open, 4 * 4 - 4 * (2.2 + 0.2) / 2, 0.02);
}

}  // namespace
}  // namespace sluice
