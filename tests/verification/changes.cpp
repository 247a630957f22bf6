/// Materials that give way to others during a run: when, to whom, and after a restart.
#include "tests/verification/scene_fixture.h"

namespace sluice {
namespace {

/// A block of soft soil beside one of hard soil, at rest; at 5 ms and at 20 ms the soft one changes.
SceneText scene(const std::string& changes) {
  SceneText text{.grid = "{min: [0 m, 0 m], max: [6 m, 2 m], cell: 0.5 m}",
                 .material =
                     "{model: linear_elastic, density: 1000 kg/m3, youngs_modulus: 1 MPa, poisson_ratio: 0}\n"
                     "  hard: {model: linear_elastic, density: 1000 kg/m3, youngs_modulus: 4 MPa, "
                     "poisson_ratio: 0}\n"
                     "  soft: {model: linear_elastic, density: 1000 kg/m3, youngs_modulus: 0.25 MPa, "
                     "poisson_ratio: 0}\n"
                     "  rock: {model: linear_elastic, density: 1000 kg/m3, youngs_modulus: 100 MPa, "
                     "poisson_ratio: 0}",
                 .bodies =
                     "  - {material: soil, box: {min: [0 m, 0 m], max: [3 m, 1 m]}, velocity: [1, 0]}\n"
                     "  - {material: hard, box: {min: [4 m, 0 m], max: [6 m, 1 m]}}"};
  text.outflow = "error\nchanges:\n" + changes;
  return text;
}

const char* const two_changes =
    "  - {at: 20 ms, material: hard, becomes: soft}\n"
    "  - {at: 5 ms, material: soil, becomes: hard}";

std::vector<int> count_by_material(const Particles& particles) {
  std::vector<int> count(particles.material_names.size(), 0);
  for (const std::int32_t m : particles.material) ++count[static_cast<std::size_t>(m)];
  return count;
}

// A step ends at the time of each change; the step after it is the first with the new material. Those that have become
// `hard` at 5 ms are `hard` like the others at 20 ms.
TEST(Changes, HappenAtTheirTimes) {
  const auto simulation = simulate(scene(two_changes));
  EXPECT_EQ(count_by_material(simulation->particles()), (std::vector<int>{48, 32, 0, 0}));
  simulation->advance_to(5e-3);
  EXPECT_EQ(simulation->time(), 5e-3);
  EXPECT_EQ(count_by_material(simulation->particles()), (std::vector<int>{48, 32, 0, 0}));
  simulation->advance(1);
  EXPECT_EQ(count_by_material(simulation->particles()), (std::vector<int>{0, 80, 0, 0}));
  while (simulation->time() < 20e-3) {
    EXPECT_EQ(count_by_material(simulation->particles()), (std::vector<int>{0, 80, 0, 0}));
    simulation->advance(1);
  }
  EXPECT_EQ(simulation->time(), 20e-3);
  simulation->advance(1);
  EXPECT_EQ(count_by_material(simulation->particles()), (std::vector<int>{0, 0, 80, 0}));
}

TEST(Changes, AtTheStartActInTheFirstStep) {
  const auto simulation = simulate(scene("  - {at: 0 s, material: soil, becomes: hard}"));
  simulation->advance(1);
  EXPECT_EQ(count_by_material(simulation->particles()), (std::vector<int>{0, 80, 0, 0}));
}

// What was stored stays: a change is of the law, not of the state.
TEST(Changes, KeepStressAndMotion) {
  const auto changing = simulate(scene("  - {at: 10 ms, material: soil, becomes: soft}"));
  const auto same = simulate(scene("  - {at: 10 ms, material: soft, becomes: soil}"));
  for (const auto& simulation : {changing.get(), same.get()}) simulation->advance_to(10e-3);
  EXPECT_EQ(by_id(changing->particles(), "stress"), by_id(same->particles(), "stress"));
  const double energy_before = energy(*changing, "elastic");
  changing->advance(10e-3 + 1e-9);
  // A quarter of the stiffness at the same stress holds four times the energy.
  EXPECT_NEAR(energy(*changing, "elastic"), 4 * energy_before, 1e-4 * energy_before);
}

// The first step after the change is within the limit of the new material, not of the one that has gone.
TEST(Changes, ToAStifferMaterialShortenTheStepAtOnce) {
  const auto simulation = simulate(scene("  - {at: 10 ms, material: soil, becomes: rock}"));
  simulation->advance_to(10e-3);
  const StepInfo step = simulation->advance(1);
  EXPECT_LE(step.dt, 0.5 * 0.5 / std::sqrt(100e6 / 1000)) << step.limiter;
}

TEST(Changes, SurviveARestart) {
  for (const double at : {0.0, 4e-3, 5e-3, 12e-3, 20e-3, 30e-3}) {
    const auto whole = simulate(scene(two_changes)), first = simulate(scene(two_changes)),
               second = simulate(scene(two_changes));
    whole->advance_to(at);
    first->advance_to(at);
    Archive archive;
    first->store(archive);
    second->restore(archive);
    whole->advance_to(40e-3);
    second->advance_to(40e-3);
    EXPECT_EQ(whole->steps(), second->steps()) << at;
    EXPECT_EQ(whole->particles().material, second->particles().material) << at;
    EXPECT_EQ(by_id(whole->particles(), "velocity"), by_id(second->particles(), "velocity")) << at;
    EXPECT_EQ(by_id(whole->particles(), "stress"), by_id(second->particles(), "stress")) << at;
  }
}

// Sand that becomes clay whose strength is a share of the overburden: each point takes the vertical stress that it has
// at that time, rho g times its depth, in its first step as clay; strengths then fall along a ramp. 1 % of the largest:
// a column at rest in elastic equilibrium, which the change does not disturb before the ramp.
TEST(Changes, ToAStrengthOfTheOverburden) {
  const auto simulation = simulate(
      {.grid = "{min: [0 m, 0 m], max: [2 m, 5 m], cell: 0.25 m}",
       .material = "{model: mohr_coulomb, density: 1600 kg/m3, youngs_modulus: 10 MPa, friction_angle: 35 deg, "
                   "cohesion: 1 kPa}\n"
                   "  clay: {model: von_mises, density: 1600 kg/m3, youngs_modulus: 10 MPa, strength_ratio: 0.5, "
                   "minimum_strength: 2 kPa, softening: {sensitivity: 20, start: 40 ms, ramp: 40 ms}}",
       .bodies = "  - {material: soil, box: {min: [0 m, 0 m], max: [2 m, 4 m]}}",
       .gravity = "[0, -9.81 m/s2]",
       .boundaries = "{left: roller, right: roller, bottom: fixed}",
       .initial_stress = "{method: elastic_equilibrium}",
       .scheme = Scheme{}.with("time_step: 1 ms"),
       .more = "changes: [{at: 20 ms, material: soil, becomes: clay}]\n"});
  simulation->advance_to(20e-3);
  for (const double overburden : by_id(simulation->particles(), "initial_vertical_stress")) EXPECT_EQ(overburden, 0);
  simulation->advance_to(30e-3);
  const auto y = by_id(simulation->particles(), "position", 1);
  const auto overburden = by_id(simulation->particles(), "initial_vertical_stress");
  const double weight = 1600 * 9.81;
  for (std::size_t p = 0; p < y.size(); ++p) EXPECT_NEAR(overburden[p], weight * (4 - y[p]), 0.01 * 4 * weight);
  EXPECT_EQ(largest_magnitude(by_id(simulation->particles(), "equivalent_plastic_strain")), 0);
  simulation->advance_to(100e-3);
  const auto plastic = by_id(simulation->particles(), "equivalent_plastic_strain");
  std::array<std::vector<double>, 4> s;
  for (int c = 0; c < 4; ++c) s[static_cast<std::size_t>(c)] = by_id(simulation->particles(), "stress", c);
  EXPECT_EQ(overburden, by_id(simulation->particles(), "initial_vertical_stress"));
  for (std::size_t p = 0; p < y.size(); ++p) {
    const double strength = std::max(0.5 * overburden[p], 2e3) / 20, mean = (s[0][p] + s[1][p] + s[2][p]) / 3;
    double half = s[3][p] * s[3][p];
    for (int c = 0; c < 3; ++c) half += 0.5 * std::pow(s[static_cast<std::size_t>(c)][p] - mean, 2);
    EXPECT_LE(std::sqrt(half), strength * (1 + 1e-9));
  }
  EXPECT_GT(largest_magnitude(plastic), 0);
}

}  // namespace
}  // namespace sluice
