/// Water on its own and on soil: sloshing, dam break in three dimensions, water that rests on soil; small cut cells.
#include "tests/stability/two_phase_scenes.h"

namespace sluice {
namespace {

/// A basin of water that swings in its first mode.
struct Sloshing {
  double frequency = 0;  ///< [rad/s], of periods two to four; 0: it does not swing
  double gained = 0;     ///< most energy over that of the start, over the energy of the mode
};

constexpr double basin_length = 1, basin_depth = 0.5, pi = 3.14159265358979;

/// Amplitude of 2 % of the depth; `surface` is how its place is found.
Sloshing slosh(const std::string& surface) {
  constexpr double amplitude = 0.01;
  std::string polygon = "[[0 m, 0 m], [1 m, 0 m]";
  for (int i = 20; i >= 0; --i)
    polygon += fmt::format(", [{} m, {} m]", i / 20.0, basin_depth + amplitude * std::cos(pi * i / 20.0));
  const auto simulation =
      simulate_text(water_scene("{min: [0 m, 0 m], max: [1 m, 0.8 m], cell: 0.05 m}",
                                "  - {material: sea, particles_per_cell: 16, polygon: " + polygon + "]}",
                                "gravity: [0, -9.81 m/s2]\nboundaries: {left: roller, right: roller, bottom: roller}\n"
                                "water: {surface: " +
                                    surface + "}"));
  // The moment of the horizontal momentum is the mode: its zeros are the turning points.
  const auto mode = [&] { return total_momentum(simulation->particles(), 0); };
  std::vector<double> zeros;
  double before = mode(), time = 0;
  const double start = energy(*simulation, "potential") + energy(*simulation, "kinetic");
  const double energy_of_mode = 0.25 * 1000 * 9.81 * basin_length * amplitude * amplitude;  // potential, at the start
  Sloshing found;
  while (zeros.size() < 8 && simulation->time() < 10) {
    simulation->advance(20);
    const double now = mode();
    if (before * now < 0) zeros.push_back(time + (simulation->time() - time) * before / (before - now));
    before = now;
    time = simulation->time();
    const double sum = energy(*simulation, "potential") + energy(*simulation, "kinetic");
    found.gained = std::max(found.gained, (sum - start) / energy_of_mode);
  }
  if (zeros.size() == 8) found.frequency = pi * 6 / (zeros[7] - zeros[1]);
  return found;
}

// F9 (ii): the first mode of a basin, w^2 = g kappa tanh(kappa H), kappa = pi / L. The control: on a staircase a
// surface that moves by less than a cell tilts by whole cells; water falls to and fro between its steps, three times
// too fast, with the energy that they give.
TEST(Water, SloshesAtItsFrequency) {
  const double kappa = pi / basin_length, omega = std::sqrt(9.81 * kappa * std::tanh(kappa * basin_depth));
  const Sloshing within = slosh("within_cells");
  EXPECT_NEAR(within.frequency, omega, 0.02 * omega);
  EXPECT_LT(within.gained, 1e-3);
  const Sloshing stairs = slosh("at_vertices");
  EXPECT_GT(std::abs(stairs.frequency - omega), 0.2 * omega);
  EXPECT_GT(stairs.gained, 0.1);
}

TEST(Water, BreaksADamInThreeDimensions) {
  const auto simulation = simulate_text(
      water_scene("{min: [0 m, 0 m, 0 m], max: [2 m, 0.5 m, 0.8 m], cell: 0.1 m}",
                  "  - {material: sea, box: {min: [0 m, 0 m, 0 m], max: [0.5 m, 0.5 m, 0.5 m]}}",
                  "gravity: [0, 0, -9.81 m/s2]\noutflow: clamp\n"
                  "boundaries: {left: roller, right: roller, front: roller, back: roller, bottom: roller}"));
  const double start = energy(*simulation, "potential");
  double front = 0;
  while (simulation->time() < 0.8) {
    simulation->advance(0.8);
    ASSERT_LE(energy(*simulation, "potential") + energy(*simulation, "kinetic"), 1.01 * start);
  }
  for (const double x : by_id(simulation->particles(), "position", 0)) front = std::max(front, x);
  EXPECT_GT(front, 1.5);
}

TEST(Water, RestsOnSoil) {
  const auto simulation =
      simulate_text(water_scene("{min: [0 m, 0 m], max: [2 m, 4 m], cell: 0.25 m}",
                                "  - {material: soil, box: {min: [0 m, 0 m], max: [2 m, 1.5 m]}}\n"
                                "  - {material: sea, box: {min: [0 m, 1.5 m], max: [2 m, 3 m]}}",
                                "gravity: [0, -9.81 m/s2]\nboundaries: {left: roller, right: roller, bottom: fixed}\n"
                                "water: {initial: {method: hydrostatic, level: 3 m}}\n"
                                "initial_stress: {method: elastic_equilibrium}"));
  const auto& particles = simulation->particles();
  while (simulation->time() < 2) simulation->advance(2);
  double worst = 0, moved = 0;
  const auto z = by_id(particles, "position", 1), p = by_id(particles, "pore_pressure");
  const auto z0 = by_id(particles, "initial_position", 1);
  for (std::size_t i = 0; i < z.size(); ++i) {
    worst = std::max(worst, std::abs(p[i] - 9810 * (3 - z[i])));
    moved = std::max(moved, std::abs(z[i] - z0[i]));
  }
  EXPECT_LT(worst, 0.01 * 9810 * 3);
  EXPECT_LT(moved, 0.03 * 0.25);
  EXPECT_LT(simulation->largest_speed(), 5e-3);
}

// F7: an edge column of particles at 10^-j of a cell inside the next cell, pulled and pushed at the side.
TEST(SmallCutCells, NeitherThrowNorStallTheSolver) {
  for (const char* const material : {"soil", "sea"})
    for (int j = 1; j <= 8; ++j) {
      const auto simulation = simulate_text(water_scene(
          "{min: [0 m, 0 m], max: [3 m, 2 m], cell: 0.25 m}",
          fmt::format("  - {{material: {}, box: {{min: [0.5 m, 0 m], max: [1.5 m, 1 m]}}}}", material),
          "gravity: [0, -9.81 m/s2]\nboundaries: {bottom: roller, left: roller}\n"
          "surface_loads: [{pressure: 2 kPa, region: {box: {min: [1.3 m, 0 m], max: [3 m, 2 m]}}, fade: 0.5 m}]\n"));
      const double edge = 1.5 + 0.25 * std::pow(10, -j);
      Particles& particles = simulation->particles();
      double* const x = particles.columns.data(particles.position, 0);
      for (std::size_t p = 0; p < particles.size(); ++p)
        if (x[p] > 1.4) x[p] = edge;
      int most = 0;
      for (int i = 0; i < 50; ++i) {
        simulation->advance(1e3);
        most = std::max(most, static_cast<int>(step_number(*simulation, "pressure_iterations")));
      }
      const double pressure = largest_magnitude(by_id(particles, "pore_pressure"));
      EXPECT_LE(most, 25);
      EXPECT_LT(pressure, 20e3);                  // 9.8 kPa of water and 2 kPa of load, doubled by the fall
      EXPECT_LT(simulation->largest_speed(), 5);  // of water that falls apart from 1 m; soil stands
    }
}

}  // namespace
}  // namespace sluice
