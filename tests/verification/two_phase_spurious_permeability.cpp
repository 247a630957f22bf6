/// The permeability that a projection adds to the soil's: none, where the pressure is solved for in increments.
/// The rate at which the longest mode of a drained column decays, over the exact one. Source: (EX.26)-(EX.28).
#include <numbers>

#include "physics/exact/spurious_permeability.h"
#include "tests/figures.h"
#include "tests/verification/saturated_column.h"

namespace sluice {
namespace {

constexpr double wave_number = std::numbers::pi / 2;  // of a column of 1 m [1/m]
constexpr double amplitude = 1000;                    // [Pa]

SaturatedColumn column(const std::string& formulation, const std::string& shape, double beta,
                       double conductivity = 1e-5) {
  SaturatedColumn column;
  column.soil = sand(conductivity);
  column.formulation = formulation;
  column.water = fmt::format("increment: {}, ", beta);
  column.scheme.shape = shape;
  column.scheme = column.scheme.with("courant: 0.9");
  return column;
}

/// The skeleton is stretched as the water is pressed: no total stress.
std::unique_ptr<Simulation> in_the_longest_mode(const SaturatedColumn& column) {
  auto simulation = simulate(column);
  Particles& particles = simulation->particles();
  const auto mode = [](const auto& x) { return amplitude * std::cos(wave_number * x[1]); };
  const auto slope = [](const auto& x) { return -amplitude * wave_number * std::sin(wave_number * x[1]); };
  set_column(particles, "pore_pressure", 0, mode);
  set_column(particles, "pore_pressure_gradient", 1, slope);
  set_column(particles, "stress", 1, mode);
  for (const int side : {0, 2})
    set_column(particles, "stress", side, [&](const auto& x) { return 0.3 / 0.7 * mode(x); });
  return simulation;
}

double share_of_mode(const Simulation& simulation, const std::vector<double>& height) {
  const auto pressure = by_id(simulation.particles(), "pore_pressure");
  double share = 0;
  for (std::size_t p = 0; p < height.size(); ++p) share += pressure[p] * std::cos(wave_number * height[p]);
  return share;
}

struct Decay {
  double factor;  ///< of the rate, over the exact one
  double dt;      ///< [s]
};

/// From the 500th to the 2000th step: what is no slow mode has gone by then.
Decay decay(const SaturatedColumn& column) {
  const auto simulation = in_the_longest_mode(column);
  const auto height = heights(simulation->particles());
  take_steps(*simulation, 500);
  const double before = share_of_mode(*simulation, height), start = simulation->time();
  take_steps(*simulation, 1500);
  const double time = simulation->time() - start;
  const double rate = std::log(before / share_of_mode(*simulation, height)) / time;
  return {rate / (column.soil.consolidation_coefficient() * wave_number * wave_number), time / 1500};
}

constexpr const char* formulations[] = {"u-p", "v-w-p"};
constexpr const char* shapes[] = {"linear", "quadratic_bspline"};

// 1 % at k = 1e-5 m/s and nine tenths of the critical step, where the published coefficient makes the column
// consolidate 6.7 to 7.7 times too fast for beta = 0.9.
TEST(SpuriousPermeability, IsNoneWithIncrements) {
  for (const char* formulation : formulations)
    for (const char* shape : shapes)
      for (const double beta : {1.0, 0.9}) {
        const Decay found = decay(column(formulation, shape, beta));
        EXPECT_NEAR(found.factor, 1, 0.01) << formulation << ", " << shape << ", beta = " << beta;
        const double published = exact::spurious_consolidation_factor(sand(1e-5), beta, found.dt);
        EXPECT_TRUE(beta == 1 || published > 6) << published;
      }
}

// Without increments what is left is the difference of the assembled Laplacian and the product of divergence and
// gradient, (gamma_w dt / rho) (kappa h)^2 / 4 for linear functions: 5 %, met to a tenth of that. Quadratic ones, whose
// gradients come from points and not from the middle of the cell, have less.
TEST(SpuriousPermeability, WithoutIncrementsIsThatOfTheLaplacian) {
  for (const char* formulation : formulations) {
    const SaturatedColumn linear = column(formulation, "linear", 0);
    const Decay found = decay(linear);
    const double expected =
        exact::consistent_consolidation_factor(linear.soil, 0, found.dt, wave_number, linear.cell());
    EXPECT_NEAR(found.factor, expected, 0.1 * (expected - 1)) << formulation;
    const Decay smooth = decay(column(formulation, "quadratic_bspline", 0));
    EXPECT_GT(smooth.factor, 1) << formulation;
    EXPECT_LT(smooth.factor, expected) << formulation;
  }
}

// The control: the published scheme, whose drag does not act on the correction, run for this soil, cell and step, errs
// by the predicted factor of 61 to 1 %; the same scheme with consistent drag by that of the module.
TEST(SpuriousPermeability, OfThePublishedSchemeIsAsPredicted) {
  const SaturatedColumn here = column("v-w-p", "linear", 0);
  const double dt = decay(here).dt, h = here.cell();
  const double published = exact::measured_consolidation_factor(here.soil, 0, dt, wave_number, h, false, 10000);
  EXPECT_GT(published, 50);
  EXPECT_NEAR(published / exact::spurious_consolidation_factor(here.soil, 0, dt), 1, 0.01);
  const double consistent = exact::measured_consolidation_factor(here.soil, 0, dt, wave_number, h, true, 40000);
  EXPECT_NEAR(consistent, decay(here).factor, 3e-3);
}

// For the figure: over the permeability, the published scheme as predicted and as run, and the module.
TEST(SpuriousPermeability, OverPermeability) {
  if (figures_folder() == nullptr) GTEST_SKIP() << "draws a figure only: SLUICE_FIGURES";
  FigureTable table("spurious_permeability", "k_m_s,beta,published_predicted,published_run,module");
  for (const double k : {1e-3, 3e-4, 1e-4, 3e-5, 1e-5})
    for (const double beta : {0.0, 0.9, 1.0}) {
      const SaturatedColumn here = column("v-w-p", "linear", beta, k);
      const Decay found = decay(here);
      table.row(k, beta, exact::spurious_consolidation_factor(here.soil, beta, found.dt),
                exact::measured_consolidation_factor(here.soil, beta, found.dt, wave_number, here.cell(), false, 10000),
                found.factor);
    }
}

}  // namespace
}  // namespace sluice
