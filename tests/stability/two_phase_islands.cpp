/// Water in pieces: bodies apart from each other, splashes, drops, dry bodies beside wet ones. Nothing crashes, nothing
/// gains energy, and nothing costs more than it should.
#include "tests/stability/two_phase_scenes.h"

namespace sluice {
namespace {

const char* const grid = "{min: [0 m, 0 m], max: [8 m, 4 m], cell: 0.25 m}";

// Two wet bodies that do not touch fall side by side, as if each were alone.
TEST(Islands, FallFreely) {
  for (const char* const material : {"soil", "sea"}) {
    const std::string bodies = fmt::format(
        "  - {{material: {0}, box: {{min: [1 m, 2 m], max: [2 m, 3 m]}}}}\n"
        "  - {{material: {0}, box: {{min: [5 m, 2 m], max: [7 m, 3.5 m]}}}}",
        material);
    const auto simulation = simulate_text(water_scene(grid, bodies, "gravity: [0, -9.81 m/s2]"));
    while (simulation->time() < 0.3) simulation->advance(0.3);
    const auto v = by_id(simulation->particles(), "velocity", 1), p = by_id(simulation->particles(), "pore_pressure");
    const double dt = simulation->time_step_limits().front().second;
    for (const double one : v) EXPECT_NEAR(one, -9.81 * 0.3, 9.81 * dt) << material;
    EXPECT_LT(largest_magnitude(p), 1) << material;  // [Pa]; at rest it would be 1e4
  }
}

// One particle, and two, fly on their own from cell to cell: their momentum stays.
TEST(Islands, OfOneAndTwoParticlesFlyStraight) {
  for (const char* const material : {"soil", "sea"}) {
    const std::string bodies = fmt::format(
        "  - {{material: {0}, particles_per_cell: 1, box: {{min: [1 m, 2 m], max: [1.2 m, 2.2 m]}}, velocity: [3, 0.1 "
        "m/s]}}\n"
        "  - {{material: {0}, particles_per_cell: 1, box: {{min: [1 m, 1 m], max: [1.4 m, 1.2 m]}}, velocity: [3, 0.1 "
        "m/s]}}\n"
        "  - {{material: {0}, box: {{min: [0 m, 0 m], max: [1 m, 0.5 m]}}}}",
        material);
    const auto simulation = simulate_text(water_scene(grid, bodies, ""));
    const double before = total_momentum(simulation->particles(), 0);
    while (simulation->time() < 1.5) simulation->advance(1.5);
    EXPECT_NEAR(total_momentum(simulation->particles(), 0), before, 1e-10 * before) << material;
    const auto v = by_id(simulation->particles(), "velocity", 0);
    for (std::size_t p = 0; p < 3; ++p) EXPECT_NEAR(v[p], 3, 1e-3) << material;
  }
}

// Pressure lives on the vertices near water only: a dry body of any size adds none.
TEST(Islands, OfDrySoilHaveNoPressure) {
  const std::string wet = "  - {material: soil, box: {min: [1 m, 0 m], max: [2 m, 1 m]}}";
  const std::string more = "gravity: [0, -9.81 m/s2]\nboundaries: {bottom: fixed, left: roller, right: roller}";
  const auto alone = simulate_text(water_scene(grid, wet, more));
  const auto beside =
      simulate_text(water_scene(grid, wet + "\n  - {material: dry, box: {min: [2 m, 0 m], max: [8 m, 3 m]}}", more));
  take_steps(*alone, 20);
  take_steps(*beside, 20);
  EXPECT_EQ(step_number(*beside, "pressure_unknowns"), step_number(*alone, "pressure_unknowns"));
  EXPECT_LE(step_number(*alone, "pressure_unknowns"), 9 * 7);
  const Particles& particles = beside->particles();
  const double* const pressure = particles.columns.data(particles.columns.find("pore_pressure"));
  for (std::size_t p = 0; p < particles.size(); ++p)
    if (particles.material[p] == 1) {
      EXPECT_EQ(pressure[p], 0);
    }
}

// A scene of two_phase without water is one of total_stress. Tolerance: with APIC total_stress adds the impulse to the
// momentum at once, two_phase for itself; the difference in round-off grows while the soil yields, to 2e-11 m.
TEST(Islands, WithoutWaterAreThoseOfTotalStress) {
  for (const char* const timing : {"usf", "usl", "musl"})
    for (const char* const transfer : {"apic", "flip"}) {
      const std::string scene = fmt::format(
          "schema: 1\nend_time: 10 s\ngrid: {}\nmaterials:\n"
          "  dry: {{model: mohr_coulomb, density: 1600 kg/m3, youngs_modulus: 1 MPa, poisson_ratio: 0.3, "
          "friction_angle: 30 deg, cohesion: 0 Pa}}\n"
          "bodies:\n  - {{material: dry, box: {{min: [0 m, 0 m], max: [2 m, 3 m]}}}}\ngravity: [0, -9.81 m/s2]\n"
          "boundaries: {{bottom: {{normal: fixed, friction: 0.4}}, left: roller, right: roller}}\n"
          "scheme: {{stress_update: {}, transfer: {}}}\n",
          grid, timing, transfer);
      const auto single = simulate_text(scene + "physics: total_stress\n");
      const auto two = simulate_text(scene + "physics: two_phase\n");
      take_steps(*single, 200);
      take_steps(*two, 200);
      EXPECT_NEAR(single->time(), two->time(), 1e-12) << timing << transfer;
      double worst = 0;
      const auto a = by_id(single->particles(), "position", 0), b = by_id(two->particles(), "position", 0);
      for (std::size_t p = 0; p < a.size(); ++p) worst = std::max(worst, std::abs(a[p] - b[p]));
      EXPECT_LT(worst, 1e-9) << timing << transfer;
      EXPECT_EQ(step_number(*two, "pressure_unknowns"), 0);
    }
}

// A square of water that turns nothing and feels nothing flies as it is.
TEST(Islands, OfWaterKeepTheirShapeAndMomentum) {
  const auto simulation = simulate_text(water_scene(
      grid, "  - {material: sea, sphere: {centre: [1.3 m, 2 m], radius: 0.8 m}, velocity: [2, 0.3 m/s]}", ""));
  const Particles& particles = simulation->particles();
  const std::array<double, 2> before{total_momentum(particles, 0), total_momentum(particles, 1)};
  const auto x0 = by_id(particles, "position", 0), z0 = by_id(particles, "position", 1);
  while (simulation->time() < 2) simulation->advance(2);
  for (int a = 0; a < 2; ++a)
    EXPECT_NEAR(total_momentum(particles, a), before[static_cast<std::size_t>(a)], 1e-9 * before[0]);
  const auto x = by_id(particles, "position", 0), z = by_id(particles, "position", 1);
  double worst = 0;
  for (std::size_t p = 0; p < x.size(); ++p)
    worst = std::max({worst, std::abs(x[p] - x0[p] - 4), std::abs(z[p] - z0[p] - 0.6)});
  EXPECT_LT(worst, 1e-12);
}

}  // namespace
}  // namespace sluice
