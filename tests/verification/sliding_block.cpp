/// A block on a rough floor under gravity inclined by theta. Source: rigid-body statics, a = g (sin theta - mu cos theta) if
/// mu < tan theta, else it sticks.
#include <numbers>

#include "tests/verification/scene_fixture.h"

namespace sluice {
namespace {

constexpr double g = 9.81, theta = 30 * std::numbers::pi / 180, density = 1800, height = 1;

/// Stiff: settles by 1e-5 of its height. The weight's vertical stress is there from the start, so that it does not bounce.
std::unique_ptr<Simulation> block(int dimension, const Scheme& scheme, double friction, double start = 0) {
  const bool flat = dimension == 2;
  auto simulation = simulate({.grid = flat ? "{min: [-1 m, 0 m], max: [6 m, 2 m], cell: 0.25 m}"
                                           : "{min: [-1 m, 0 m, 0 m], max: [5 m, 1.5 m, 1.5 m], cell: 0.25 m}",
                              .material = "{model: linear_elastic, density: 1800 kg/m3, youngs_modulus: 1 GPa, poisson_ratio: 0}",
                              .bodies = flat ? fmt::format("  - {{material: soil, box: {{min: [0 m, 0 m], max: [2 m, 1 m]}}, velocity: [{} m/s, 0]}}", start)
                                             : fmt::format("  - {{material: soil, box: {{min: [0 m, 0.25 m, 0 m], max: [2 m, 1.25 m, 1 m]}}, velocity: [{} m/s, 0, 0]}}", start),
                              .gravity = flat ? fmt::format("[{} m/s2, {} m/s2]", g * std::sin(theta), -g * std::cos(theta))
                                              : fmt::format("[{} m/s2, 0, {} m/s2]", g * std::sin(theta), -g * std::cos(theta)),
                              .boundaries = fmt::format("{{bottom: {{normal: fixed, friction: {}}}}}", friction),
                              .scheme = scheme});
  const std::size_t up = flat ? 1 : 2;
  set_column(simulation->particles(), "stress", static_cast<int>(up),
             [&](const auto& x) { return -density * g * std::cos(theta) * (height - x[up]); });
  return simulation;
}

double mean(const Particles& particles, const std::string& column) {
  const auto mass = by_id(particles, "mass");
  return dot(mass, by_id(particles, column)) / sum(mass);
}

class SlidingBlock : public ::testing::TestWithParam<Scheme> {};

TEST_P(SlidingBlock, M) {
  for (int d : {2}) for (double mu : {0.1, 0.4, 0.5773, 0.7}) {
  try{
  const auto simulation = block(d, GetParam(), mu);
  const double x0 = mean(simulation->particles(), "position");
  simulation->advance_to(0.5);
  const double t = simulation->time(), a = 2 * (mean(simulation->particles(), "position") - x0) / t / t, exact = std::max(0., g * (std::sin(theta) - mu * std::cos(theta)));
  fmt::print("{:30} {} mu {} a {:.5f} exact {:.5f} rel {:.2e} steps {} drop {:.2e}\n", GetParam().name(), d, mu, a, exact, a / exact - 1, simulation->steps(), largest_magnitude(by_id(simulation->particles(),"velocity",1)));}catch(std::exception&e){puts(e.what());}
  }
}

INSTANTIATE_TEST_SUITE_P(Schemes, SlidingBlock, ::testing::ValuesIn(all_schemes()), scheme_name);

}  // namespace
}  // namespace sluice
