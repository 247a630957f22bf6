/// What stops a run, and with which words: outflow, values that are not finite, inversion, a fixed step too long.
/// Sources: the declared policies; the hard limits h / (c + |v|), h / (2 |v|) and 1 / (2 strain rate).
#include <limits>

#include "core/simulation/guard.h"
#include "core/simulation/physics_module.h"
#include "tests/verification/scene_fixture.h"

namespace sluice {
namespace {

/// A block near the right face, moving towards it.
std::unique_ptr<Simulation> leaving_block(int dimension, const std::string& outflow, const Scheme& scheme = {}) {
  const bool flat = dimension == 2;
  return simulate({.grid = flat ? "{min: [0 m, 0 m], max: [8 m, 4 m], cell: 0.5 m}"
                                : "{min: [0 m, 0 m, 0 m], max: [8 m, 4 m, 4 m], cell: 0.5 m}",
                   .bodies = flat
                                 ? "  - {material: soil, box: {min: [6 m, 1 m], max: [7 m, 2 m]}, velocity: [2 m/s, 0]}"
                                 : "  - {material: soil, box: {min: [6 m, 1 m, 1 m], max: [7 m, 2 m, 2 m]}, velocity: "
                                   "[2 m/s, 0, 0]}",
                   .scheme = scheme.with("time_step: 5 ms"),
                   .outflow = outflow});
}

template <class Error, class Action>
std::string message_of(const Action& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  } catch (const std::exception& error) {
    ADD_FAILURE() << "another kind of error: " << error.what();
    return "";
  }
  ADD_FAILURE() << "no error";
  return "";
}

void expect_words(const std::string& message, const std::vector<std::string>& words) {
  for (const std::string& word : words) EXPECT_NE(message.find(word), std::string::npos) << word << " in: " << message;
}

TEST(Outflow, ErrorNamesTheParticleAndTheRemedies) {
  for (const int dimension : {2, 3}) {
    const auto simulation = leaving_block(dimension, "error");
    const std::string message = message_of<OutflowError>([&] { simulation->advance_to(2); });
    expect_words(message, {"particle ", "(soil)", "left the grid", "step ", "outflow: remove", "outflow: clamp"});
  }
}

// The block needs 1 m at 2 m/s for its first column to arrive, and another metre until all are gone.
TEST(Outflow, RemoveTakesOutWhatHasLeft) {
  for (const int dimension : {2, 3}) {
    const auto simulation = leaving_block(dimension, "remove");
    const std::size_t count = simulation->particles().size();
    simulation->advance_to(0.75);
    EXPECT_GT(simulation->removed_particles(), count / 4);
    EXPECT_LT(simulation->removed_particles(), 3 * count / 4);
    EXPECT_EQ(simulation->particles().size() + simulation->removed_particles(), count);
    for (const double x : simulation->particles().columns.values(simulation->particles().position)) EXPECT_LT(x, 8);
    simulation->advance_to(1.5);
    EXPECT_EQ(simulation->particles().size(), 0u);
    EXPECT_EQ(simulation->removed_particles(), count);
  }
}

TEST(Outflow, ClampKeepsAllParticlesInside) {
  for (const int dimension : {2, 3}) {
    const auto simulation = leaving_block(dimension, "clamp");
    const std::size_t count = simulation->particles().size();
    simulation->advance_to(0.6);
    EXPECT_EQ(simulation->particles().size(), count);
    EXPECT_EQ(simulation->removed_particles(), 0u);
    double furthest = 0;
    for (const double x : simulation->particles().columns.values(simulation->particles().position))
      furthest = std::max(furthest, x);
    EXPECT_EQ(furthest, std::nextafter(8.0, 0.0));
  }
}

// Two blocks far apart, one particle of one of them made bad: it, or one that shares its nodes, is named.
class Guard : public ::testing::TestWithParam<Scheme> {
 protected:
  static std::unique_ptr<Simulation> two_blocks() {
    return simulate(
        {.grid = "{min: [0 m, 0 m], max: [40 m, 8 m], cell: 1 m}",
         .material = "{model: linear_elastic, density: 1000 kg/m3, youngs_modulus: 1 MPa, poisson_ratio: 0}\n"
                     "  rock: {model: linear_elastic, density: 1000 kg/m3, youngs_modulus: 1 MPa, poisson_ratio: 0}",
         .bodies = "  - {material: soil, box: {min: [2 m, 2 m], max: [6 m, 6 m]}}\n"
                   "  - {material: rock, particles_per_cell: 1, box: {min: [30 m, 3 m], max: [31 m, 4 m]}}",
         .scheme = GetParam().with("time_step: 5 ms")});
  }
  static std::size_t rock_of(const Particles& particles) {
    return static_cast<std::size_t>(std::find(particles.material.begin(), particles.material.end(), 1) -
                                    particles.material.begin());
  }
};

TEST_P(Guard, NamesTheParticleWhoseVelocityIsNotFinite) {
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    const auto simulation = two_blocks();
    take_steps(*simulation, 3);
    Particles& particles = simulation->particles();
    const std::size_t rock = rock_of(particles);
    const auto id = particles.id[rock];
    particles.columns.data(particles.velocity)[rock] = bad;
    const std::string message = message_of<PhysicsError>([&] { simulation->advance(1e6); });
    expect_words(message, {fmt::format("particle {} (rock)", id), "not finite", "in step 4 ", "checkpoint"});
  }
}

TEST_P(Guard, NamesTheParticleWhoseStressIsNotFinite) {
  const auto simulation = two_blocks();
  take_steps(*simulation, 3);
  Particles& particles = simulation->particles();
  const std::size_t rock = rock_of(particles);
  const auto id = particles.id[rock];
  particles.columns.data(particles.stress, 3)[rock] = std::numeric_limits<double>::quiet_NaN();
  expect_words(message_of<PhysicsError>([&] { take_steps(*simulation, 2); }),
               {fmt::format("particle {} (rock)", id), "not finite"});
}

INSTANTIATE_TEST_SUITE_P(Schemes, Guard, ::testing::ValuesIn(all_schemes()), scheme_name);

// Two points close in on each other within a cell by more than their volume in one step: a computed step would not let
// that happen, so the velocities are set between two steps.
TEST(GuardOfVolumes, NamesAnInvertedParticle) {
  const auto simulation = simulate({.grid = "{min: [0 m, 0 m], max: [8 m, 8 m], cell: 1 m}",
                                    .bodies = "  - {material: soil, box: {min: [2 m, 2 m], max: [6 m, 6 m]}}"});
  take_steps(*simulation, 3);
  set_column(simulation->particles(), "velocity", 0, [](const auto& x) { return -200 * (x[0] - 4); });
  const std::string message = message_of<PhysicsError>([&] { take_steps(*simulation, 2); });
  expect_words(message, {"particle ", "(soil)", "invert", "volume", "step 4"});
}

// c = 31.6 m/s, h = 0.5 m: the wave limit is 15.8 ms; with nothing moving it is the only one.
TEST(FixedStep, BeyondTheWaveLimitIsAnErrorThatStatesIt) {
  SceneText scene{.grid = "{min: [0 m, 0 m], max: [8 m, 4 m], cell: 0.5 m}",
                  .bodies = "  - {material: soil, box: {min: [2 m, 1 m], max: [3 m, 2 m]}}",
                  .scheme = Scheme{}.with("time_step: 16 ms")};
  const std::string message = message_of<CaseError>([&] { simulate(scene)->advance(1); });
  expect_words(message, {"time_step", "0.016", "wave", "0.01581"});
  scene.scheme.more = "time_step: 15.8 ms";
  EXPECT_NO_THROW(simulate(scene)->advance(1));
}

// At 20 m/s half a cell takes 12.5 ms; the wave limit with the speed added is 9.7 ms.
TEST(FixedStep, MovingMaterialCountsAgainstTheLimit) {
  SceneText scene{.grid = "{min: [0 m, 0 m], max: [8 m, 4 m], cell: 0.5 m}",
                  .bodies = "  - {material: soil, box: {min: [2 m, 1 m], max: [3 m, 2 m]}, velocity: [20 m/s, 0]}",
                  .scheme = Scheme{}.with("time_step: 12 ms")};
  expect_words(message_of<CaseError>([&] { simulate(scene)->advance(1); }), {"wave", "0.009686"});
}

// 10^12 cells; only those that hold material cost anything. Half a gigabyte and some hours would be needed otherwise.
TEST(ActiveBlocks, ATinyBodyInAHugeGridRuns) {
  const auto simulation =
      simulate({.grid = "{min: [0 m, 0 m], max: [1000000 m, 1000000 m], cell: 1 m}",
                .bodies = "  - {material: soil, box: {min: [700000 m, 900000 m], max: [700003 m, 900003 m]}, "
                          "velocity: [5 m/s, 0]}",
                .gravity = "[0, -10 m/s2]"});
  EXPECT_EQ(simulation->particles().size(), 36u);
  simulation->advance_to(1);
  EXPECT_NEAR(by_id(simulation->particles(), "position")[0], 700005.25, 1e-6);
  EXPECT_LT(simulation->memory(), 1000000u);
}

// CPDI has no moments for APIC, which is the default.
TEST(Schemes, ApicIsRefusedWithShapesByCorners) {
  for (const char* shape : {"cpdi", "cpdi2"}) {
    try {
      simulate({.grid = "{min: [0 m, 0 m], max: [4 m, 4 m], cell: 1 m}",
                .bodies = "  - {material: soil, box: {min: [0 m, 0 m], max: [1 m, 1 m]}}",
                .scheme = {shape, "apic", "usl", 1, {}}});
      ADD_FAILURE() << shape;
    } catch (const CaseError& error) {
      const std::string message = error.what();
      EXPECT_NE(message.find(fmt::format("scheme: transfer 'apic' needs moments of the shape functions, which shape "
                                         "'{}' does not have; take tpic, xpic or flip",
                                         shape)),
                std::string::npos)
          << message;
      EXPECT_EQ(message.find("scene.yaml:"), 0u) << message;
    }
  }
}

}  // namespace
}  // namespace sluice
