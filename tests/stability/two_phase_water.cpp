/// Water on its own and on soil: sloshing, dam break in three dimensions, water that rests on soil; small cut cells.
#include "tests/stability/two_phase_scenes.h"

namespace sluice {
namespace {

// F9 (ii): the first mode of a basin, w^2 = g kappa tanh(kappa H), kappa = pi / L, of an amplitude of 2 % of the depth.
TEST(Water, SloshesAtItsFrequency) {
  constexpr double length = 1, depth = 0.5, amplitude = 0.01, pi = 3.14159265358979;
  std::string polygon = "[[0 m, 0 m], [1 m, 0 m]";
  for (int i = 20; i >= 0; --i)
    polygon += fmt::format(", [{} m, {} m]", i / 20.0, depth + amplitude * std::cos(pi * i / 20.0));
  const auto simulation =
      simulate_text(water_scene("{min: [0 m, 0 m], max: [1 m, 0.8 m], cell: 0.05 m}",
                                "  - {material: sea, particles_per_cell: 16, polygon: " + polygon + "]}",
                                "gravity: [0, -9.81 m/s2]\nboundaries: {left: roller, right: roller, bottom: roller}"));
  const double kappa = pi / length, omega = std::sqrt(9.81 * kappa * std::tanh(kappa * depth));
  // The moment of the horizontal momentum is the mode: its zeros are the turning points.
  const auto mode = [&] { return total_momentum(simulation->particles(), 0); };
  std::vector<double> zeros, peaks;
  double before = mode(), time = 0, peak = 0;
  const double start = energy(*simulation, "potential") + energy(*simulation, "kinetic");
  double least = start, most = start;
  while (zeros.size() < 8 && simulation->time() < 10) {
    simulation->advance(20);
    const double now = mode();
    peak = std::max(peak, std::abs(now));
    if (before * now < 0) {
      zeros.push_back(time + (simulation->time() - time) * before / (before - now));
      peaks.push_back(peak);
      peak = 0;
    }
    before = now;
    time = simulation->time();
    const double sum = energy(*simulation, "potential") + energy(*simulation, "kinetic");
    least = std::min(least, sum);
    most = std::max(most, sum);
  }
  ASSERT_EQ(zeros.size(), 8u);
  const double measured = pi * 6 / (zeros[7] - zeros[1]);
  fmt::print("omega {:.4f}, measured {:.4f}: {:.2f} %; energy {:.3g} .. {:.3g} of {:.3g}; peaks", omega, measured,
             100 * (measured / omega - 1), least - start, most - start, start);
  for (const double p : peaks) fmt::print(" {:.3g}", p);
  fmt::print(" steps {}\n", simulation->steps());
  EXPECT_NEAR(measured, omega, 0.02 * omega);
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
    if (std::getenv("DBG"))
      fmt::print("{:.4f} {:.2f} {:.2f} {:.2f}\n", simulation->time(), energy(*simulation, "potential"),
                 energy(*simulation, "kinetic"),
                 energy(*simulation, "potential") + energy(*simulation, "kinetic") - start);
    if (std::getenv("DBG") && simulation->time() > 0.5) {
      const Particles& q = simulation->particles();
      const auto v = [&](int a, std::size_t p) { return q.columns.data(q.velocity, a)[p]; };
      const auto x = [&](int a, std::size_t p) { return q.columns.data(q.position, a)[p]; };
      const auto g = [&](int a, std::size_t p) { return q.columns.data(q.columns.find("pore_pressure_gradient"), a)[p]; };
      std::size_t fast = 0;
      for (std::size_t p = 0; p < q.size(); ++p)
        if (std::hypot(v(0, p), v(1, p), v(2, p)) > std::hypot(v(0, fast), v(1, fast), v(2, fast))) fast = p;
      double pmax = 0; std::size_t pm = 0;
      for (std::size_t p = 0; p < q.size(); ++p)
        if (q.columns.data(q.columns.find("pore_pressure"))[p] > pmax) pmax = q.columns.data(q.columns.find("pore_pressure"))[p], pm = p;
      fmt::print("   id {} x {:.4f} {:.4f} {:.4f} v {:.3g} {:.3g} {:.3g} p {:.4g} grad {:.3g} {:.3g} {:.3g}; pmax {:.4g} id {} at {:.3f} {:.3f} {:.3f}\n", q.id[fast], x(0, fast), x(1, fast),
                 x(2, fast), v(0, fast), v(1, fast), v(2, fast), q.columns.data(q.columns.find("pore_pressure"))[fast], g(0, fast), g(1, fast), g(2, fast), pmax, q.id[pm], x(0, pm), x(1, pm), x(2, pm));
    }
    EXPECT_LE(energy(*simulation, "potential") + energy(*simulation, "kinetic"), 1.01 * start);
  }
  for (const double x : by_id(simulation->particles(), "position", 0)) front = std::max(front, x);
  fmt::print("dam: front {:.3f}, energy {:.3f} of start, {} steps, {} iterations\n", front,
             (energy(*simulation, "potential") + energy(*simulation, "kinetic")) / start, simulation->steps(),
             total(*simulation, "pressure_iterations"));
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
  if (std::getenv("DBG")) {
    const auto zz = by_id(particles, "position", 1), pp = by_id(particles, "pore_pressure"), ss = by_id(particles, "stress", 1), mm = by_id(particles, "mass");
    for (std::size_t i = 0; i < zz.size(); ++i)
      if (i % 16 == 3) fmt::print("start {:.3f} p {:.1f} szz {:.1f} m {:.2f}\n", zz[i], pp[i], ss[i], mm[i]);
  }
  while (simulation->time() < 2) simulation->advance(2);
  double worst = 0, fastest = 0, moved = 0;
  const auto z = by_id(particles, "position", 1), p = by_id(particles, "pore_pressure");
  const auto z0 = by_id(particles, "initial_position", 1);
  for (std::size_t i = 0; i < z.size(); ++i) {
    worst = std::max(worst, std::abs(p[i] - 9810 * (3 - z[i])));
    moved = std::max(moved, std::abs(z[i] - z0[i]));
  }
  fastest = simulation->largest_speed();
  if (std::getenv("DBG"))
    for (std::size_t i = 0; i < z.size(); ++i)
      if (i % 16 == 3) fmt::print("{:.3f} {:.3f} p {:.1f} expected {:.1f}\n", z0[i], z[i], p[i], 9810 * (3 - z[i]));
  fmt::print("on soil: pressure off by {:.3g} Pa, moved {:.3g} m, speed {:.3g} m/s, {} steps\n", worst, moved, fastest,
             simulation->steps());
  EXPECT_LT(worst, 0.02 * 9810 * 3);
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
      double pressure = largest_magnitude(by_id(particles, "pore_pressure"));
      fmt::print("{} 10^-{}: speed {:.4f}, most iterations {}, pressure {:.4g}, {} factorizations\n", material, j,
                 simulation->largest_speed(), most, pressure, total(*simulation, "pressure_factorizations"));
      EXPECT_LT(most, 60);
      EXPECT_LT(pressure, 50e3);
    }
}

}  // namespace
}  // namespace sluice
