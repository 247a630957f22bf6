/// F2: what particles have and nodes cannot see. Sources: Gritton & Berzins (2017); Hammerquist & Nairn (2017): FLIP
/// keeps such a velocity for ever; PIC, APIC, TPIC and XPIC of any order end it in one step.
#include "tests/verification/scene_fixture.h"

namespace sluice {
namespace {

constexpr double epsilon = 1e-3;

/// Velocities, or stresses along the bar, that alternate from particle to particle along a bar, two in a cell: nothing
/// on any node but near the ends. Returns the largest one left in the middle after `steps`, over the one at the start.
/// The bar is so soft that no wave comes from the ends.
double alternating_left(int dimension, const Scheme& scheme, int steps, const std::string& column = "velocity") {
  const bool flat = dimension == 2;
  const auto simulation =
      simulate({.grid = flat ? "{min: [0 m, 0 m], max: [24 m, 2 m], cell: 1 m}"
                             : "{min: [0 m, 0 m, 0 m], max: [24 m, 2 m, 2 m], cell: 1 m}",
                .material = "{model: linear_elastic, density: 1000 kg/m3, youngs_modulus: 1 Pa, poisson_ratio: 0}",
                .bodies = flat ? "  - {material: soil, box: {min: [0 m, 0 m], max: [24 m, 2 m]}}"
                               : "  - {material: soil, box: {min: [0 m, 0 m, 0 m], max: [24 m, 2 m, 2 m]}}",
                .scheme = scheme.with("time_step: 1 ms")});
  Particles& particles = simulation->particles();
  set_column(particles, column, 0,
             [](const auto& x) { return std::lround(2 * x[0] - 0.5) % 2 == 0 ? epsilon : -epsilon; });
  const auto x0 = by_id(particles, "position");
  take_steps(*simulation, steps);
  const auto v = by_id(particles, column);
  double largest = 0;
  for (std::size_t p = 0; p < v.size(); ++p)
    if (std::abs(x0[p] - 12) < 1) largest = std::max(largest, std::abs(v[p]));
  return largest / epsilon;
}

class NullSpace : public ::testing::TestWithParam<Scheme> {};

// Round-off: what comes from the ends in one step stays within 8 cells of them. The negative control is FLIP, which
// keeps the whole of it over 1000 steps.
TEST_P(NullSpace, IsEndedInOneStepButByFlip) {
  for (const int dimension : {2, 3}) {
    if (GetParam().transfer == "flip")
      EXPECT_NEAR(alternating_left(dimension, GetParam(), dimension == 2 ? 1000 : 100), 1, 1e-3) << dimension << "-D";
    else
      EXPECT_LT(alternating_left(dimension, GetParam(), 1), 1e-12) << dimension << "-D";
  }
}

// Stresses are different: no scheme whose stresses live on particles sees, and ends, such a field. It does no harm by
// itself; F-bar keeps volumetric strain from feeding it (tests/verification/f_bar.cpp).
TEST_P(NullSpace, OfStressesStaysForEver) { EXPECT_NEAR(alternating_left(2, GetParam(), 1000, "stress"), 1, 1e-3); }

INSTANTIATE_TEST_SUITE_P(Schemes, NullSpace, ::testing::ValuesIn(all_schemes()), scheme_name);

/// The share of a checkerboard of four (eight) particles in a single cell that is left after a step.
double checkerboard_left(int dimension, const Scheme& scheme) {
  const bool flat = dimension == 2;
  const auto simulation =
      simulate({.grid = flat ? "{min: [0 m, 0 m], max: [1 m, 1 m], cell: 1 m}"
                             : "{min: [0 m, 0 m, 0 m], max: [1 m, 1 m, 1 m], cell: 1 m}",
                .bodies = flat ? "  - {material: soil, box: {min: [0 m, 0 m], max: [1 m, 1 m]}}"
                               : "  - {material: soil, box: {min: [0 m, 0 m, 0 m], max: [1 m, 1 m, 1 m]}}",
                .scheme = scheme.with(scheme.more.empty() ? "time_step: 1 ms" : scheme.more + ", time_step: 1 ms")});
  Particles& particles = simulation->particles();
  const auto sign = [&](const auto& x) {
    double s = 1;
    for (int a = 0; a < dimension; ++a) s *= x[static_cast<std::size_t>(a)] < 0.5 ? 1 : -1;
    return s;
  };
  set_column(particles, "velocity", 0, [&](const auto& x) { return epsilon * sign(x); });
  auto mode = by_id(particles, "velocity");
  for (double& m : mode) m /= epsilon;
  take_steps(*simulation, 1);
  return std::abs(dot(by_id(particles, "velocity"), mode)) / (epsilon * static_cast<double>(mode.size()));
}

// The nodes of one cell do see this field: s = (1/4)^d of it comes back from them. PIC keeps that, XPIC(m) keeps
// 1 - (1 - s)^m. Round-off.
TEST(CheckerboardOfOneCell, XpicKeepsWhatTheNodesSee) {
  for (const int dimension : {2, 3}) {
    const double s = std::pow(0.25, dimension);
    for (const int m : {1, 2, 5}) {
      const double left = checkerboard_left(dimension, {"linear", "xpic", "usf", 1, fmt::format("xpic_order: {}", m)});
      EXPECT_NEAR(left, 1 - std::pow(1 - s, m), 1e-12) << dimension << "-D, order " << m;
    }
  }
}

}  // namespace
}  // namespace sluice
