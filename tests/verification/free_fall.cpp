/// Free fall. Source: leap-frog bookkeeping, x(t) = g t^2 / 2 exactly when velocities live at the middle of steps and
/// the first kick is half a step long (the error that a semi-implicit Euler step makes is g dt t / 2).
#include "tests/verification/scene_fixture.h"

namespace sluice {
namespace {

class FreeFall : public ::testing::TestWithParam<Scheme> {};

/// Tolerance: 1e-12 relative, which is round-off over a few hundred steps. With linear functions a node at the rim may
/// hold any small share of a particle, and what round-off does to it is divided by that mass: 1e-7. The error of a
/// missing half kick would be dt / t, about 1e-2 here.
void expect_exact_fall(Simulation& simulation, const std::vector<double>& gravity, double until, const Scheme& scheme) {
  const double tolerance = scheme.linear() ? 1e-7 : 1e-12;
  double dt = 0;
  while (simulation.time() < until) dt = simulation.advance(until).dt;
  const double t = simulation.time(), scale = std::hypot(gravity[0], gravity[1]);
  for (int a = 0; a < simulation.particles().dimension; ++a) {
    const double g = gravity[static_cast<std::size_t>(a)];
    const auto x = by_id(simulation.particles(), "position", a),
               x0 = by_id(simulation.particles(), "initial_position", a);
    const auto v = by_id(simulation.particles(), "velocity", a);
    for (std::size_t p = 0; p < x.size(); ++p) {
      ASSERT_NEAR(x[p] - x0[p], g * t * t / 2, tolerance * scale * t * t / 2) << "particle " << p << " along " << a;
      ASSERT_NEAR(v[p], g * (t - dt / 2), tolerance * scale * t) << "particle " << p << " along " << a;
    }
  }
}

SceneText falling_block(const Scheme& scheme) {
  return {.grid = "{min: [-8 m, -8 m], max: [8 m, 4 m], cell: 0.5 m}",
          .bodies = "  - {material: soil, box: {min: [-1 m, 0 m], max: [1.25 m, 1.5 m]}}",
          .gravity = "[4 m/s2, -9 m/s2]",
          .scheme = scheme};
}

TEST_P(FreeFall, IsExactWithAFixedStep) {
  const auto simulation = simulate(falling_block(GetParam().with("time_step: 4 ms")));
  expect_exact_fall(*simulation, {4, -9}, 1, GetParam());
  EXPECT_EQ(simulation->steps(), 250);
}

// The limits change from wave to advection on the way, and the last step is cut to meet the end.
TEST_P(FreeFall, IsExactWithComputedSteps) {
  const auto simulation = simulate(falling_block(GetParam().with("advection: 0.02")));
  const double first = simulation->advance(1.1).dt;
  const double second = simulation->advance(1.1).dt;
  EXPECT_NE(first, second);
  expect_exact_fall(*simulation, {4, -9}, 1.1, GetParam());
}

TEST_P(FreeFall, IsExactInThreeDimensions) {
  const auto simulation =
      simulate({.grid = "{min: [-4 m, -4 m, -4 m], max: [4 m, 4 m, 4 m], cell: 0.5 m}",
                .bodies = "  - {material: soil, box: {min: [-1 m, 0 m, 0 m], max: [0.25 m, 1 m, 1.5 m]}}",
                .gravity = "[3 m/s2, -2 m/s2, -6 m/s2]",
                .scheme = GetParam().with("advection: 0.1")});
  expect_exact_fall(*simulation, {3, -2, -6}, 0.9, GetParam());
}

// Nothing strains in free fall, so nothing may be stressed. Round-off over cells and steps is 1e-9 of the modulus, 1e-6
// with linear functions (see above). At t = 0.5 s the lowest and the highest points lie exactly on cell edges (F15).
TEST_P(FreeFall, LeavesNoStress) {
  const auto simulation = simulate(falling_block(GetParam().with("time_step: 4 ms")));
  simulation->advance_to(1);
  const double tolerance = GetParam().linear() ? 1e-6 : 1e-9;
  for (int c = 0; c < 4; ++c)
    EXPECT_LT(largest_magnitude(by_id(simulation->particles(), "stress", c)), tolerance * 1e6);
}

INSTANTIATE_TEST_SUITE_P(Schemes, FreeFall, ::testing::ValuesIn(all_schemes()), scheme_name);

}  // namespace
}  // namespace sluice
