/// F7: a column of particles that stands by a share delta inside the next cell gives the node behind it a mass of the
/// order of delta (quadratic functions: delta^2), and a force of the order of one (of delta). Sources: that estimate,
/// in the comments; eigenvalues of the step (tests/verification/linear_bar.h). docs/stability/f07_small_cuts.md.
#include "tests/figures.h"
#include "tests/stability/free_bar.h"

namespace sluice {
namespace {

/// The other particles lie off the edges, where uGIMP's would begin and end.
FreeBar bar_with_cut(const Scheme& scheme, double delta) { return {.scheme = scheme, .offset = 0.05, .cut = delta}; }

std::vector<Scheme> schemes() {
  auto all = all_schemes();
  std::erase_if(all, [](const Scheme& s) { return s.by_corners(); });
  return all;
}

/// Linear functions give the small node the acceleration sigma / (rho delta h), and the particle the strain rate of
/// that over a cell. Where the strain of a step comes from that velocity (USL), stress and strain of the particle are
/// an oscillator of the frequency (c / h) / sqrt(delta). With FLIP or XPIC the node's velocity starts anew from the
/// particle in each step: 1 - Cr^2 / delta is the factor of the stress in a step, and the limit Cr^2 = 2 delta. With an
/// affine field the particle hands the node's velocity on, whatever the timing; an oscillator with memory has the limit
/// Cr^2 = 4 delta. Half a step of MUSL is the particle's own velocity: no limit.
struct CutLimit : ::testing::TestWithParam<Scheme> {};

TEST_P(CutLimit, IsThatOfLinearTheory) {
  const bool whole = figures_folder() != nullptr;
  FigureTable table("small_cuts", "shape,transfer,stress_update,delta,measured,predicted");
  for (const double j : whole ? std::vector<double>{0.5, 1, 1.5, 2, 3, 4, 5, 6, 7, 8} : std::vector<double>{2, 6}) {
    const FreeBar bar = bar_with_cut(GetParam(), std::pow(10, -j));
    const double measured = measured_limit(bar, 1e-5), predicted = predicted_limit(bar, 1e-5);
    table.row(GetParam().shape, GetParam().transfer, GetParam().stress_update, std::pow(10, -j), measured, predicted);
    EXPECT_NEAR(measured / predicted, 1, 0.08) << "delta = 1e-" << j;
  }
}

// In numbers: which schemes have no limit that goes to zero, and how it does with the others.
TEST(SmallCuts, LimitsOfLinearFunctions) {
  for (const double delta : {1e-3, 1e-5}) {
    const auto limit = [&](const char* shape, const char* transfer, const char* timing) {
      return measured_limit(bar_with_cut({shape, transfer, timing, 1, {}}, delta), 1e-5);
    };
    EXPECT_NEAR(limit("linear", "flip", "usl") / std::sqrt(2 * delta), 1, 0.03);
    EXPECT_NEAR(limit("linear", "xpic", "usl") / std::sqrt(2 * delta), 1, 0.03);
    for (const char* timing : {"usf", "usl", "musl"})
      EXPECT_NEAR(limit("linear", "apic", timing) / std::sqrt(4 * delta), 1, 0.03) << timing;
    // The remedies.
    for (const char* timing : {"usf", "musl"}) EXPECT_GT(limit("linear", "flip", timing), 0.99) << timing;
    EXPECT_GT(limit("quadratic_bspline", "flip", "usl"), 0.66);
    EXPECT_GT(limit("quadratic_bspline", "apic", "usl"), 0.66);
  }
}

/// The strain rate of the last particle after the first step from rest under the stress sigma, over sigma kappa / (rho
/// h^2), kappa being half of the step. It is that of the velocities of the nodes (USL).
double strain_rate_at_cut(const std::string& shape, double delta) {
  constexpr double dt = 1e-6, sigma = 1;
  const FreeBar bar = bar_with_cut({shape, "flip", "usl", 1, {}}, delta);
  UnguardedRun run(bar.scene());
  Particles& particles = run.particles();
  set_column(particles, "position", 0, [&](const auto& x) { return bar.place(x[0]); });
  set_column(particles, "stress", 0, [&](const auto&) { return sigma; });
  run.steps(1, dt);
  const auto x = by_id(particles, "position"), stress = by_id(particles, "stress");
  const auto last = static_cast<std::size_t>(std::max_element(x.begin(), x.end()) - x.begin());
  return std::abs(stress[last] - sigma) / (FreeBar::modulus * dt) / (sigma * dt / 2);
}

// The node behind the edge has the mass delta m_p and the force sigma V_p / h: the strain rate of the particle, which
// is the difference of the accelerations of two nodes, goes with 1 / delta. Quadratic functions have mass delta^2 / 2
// and force delta, and the particle sees that node with a slope of delta: bounded.
TEST(SmallCuts, StrainRateOfLinearFunctionsGoesWithOneOverDelta) {
  FigureTable table("small_cuts_strain_rate", "delta,linear,ugimp,quadratic_bspline,cubic_bspline");
  for (double j = 1; j < 8.5; j += 0.5) {
    const double delta = std::pow(10, -j), linear = strain_rate_at_cut("linear", delta);
    const double ugimp = strain_rate_at_cut("ugimp", delta), quadratic = strain_rate_at_cut("quadratic_bspline", delta);
    const double cubic = strain_rate_at_cut("cubic_bspline", delta);
    table.row(delta, linear, ugimp, quadratic, cubic);
    if (j >= 3) {
      EXPECT_NEAR(linear * delta, 1, 0.01) << delta;
    }
    EXPECT_LT(std::max({ugimp, quadratic, cubic}), 5) << delta;
  }
}

INSTANTIATE_TEST_SUITE_P(Schemes, CutLimit, ::testing::ValuesIn(schemes()), scheme_name);

}  // namespace
}  // namespace sluice
