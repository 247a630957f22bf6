/// Drag between water and grains: it may be stiffer than anything else by ten orders of magnitude and sets no step.
/// Source: relaxation of two masses, exp(-D t / mu), with the momentum of both kept (EX.2).
#include "tests/verification/saturated_column.h"

namespace sluice {
namespace {

constexpr double start = 1e-4;  // relative velocity [m/s]

/// Nothing holds the column, and its ends are open: water passes through it at one speed, without pressure.
SaturatedColumn floating(const std::string& formulation, double conductivity) {
  SaturatedColumn column;
  column.soil = sand(conductivity);
  column.cells = 20;
  column.base = 2;
  column.formulation = formulation;
  if (formulation == "explicit") column.soil.water_bulk_modulus = 2.2e9;
  return column;
}

std::unique_ptr<Simulation> flowing(const SaturatedColumn& column) {
  auto simulation = simulate(column);
  set_column(simulation->particles(), "relative_velocity", 1, [](const auto&) { return start; });
  return simulation;
}

double relative_speed(const Simulation& simulation) {
  return largest_magnitude(by_id(simulation.particles(), "relative_velocity", 1));
}

constexpr const char* formulations[] = {"v-w-p", "explicit"};

// At nine tenths of the critical step, from drag that hardly acts to 10^11 of it in a step. A thousandth of the start
// is room for what round-off and the open ends stir.
TEST(Drag, RelativeMotionDiesMonotonically) {
  for (const char* formulation : formulations)
    for (const double k : {1.0, 1e-1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-9, 1e-12}) {
      SCOPED_TRACE(fmt::format("{}, k = {}", formulation, k));
      SaturatedColumn column = floating(formulation, k);
      column.scheme = column.scheme.with("courant: 0.9");
      const auto simulation = flowing(column);
      double last = start;
      for (int i = 0; i < 1000; ++i) {
        const StepInfo step = simulation->advance(1e6);
        ASSERT_TRUE(i > 0 || step.limiter == (formulation[0] == 'v' ? "wave" : "sound")) << step.limiter;
        ASSERT_LE(relative_speed(*simulation), last + 1e-3 * start) << i;
        last = relative_speed(*simulation);
      }
      // The water's share of the momentum goes to both.
      EXPECT_LE(simulation->largest_speed(), 1.01 * start);
    }
}

// The rate: first order in the step, exactly that of the implicit Euler rule, 1 / (1 + rate dt) a step, the first of
// which is a half one.
TEST(Drag, RateIsThatOfTheSolution) {
  for (const char* formulation : formulations) {
    std::vector<double> errors;
    const double time = 1 / sand(1e-3).drag_rate();
    for (const int steps : {20, 40}) {
      SaturatedColumn column = floating(formulation, 1e-3);
      if (formulation[0] == 'e') column.soil.water_bulk_modulus = 2.2e7;  // room for steps of this length
      const double dt = time / steps;
      column.scheme = column.scheme.with(fmt::format("time_step: {} s", dt));
      const auto simulation = flowing(column);
      take_steps(*simulation, steps);
      const double found = relative_speed(*simulation) / start, rate = column.soil.drag_rate() * dt;
      EXPECT_NEAR(found, 1 / (1 + 0.5 * rate) / std::pow(1 + rate, steps - 1), 1e-3) << formulation;
      errors.push_back(found - std::exp(-rate * (steps - 0.5)));  // velocities live half a step earlier
      EXPECT_LT(std::abs(errors.back()), rate) << formulation;
    }
    EXPECT_NEAR(errors[0] / errors[1], 2, 0.3) << formulation;
  }
}

// The acceleration in Darcy's law of u-p holds the old pressure; explicitly that would grow in coarse soil with rho < 2
// rho_w and short steps. The load is 1 kPa, and the exact pressure never exceeds 2 rho / (rho - rho_w) of it by far.
TEST(Drag, LightCoarseSoilStaysBounded) {
  SaturatedColumn column;
  column.soil = sand(0.1);
  column.soil.porosity = 0.5;
  column.cells = 20;
  column.load = "1 kPa";
  column.scheme = column.scheme.with("courant: 0.02");
  const auto simulation = simulate(column);
  double largest = 0;
  for (int i = 0; i < 3000; ++i) {
    simulation->advance(1e6);
    largest = std::max(largest, largest_magnitude(by_id(simulation->particles(), "pore_pressure")));
  }
  EXPECT_LT(largest, 2500);
}

/// Coarser still, u-p is neither valid nor stable in the steps that the skeleton allows: it says so.
TEST(Drag, SoilTooCoarseForUPIsRefused) {
  SaturatedColumn column;
  column.soil = sand(1.0);
  EXPECT_THROW(simulate(column), CaseError);
}

}  // namespace
}  // namespace sluice
