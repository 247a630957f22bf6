/// The answer depends neither on the number of threads nor on being interrupted: bit for bit. Every comparison is
/// exact.
#include "core/parallel/parallel.h"
#include "core/simulation/sweep.h"
#include "tests/verification/scene_fixture.h"

namespace sluice {
namespace {

/// A small dam of two soils, `soil` and `clay`, on a rough floor, over several blocks.
SceneText dam_scene(bool flat, const std::string& cell) {
  return {.grid = (flat ? "{min: [-10 m, 0 m], max: [14 m, 8 m], cell: "
                        : "{min: [-4 m, 0 m, 0 m], max: [6 m, 3 m, 4 m], cell: ") +
                  cell + "}",
          .bodies = flat ? "  - {material: soil, polygon: [[-6 m, 0 m], [0 m, 5 m], [2 m, 5 m], [8 m, 0 m]]}\n"
                           "  - {material: clay, box: {min: [0 m, 0 m], max: [2 m, 4 m]}, replaces: soil}"
                         : "  - {material: soil, box: {min: [-2 m, 0 m, 0 m], max: [2 m, 3 m, 2 m]}}\n"
                           "  - {material: clay, box: {min: [0 m, 0 m, 0 m], max: [1 m, 3 m, 1.5 m]}, replaces: soil}",
          .gravity = flat ? "[0, -9.81 m/s2]" : "[0, 0, -9.81 m/s2]",
          .boundaries = flat ? "{bottom: {normal: fixed, friction: 0.4}, left: roller, right: roller}"
                             : "{bottom: {normal: fixed, friction: 0.4}, front: roller, back: roller}"};
}

/// Without water: it yields and slides.
std::unique_ptr<Simulation> dam(int dimension, const Scheme& scheme, const std::string& cell = "0.5 m") {
  SceneText scene = dam_scene(dimension == 2, cell);
  scene.material =
      "{model: mohr_coulomb, density: 1800 kg/m3, youngs_modulus: 1 MPa, poisson_ratio: 0.3, friction_angle: 20 "
      "deg, cohesion: 1 kPa}\n"
      "  clay: {model: mohr_coulomb, density: 1900 kg/m3, youngs_modulus: 2 MPa, poisson_ratio: 0.3, "
      "friction_angle: 0 deg, cohesion: 5 kPa}";
  scene.scheme = scheme;
  scene.more =
      dimension == 2
          ? "obstacles:\n"
            "  wall: {box: {min: [8.5 m, 0 m], max: [10 m, 6 m]}, friction: 0.3, velocity: [-1 m/s, 0]}\n"
            "  ramp: {polygon: [[-10 m, 0 m], [-6.1 m, 0 m], [-10 m, 4 m]], normal: fixed, adhesion: 1 kPa}\n"
          : "obstacles: {wall: {box: {min: [2.75 m, 0 m, 0 m], max: [4 m, 3 m, 3 m]}, friction: 0.3, velocity: "
            "[[[0 s, -0.5 m/s], [1 s, 1 m/s]], 0, 0]}}\n";
  auto simulation = simulate(scene);
  // Something to cross cells and blocks, so that particles are sorted several times.
  set_column(simulation->particles(), "velocity", 0, [](const auto& x) { return 3 + 0.3 * x[1]; });
  return simulation;
}

void expect_same_state(const Simulation& a, const Simulation& b) {
  EXPECT_EQ(a.time(), b.time());
  EXPECT_EQ(a.steps(), b.steps());
  const Particles &p = a.particles(), &q = b.particles();
  ASSERT_EQ(p.id, q.id);
  ASSERT_EQ(p.material, q.material);
  for (const ColumnSpec& spec : p.columns.specs()) {
    if (spec.role != Role::state) continue;
    for (int c = 0; c < spec.components; ++c) {
      const auto u = p.columns.values(p.columns.find(spec.name), c), v = q.columns.values(q.columns.find(spec.name), c);
      EXPECT_TRUE(std::equal(u.begin(), u.end(), v.begin(), v.end())) << spec.name << ", component " << c;
    }
  }
}

Archive archive_of(const Simulation& simulation) {
  Archive archive;
  simulation.store(archive);
  return archive;
}

class Reproducibility : public ::testing::TestWithParam<Scheme> {
 protected:
  void TearDown() override { set_thread_count(1); }
};

void expect_thread_independence(int dimension, const Scheme& scheme, int steps) {
  set_thread_count(1);
  const auto reference = dam(dimension, scheme);
  take_steps(*reference, steps);
  for (const int threads : {2, 3}) {
    set_thread_count(threads);
    const auto other = dam(dimension, scheme);
    take_steps(*other, steps);
    SCOPED_TRACE(fmt::format("{} threads, {}-D", threads, dimension));
    expect_same_state(*reference, *other);
  }
}

TEST_P(Reproducibility, ThreadsDoNotMatter) {
  expect_thread_independence(2, GetParam(), 60);
  expect_thread_independence(3, GetParam(), 25);
}

TEST_P(Reproducibility, ThreadsDoNotMatterWithFBar) {
  expect_thread_independence(2, GetParam().with("f_bar: true"), 40);
}

// On one thread the stages take more than one turn over these blocks, on four they take one (Sweep::usual_pace).
TEST_P(Reproducibility, TurnsOfTheSweepDoNotMatter) {
  for (const auto& scheme : {GetParam(), GetParam().with("f_bar: true")}) {
    const auto reference = dam(2, scheme, "0.0625 m");
    take_steps(*reference, 8);
    ASSERT_GT(archive_of(*reference).integers.at("blocks").size() / 3, Sweep<2>::usual_pace);
    set_thread_count(4);
    const auto other = dam(2, scheme, "0.0625 m");
    take_steps(*other, 8);
    expect_same_state(*reference, *other);
    set_thread_count(1);
  }
}

// The archive is taken when particles have wandered since they were sorted, so that the blocks are history; the
// restarted run has another number of threads.
void expect_restart(int dimension, const Scheme& scheme, int steps) {
  const auto whole = dam(dimension, scheme);
  take_steps(*whole, steps);
  const auto travelled = [&] { return archive_of(*whole).reals.at("loop")[2]; };  // cells since the last sort
  while (travelled() < 0.05 || travelled() > 0.45) whole->advance(1e6);
  const Archive archive = archive_of(*whole);
  take_steps(*whole, steps);

  const auto restarted = dam(dimension, scheme);
  restarted->restore(archive);
  set_thread_count(2);
  take_steps(*restarted, steps);
  expect_same_state(*whole, *restarted);
}

TEST_P(Reproducibility, RestartDoesNotMatter) {
  expect_restart(2, GetParam(), 15);
  expect_restart(3, GetParam(), 10);
}

TEST_P(Reproducibility, RestartDoesNotMatterWithFBar) { expect_restart(2, GetParam().with("f_bar: true"), 15); }

INSTANTIATE_TEST_SUITE_P(Schemes, Reproducibility, ::testing::ValuesIn(all_schemes()), scheme_name);

/// The same dam, saturated, with its pore water: of two permeabilities, drained at the surface, loaded by its weight.
std::unique_ptr<Simulation> wet_dam(int dimension, const std::string& formulation) {
  const std::string soil =
      "{{model: mohr_coulomb, density: 1600 kg/m3, youngs_modulus: 1 MPa, poisson_ratio: 0.3, friction_angle: 20 deg, "
      "cohesion: 1 kPa, water: {{porosity: 0.4, permeability: {} m/s}}}}";
  SceneText scene = dam_scene(dimension == 2, "0.5 m");
  scene.material = fmt::format(fmt::runtime(soil), "1e-3") + "\n  clay: " + fmt::format(fmt::runtime(soil), "1e-6");
  scene.physics = "two_phase";
  scene.more = fmt::format("water: {{formulation: {}, bulk_modulus: 2.2 GPa}}\n", formulation);
  auto simulation = simulate(scene);
  set_column(simulation->particles(), "velocity", 0, [](const auto& x) { return 3 + 0.3 * x[1]; });
  return simulation;
}

class WetReproducibility : public ::testing::TestWithParam<std::string> {
 protected:
  void TearDown() override { set_thread_count(1); }
};

// The factor of the matrix is kept over many steps and lags behind it: it is part of the state.
TEST_P(WetReproducibility, NeitherThreadsNorRestartMatter) {
  for (const int dimension : {2, 3}) {
    SCOPED_TRACE(fmt::format("{}-D", dimension));
    const int steps = dimension == 2 ? 60 : 15;
    set_thread_count(1);
    const auto whole = wet_dam(dimension, GetParam());
    take_steps(*whole, steps);
    const Archive archive = archive_of(*whole);
    take_steps(*whole, steps);
    EXPECT_GT(largest_magnitude(by_id(whole->particles(), "pore_pressure")), 1000);
    for (const int threads : {2, 3}) {
      set_thread_count(threads);
      SCOPED_TRACE(fmt::format("{} threads", threads));
      const auto other = wet_dam(dimension, GetParam());
      take_steps(*other, 2 * steps);
      expect_same_state(*whole, *other);
      const auto restarted = wet_dam(dimension, GetParam());
      restarted->restore(archive);
      take_steps(*restarted, steps);
      expect_same_state(*whole, *restarted);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Formulations, WetReproducibility, ::testing::Values("u-p", "v-w-p", "explicit"),
                         [](const auto& test) {
                           std::string name = test.param;
                           std::erase(name, '-');
                           return name;
                         });

// A particle that leaves is taken out between two sorts; a checkpoint that is taken right then must hold the others.
TEST(RestartAfterOutflow, RemovedParticlesStayRemoved) {
  const auto make = [] {
    return simulate({.grid = "{min: [0 m, 0 m], max: [16 m, 4 m], cell: 0.5 m}",
                     .bodies = "  - {material: soil, box: {min: [12 m, 1 m], max: [15 m, 3 m]}, velocity: [2 m/s, 0]}",
                     .scheme = Scheme{}.with("time_step: 5 ms"),
                     .outflow = "remove"});
  };
  const auto whole = make();
  while (whole->removed_particles() == 0) whole->advance(1e6);
  const Archive archive = archive_of(*whole);
  const auto& blocks = archive.integers.at("blocks");  // first cell and end of each block
  EXPECT_TRUE(blocks.empty() || blocks.back() == static_cast<std::int64_t>(whole->particles().size()));
  const auto restarted = make();
  restarted->restore(archive);
  EXPECT_EQ(restarted->removed_particles(), whole->removed_particles());
  take_steps(*whole, 100);
  take_steps(*restarted, 100);
  EXPECT_GT(whole->removed_particles(), 0u);
  expect_same_state(*whole, *restarted);
}

}  // namespace
}  // namespace sluice
