/// A block on a rough floor under gravity inclined by theta. Source: rigid-body statics, a = g (sin theta - mu cos
/// theta) if mu < tan theta, else it sticks.
#include <numbers>

#include "tests/verification/scene_fixture.h"

namespace sluice {
namespace {

constexpr double g = 9.81, theta = 30 * std::numbers::pi / 180, density = 1800, height = 1;

/// Stiff: settles by 1e-5 of its height. Weight and friction are in equilibrium with its stresses from the start (but
/// for the small end faces), so that it neither bounces nor shears.
std::unique_ptr<Simulation> block(int dimension, const Scheme& scheme, double friction, double start = 0) {
  const bool flat = dimension == 2;
  auto simulation = simulate(
      {.grid = flat ? "{min: [-1 m, 0 m], max: [6 m, 2 m], cell: 0.25 m}"
                    : "{min: [-1 m, 0 m, 0 m], max: [5 m, 1.5 m, 1.5 m], cell: 0.25 m}",
       .material = "{model: linear_elastic, density: 1800 kg/m3, youngs_modulus: 1 GPa, poisson_ratio: 0}",
       .bodies =
           flat ? fmt::format(
                      "  - {{material: soil, box: {{min: [0 m, 0 m], max: [2 m, 1 m]}}, velocity: [{} m/s, 0]}}", start)
                : fmt::format("  - {{material: soil, box: {{min: [0 m, 0.25 m, 0 m], max: [2 m, 1.25 m, 1 m]}}, "
                              "velocity: [{} m/s, 0, 0]}}",
                              start),
       .gravity = flat ? fmt::format("[{} m/s2, {} m/s2]", g * std::sin(theta), -g * std::cos(theta))
                       : fmt::format("[{} m/s2, 0, {} m/s2]", g * std::sin(theta), -g * std::cos(theta)),
       .boundaries = fmt::format("{{bottom: {{normal: fixed, friction: {}}}}}", friction),
       .scheme = scheme});
  const std::size_t up = flat ? 1 : 2;
  set_column(simulation->particles(), "stress", static_cast<int>(up),
             [&](const auto& x) { return -density * g * std::cos(theta) * (height - x[up]); });
  const double traction = density * g * std::cos(theta) * std::min(friction, std::tan(theta));
  set_column(simulation->particles(), "stress", flat ? 3 : 5,
             [&](const auto& x) { return traction * (height - x[up]); });
  return simulation;
}

double mean(const Particles& particles, const std::string& column) {
  const auto mass = by_id(particles, "mass");
  return dot(mass, by_id(particles, column)) / sum(mass);
}

/// Mean acceleration along the floor from 0.1 s to `until`, when the block has crossed two cells at mu = 0.1.
double acceleration(int dimension, const Scheme& scheme, double friction, double until = 0.5) {
  const auto simulation = block(dimension, scheme, friction);
  simulation->advance_to(0.1);
  const double before = mean(simulation->particles(), "velocity");
  simulation->advance_to(until);
  return (mean(simulation->particles(), "velocity") - before) / (until - 0.1);
}

double exact_acceleration(double friction) { return g * (std::sin(theta) - friction * std::cos(theta)); }

constexpr double gate = 5e-3;  // the benchmark's, 0.5 %; measured: 4e-5

/// Linear functions make APIC and USL divide stresses by whatever small mass the first node ahead of the block has; a
/// stiff block does not survive that (F7). They are left out.
std::vector<Scheme> survivors() {
  auto schemes = all_schemes();
  std::erase_if(schemes, [](const Scheme& s) { return s.linear() && (s.affine() || s.stress_update == "usl"); });
  return schemes;
}

class SlidingBlock : public ::testing::TestWithParam<Scheme> {};

TEST_P(SlidingBlock, SlidesOnASmoothFloor) {
  EXPECT_NEAR(acceleration(2, GetParam(), 0.1) / exact_acceleration(0.1), 1, gate);
}

INSTANTIATE_TEST_SUITE_P(Schemes, SlidingBlock, ::testing::ValuesIn(survivors()), scheme_name);

/// Without any damping, an elastic block on a floor of high friction flutters (Martins, Guimaraes & Faria 1995), and
/// friction on average is not mu times its weight: FLIP with USF or MUSL is left out where friction is high.
std::vector<Scheme> damped() {
  auto schemes = transfers_and_timings();
  std::erase_if(schemes, [](const Scheme& s) { return !s.affine() && s.stress_update != "usl"; });
  return schemes;
}

class BlockOnARoughFloor : public ::testing::TestWithParam<Scheme> {};

TEST_P(BlockOnARoughFloor, Slides) { EXPECT_NEAR(acceleration(2, GetParam(), 0.4) / exact_acceleration(0.4), 1, gate); }

// tan theta = 0.577. What is left is the settling of the end faces: a thousandth of g.
TEST_P(BlockOnARoughFloor, SticksWhereFrictionExceedsTheSlope) {
  EXPECT_LT(std::abs(acceleration(2, GetParam(), 0.7)), 1e-3 * g);
}

// Friction stops a block that was thrown: v / (g (mu cos theta - sin theta)) later, and then it stays.
TEST_P(BlockOnARoughFloor, StopsAndStays) {
  const auto simulation = block(2, GetParam(), 0.9, 0.5);
  const double stop = 0.5 / -exact_acceleration(0.9), x0 = mean(simulation->particles(), "position");
  simulation->advance_to(1.5 * stop);
  EXPECT_LT(std::abs(mean(simulation->particles(), "velocity")), 0.01 * 0.5);
  EXPECT_NEAR((mean(simulation->particles(), "position") - x0) / (0.5 * stop / 2), 1, 0.02);
}

TEST_P(BlockOnARoughFloor, SlidesInThreeDimensions) {
  EXPECT_NEAR(acceleration(3, GetParam(), 0.4, 0.2) / exact_acceleration(0.4), 1, gate);
}

INSTANTIATE_TEST_SUITE_P(Schemes, BlockOnARoughFloor, ::testing::ValuesIn(damped()), transfer_and_timing);

}  // namespace
}  // namespace sluice
