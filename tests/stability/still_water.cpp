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
// p. In shallower water it is less, for surfaces have their own limit, half of sqrt(h / g). The control is that
// limit, (62), which knows nothing of the depth: half of it is too long for water of more than seven cells. Linear
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

/// The kinetic energy of water ten cells deep, over m g H, in ten seconds; or as long as it lasts.
std::vector<double> energies_of_still_water(double dt) {
  UnguardedRun run(basin(10, 4, "quadratic_bspline"));
  const double weight = 1000 * gravity;  // of 1 m3/m, times H = 1 m
  std::vector<double> energies;
  for (double t = 0; t < 10; t += dt) {
    if (!run.steps(1, dt)) break;
    energies.push_back(run.kinetic_energy() / weight);
  }
  return energies;
}

// With (62a) water is calm: after a second less than 1e-8 of m g H moves, and the surface stays to a hundredth of a
// cell. The control: steps of half of sqrt(h / g), in which it boils.
TEST(StillWater, StaysStill) {
  const auto calm = simulate(basin(10, 4, "quadratic_bspline"));
  const auto height = [&] { return sum(by_id(calm->particles(), "position", 1)) / 400; };
  const double before = height();
  calm->advance_to(1);
  double largest = 0;
  std::string limiter;
  while (calm->time() < 10) {
    limiter = calm->advance(11).limiter;
    largest = std::max(largest, energy(*calm, "kinetic"));
  }
  EXPECT_EQ(limiter, "pressure");
  EXPECT_LT(largest, 1e-8 * 1000 * gravity);
  EXPECT_NEAR(height(), before, 0.01 * cell);
  const double long_step = 0.5 * std::sqrt(cell / gravity), short_step = 0.5 * cell / std::sqrt(gravity);
  const auto boiling = energies_of_still_water(long_step);
  EXPECT_GT(*std::max_element(boiling.begin() + std::min<std::ptrdiff_t>(10, std::ssize(boiling) - 1), boiling.end()),
            1e-6);
  if (figures_folder() == nullptr) return;
  FigureTable table("still_water_energy", "step_s,time_s,kinetic");
  for (const double dt : {0.84 * long_step, short_step}) {  // a little too long, so that it lasts
    const auto energies = energies_of_still_water(dt);
    for (std::size_t i = 0; i < energies.size(); ++i) table.row(dt, static_cast<double>(i + 1) * dt, energies[i]);
  }
}

}  // namespace
}  // namespace sluice
