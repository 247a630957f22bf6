/// F9: how long steps may be for water at rest. Points that a motion pushes together feel the pressure p that they have
/// as if it were a bulk modulus: by (49) the force of a constant p changes by -p grad N_i div u, that of (16) by -K
/// grad N_i div u. The pressure equation lets no volume change that vertices see; what alternates from node to node
/// they do not see. So water of the pressure p has the longest step of a skeleton of the modulus p, (60),
/// h sqrt(rho / p), where p is largest: rho g H. docs/stability/f09_free_surface.md.
#include "tests/figures.h"
#include "tests/stability/unguarded_run.h"

namespace sluice {
namespace {

constexpr double gravity = 9.81, cell = 0.1;

/// Water at rest in a basin ten cells wide.
SceneText basin(int cells_deep, int per_cell, const std::string& shape) {
  SceneText scene{.grid = fmt::format("{{min: [0 m, 0 m], max: [1 m, {} m], cell: 0.1 m}}", cell * (cells_deep + 3)),
                  .material = "{model: water}",
                  .bodies = fmt::format(
                      "  - {{material: soil, particles_per_cell: {}, box: {{min: [0 m, 0 m], max: [1 m, {} m]}}}}",
                      per_cell, cell * cells_deep),
                  .gravity = "[0, -9.81 m/s2]",
                  .boundaries = "{left: roller, right: roller, bottom: roller}",
                  .scheme = {.shape = shape},
                  .physics = "two_phase"};
  scene.more = fmt::format("water: {{initial: {{method: hydrostatic, level: {} m}}}}\n", cell * cells_deep);
  return scene;
}

/// The longest step in which water is calm after four hundred, over h / sqrt(g H) = h sqrt(rho / p).
double longest_calm_step(int cells_deep, int per_cell, const std::string& shape) {
  const double wave = std::sqrt(gravity * cell * cells_deep);
  const auto calm = [&](double courant) {
    UnguardedRun run(basin(cells_deep, per_cell, shape));
    return run.steps(400, courant * cell / wave) && run.speed() < 1e-4 * wave;
  };
  return stable_limit(calm, 0.1, 4);
}

// Quadratic functions bear 1.28 of (60) with p in the place of M, whatever the number of particles, from seven cells of
// depth on: 1.09 is what they bear in soil (tests/stability/two_phase_maps.cpp), and only the lowest cells have all of
// p. In shallower water it is less, for surfaces have their own limit, half of sqrt(h / g). The control: the limit of
// the program, (62), knows nothing of the depth; its default is too long for water of more than seven cells. Linear
// functions, whose slopes jump, do not hold water at rest, nor do cubic ones, which are out of balance at walls.
TEST(StillWater, IsCalmInStepsOfTheSkeletonThatItsPressureIs) {
  const bool whole = figures_folder() != nullptr;
  FigureTable table("still_water", "shape,per_cell,cells_deep,of_pressure,of_cell_fall");
  for (const std::string shape : {"quadratic_bspline", "cubic_bspline", "linear"})
    for (const int per_cell : whole ? std::vector<int>{4, 9, 16} : std::vector<int>{4})
      for (const int deep : whole ? std::vector<int>{3, 5, 7, 10, 14, 20} : std::vector<int>{5, 10}) {
        SCOPED_TRACE(fmt::format("{}, {} particles, {} cells deep", shape, per_cell, deep));
        const double found = longest_calm_step(deep, per_cell, shape), of_fall = found / std::sqrt(deep);
        table.row(shape, per_cell, deep, found, of_fall);
        if (shape != "quadratic_bspline") {
          EXPECT_LT(found, 0.2);
          continue;
        }
        EXPECT_GT(of_fall, deep < 7 ? 0.5 : 0.25);
        if (deep >= 7) {
          EXPECT_NEAR(found, 1.28, 0.06);
        }
        if (deep >= 10) {
          EXPECT_LT(of_fall, 0.5);
        }
      }
}

}  // namespace
}  // namespace sluice
