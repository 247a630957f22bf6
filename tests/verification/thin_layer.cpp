/// How many cells a layer needs: a soft layer between stiff ones in confined compression. Exact: the settlement is the
/// sum of q t / M over the layers. On the grid the layers share cells, and the soft one is too stiff, by an error of
/// first order in the cell. The advisor asks for four cells across the thinnest layer.
#include "tests/verification/scene_fixture.h"

namespace sluice {
namespace {

/// Settlement over the exact one, less 1. A layer of 1 m with a tenth of the stiffness of the 2 m above and below it,
/// `cells` across, beginning `offset` cells above an edge of the grid.
double settlement_error(int cells, double offset) {
  const double h = 1.0 / cells, low = 2 + offset * h, top = low + 1 + 2 - offset * h;
  const double load = 100, stiff = 1e7, soft = 1e6;
  SceneText scene{
      .grid = fmt::format("{{min: [0, 0], max: [{}, {}], cell: {}}}", 2 * h, top + 3 * h, h),
      .material = fmt::format("{{model: linear_elastic, density: 2000, youngs_modulus: {}, poisson_ratio: 0}}\n"
                              "  layer: {{model: linear_elastic, density: 2000, youngs_modulus: {}, poisson_ratio: 0}}",
                              stiff, soft),
      .bodies = fmt::format("  - {{material: soil, box: {{min: [0, 0], max: [{0}, {1}]}}}}\n"
                            "  - {{material: layer, box: {{min: [0, {2}], max: [{0}, {3}]}}, replaces: soil}}",
                            2 * h, top, low, low + 1),
      .boundaries = "{bottom: roller, left: roller, right: roller}",
      .scheme = Scheme{}.with("integration: implicit_static, time_step: 1 s"),
      .end_time = 1,
      .more = fmt::format("surface_loads: [{{pressure: {}}}]\n", load)};
  const auto simulation = simulate(scene);
  const auto before = by_id(simulation->particles(), "position", 1);
  simulation->advance(1);
  const auto after = by_id(simulation->particles(), "position", 1);
  const auto highest = static_cast<std::size_t>(std::ranges::max_element(before) - before.begin());
  const double exact = load * ((before[highest] - 1) / stiff + 1 / soft);
  return (before[highest] - after[highest]) / exact - 1;
}

// Layers of four cells are 5 to 7 % too stiff, those of eight half of that; with one cell it is a fifth to a half. The
// bounds are the measured errors, rounded up.
TEST(ThinLayer, FourCellsAcrossAreAtMostSevenPerCentTooStiff) {
  for (const double offset : {0.0, 0.5}) {
    SCOPED_TRACE(offset);
    EXPECT_LT(settlement_error(1, offset), -0.19) << "the control";
    EXPECT_NEAR(settlement_error(2, offset), -0.11, 0.01);
    EXPECT_NEAR(settlement_error(4, offset), -0.06, 0.01);
    EXPECT_NEAR(settlement_error(8, offset), -0.03, 0.005);
  }
}

}  // namespace
}  // namespace sluice
