/// The choice of the time step: which limit is the smallest, growth, and how output times are met.
#include "core/simulation/time_step.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace sluice {
namespace {

Case definition(const std::string& time_step) {
  return parse_case(
      "schema: 1\nphysics: total_stress\nend_time: 100 s\n"
      "grid: {min: [0 m, 0 m], max: [4 m, 4 m], cell: [0.5 m, 1 m]}\n"
      "materials: {soil: {model: linear_elastic, density: 1000 kg/m3, youngs_modulus: 1 MPa}}\n"
      "bodies: [{material: soil, box: {min: [1 m, 1 m], max: [2 m, 2 m]}}]\n"
      "scheme: {time_step: " +
          time_step + "}\n",
      "step.yaml");
}

/// A physics whose limits are what the test says.
class Limits final : public PhysicsModule<2> {
 public:
  double wave = 1, advection = 2, hard = 3;
  void declare(Particles&) override {}
  double density(int) const override { return 1; }
  void initialise(Scene<2>&) override {}
  std::vector<TimeStepLimit> hard_limits(const Scene<2>&) const override { return {{hard, "wave"}}; }
  std::vector<TimeStepLimit> time_step_limits(const Scene<2>&) const override {
    return {{wave, "wave"}, {advection, "advection"}};
  }
  void step(Scene<2>&, double) override {}
  void store(Archive&) const override {}
  void restore(const Archive&) override {}
  std::vector<std::pair<std::string, double>> energies(const Scene<2>&) const override { return {}; }
  std::vector<std::pair<std::string, Node>> resolved_sections() const override { return {}; }
};

double limit(const std::vector<TimeStepLimit>& limits, const std::string& name) {
  for (const auto& l : limits)
    if (l.name == name) return l.seconds;
  ADD_FAILURE() << "no limit is called " << name;
  return 0;
}

// The smallest cell counts: 0.5 m. c = 10 m/s, |v| = 5 m/s, strain rate 0.2 / s.
TEST(TimeStep, LimitsFollowTheirFormulas) {
  Scene<2> scene(definition("computed"));
  scene.motion.largest_speed_squared = 25;
  scene.motion.largest_strain_rate = 0.2;
  const auto limits = explicit_limits(scene, 10, {0.5, 0.2, 0.05});
  EXPECT_DOUBLE_EQ(limit(limits, "wave"), 0.5 * 0.5 / 15);
  EXPECT_DOUBLE_EQ(limit(limits, "advection"), 0.2 * 0.5 / 5);
  EXPECT_DOUBLE_EQ(limit(limits, "strain"), 0.05 / 0.2);
  EXPECT_EQ(smallest(limits).name, "wave");
}

TEST(TimeStep, NothingMovingLeavesTheWaveAlone) {
  const auto limits = explicit_limits(Scene<2>(definition("computed")), 10, {0.5, 0.2, 0.05});
  EXPECT_EQ(limit(limits, "advection"), INFINITY);
  EXPECT_EQ(limit(limits, "strain"), INFINITY);
}

TEST(TimeStep, TheSmallestLimitIsTakenAndNamed) {
  Scene<2> scene(definition("computed"));
  Limits physics;
  EXPECT_EQ(choose_time_step(physics, scene, 1000).name, "wave");
  EXPECT_EQ(choose_time_step(physics, scene, 1000).seconds, 1);
  physics.advection = 0.25;
  EXPECT_EQ(choose_time_step(physics, scene, 1000).name, "advection");
  EXPECT_EQ(choose_time_step(physics, scene, 1000).seconds, 0.25);
}

TEST(TimeStep, GrowsByATenthAtMost) {
  Scene<2> scene(definition("computed"));
  scene.previous_dt = 0.5;
  const TimeStepLimit dt = choose_time_step(Limits(), scene, 1000);
  EXPECT_DOUBLE_EQ(dt.seconds, 0.55);
  EXPECT_EQ(dt.name, "growth");
}

// 2.5 s ahead at 1 s a step: three equal steps rather than two and a half.
TEST(TimeStep, OutputTimesAreMetByEqualSteps) {
  Scene<2> scene(definition("computed"));
  EXPECT_DOUBLE_EQ(choose_time_step(Limits(), scene, 2.5).seconds, 2.5 / 3);
  EXPECT_DOUBLE_EQ(choose_time_step(Limits(), scene, 0.1).seconds, 0.1);
  EXPECT_EQ(choose_time_step(Limits(), scene, 0.1).name, "output");
}

TEST(TimeStep, AFixedStepIsKeptToTheLastDigit) {
  Scene<2> scene(definition("0.7 s"));
  EXPECT_EQ(choose_time_step(Limits(), scene, 1000).seconds, 0.7);
  EXPECT_EQ(choose_time_step(Limits(), scene, 1).seconds, 0.7);
  EXPECT_EQ(choose_time_step(Limits(), scene, 1).name, "fixed");
  EXPECT_DOUBLE_EQ(choose_time_step(Limits(), scene, 0.3).seconds, 0.3);  // a true remainder
}

TEST(TimeStep, AFixedStepAboveTheHardLimitIsAnError) {
  Scene<2> scene(definition("3.5 s"));
  scene.step = 17;
  try {
    choose_time_step(Limits(), scene, 1000);
    FAIL() << "accepted";
  } catch (const CaseError& error) {
    const std::string message = error.what();
    for (const char* word : {"time_step", "3.5 s", "wave", "3 s", "step 17", "computed"})
      EXPECT_NE(message.find(word), std::string::npos) << word << " in: " << message;
  }
}

}  // namespace
}  // namespace sluice
