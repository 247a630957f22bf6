/// Consolidation under a step load. Sources: Terzaghi (1923), and the telegraph column where inertia counts
/// (physics/exact). Errors are root mean squares over all particles, as shares of the load; strains are
/// below 1e-4, so that the exact solutions at small strain hold.
#include "physics/exact/telegraph_column.h"
#include "physics/exact/terzaghi.h"
#include "tests/verification/saturated_column.h"

namespace sluice {
namespace {

constexpr double load = 1000;  // [Pa]

/// Saturated before the load comes, so that the water carries all of it at first.
SaturatedColumn loaded(double conductivity, const std::string& formulation, const std::string& shape, int cells = 40) {
  SaturatedColumn column;
  column.soil = sand(conductivity);
  column.cells = cells;
  column.load = "1 kPa";
  column.initial = "{method: uniform, pressure: 1 kPa}";
  column.formulation = formulation;
  column.scheme.shape = shape;
  return column;
}

SaturatedColumn with_courant(SaturatedColumn column, double courant) {
  column.scheme = column.scheme.with(fmt::format("courant: {}", courant));
  return column;
}

exact::TelegraphColumn telegraph(const SaturatedColumn& column) {
  return {column.soil, column.height, load,
          column.formulation == "u-p" ? exact::WaterInertia::of_grains : exact::WaterInertia::own};
}

/// The largest error against Terzaghi at the time factors.
double consolidation_error(const SaturatedColumn& column, const std::vector<double>& time_factors) {
  const exact::ConsolidatingLayer layer{.soil = column.soil, .height = column.height, .load = load};
  const auto simulation = simulate(column);
  const auto height = heights(simulation->particles());
  double largest = 0;
  for (const double T : time_factors) {
    const double t = T * column.height * column.height / column.soil.consolidation_coefficient();
    simulation->advance_to(t);
    const auto pressure = [&](double z) { return layer.pressure(z, t); };
    largest = std::max(largest, pressure_error(simulation->particles(), height, pressure) / load);
  }
  return largest;
}

/// The largest error against the telegraph column at the times [s].
double inertial_error(const SaturatedColumn& column, const std::vector<double>& times) {
  const exact::TelegraphColumn solution = telegraph(column);
  const auto simulation = simulate(column);
  const auto height = heights(simulation->particles());
  double largest = 0;
  for (const double t : times) {
    simulation->advance_to(t);
    const auto pressure = [&](double z) { return solution.at(z, t).pressure; };
    largest = std::max(largest, pressure_error(simulation->particles(), height, pressure) / load);
  }
  return largest;
}

constexpr const char* formulations[] = {"u-p", "v-w-p"};
constexpr const char* shapes[] = {"linear", "quadratic_bspline"};

// 1 % at 40 cells from T = 0.01 to 1, whatever the step. At k = 1e-3 m/s inertia is still there (M rho k^2 /
// (gamma_w H)^2 = 3e-4): 0.4 % of the error at T = 0.01, next to nothing from T = 0.1 on.
TEST(Consolidation, FollowsTerzaghi) {
  for (const char* formulation : formulations)
    for (const char* shape : shapes)
      for (const double courant : {0.3, 0.9}) {
        SCOPED_TRACE(fmt::format("{}, {}, Courant {}", formulation, shape, courant));
        SaturatedColumn column = with_courant(loaded(1e-3, formulation, shape), courant);
        EXPECT_LT(consolidation_error(column, {0.01, 0.05, 0.1, 0.3, 1}), 0.01);
        column.dimension = 3;
        EXPECT_LT(consolidation_error(column, {0.01, 0.05}), 0.01) << "3-D";
      }
}

// Second order in the cell in the smooth field, first at the drained end in the first moments: between the two at T =
// 0.05. The step shrinks with the cell.
TEST(Consolidation, ConvergesToTerzaghi) {
  for (const char* formulation : formulations)
    for (const char* shape : shapes) {
      std::vector<double> errors;
      for (const int cells : {10, 20, 40}) {
        const SaturatedColumn column = with_courant(loaded(2e-4, formulation, shape, cells), 0.9);
        errors.push_back(consolidation_error(column, {0.05}));
      }
      SCOPED_TRACE(fmt::format("{}, {}: {:.2e} {:.2e} {:.2e}", formulation, shape, errors[0], errors[1], errors[2]));
      EXPECT_GT(std::log2(errors[0] / errors[2]) / 2, 1.2);
    }
}

// The step is that of the wave in the skeleton, to the last digit the same for every permeability; and the pressure
// holds within 1 % of the load below the four topmost cells. There, for low k, the exact layer is thinner than a cell,
// and the sudden load leaves ripples that have no time to drain: 1.7 % in the third cell, more above.
TEST(Consolidation, PermeabilityDoesNotLimitTheStep) {
  for (const char* formulation : formulations)
    for (const char* shape : shapes) {
      double first_step = 0;
      for (const double k : {1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8}) {
        SCOPED_TRACE(fmt::format("{}, {}, k = {}", formulation, shape, k));
        const SaturatedColumn column = loaded(k, formulation, shape);
        const auto simulation = simulate(column);
        const auto height = heights(simulation->particles());
        StepInfo info;
        for (int i = 0; i < 500; ++i) {
          info = simulation->advance(1e6);
          ASSERT_EQ(info.limiter, "wave");
        }
        if (first_step == 0) first_step = info.dt;
        EXPECT_NEAR(info.dt / first_step, 1, 1e-3);
        const exact::TelegraphColumn solution = telegraph(column);
        const auto pressure = by_id(simulation->particles(), "pore_pressure");
        for (std::size_t p = 0; p < pressure.size(); ++p)
          if (height[p] < column.height - 4 * column.cell()) {
            const double exact = solution.at(height[p], simulation->time()).pressure;
            ASSERT_NEAR(pressure[p] / load, exact / load, 0.01) << height[p];
          }
      }
    }
}

// Fronts that run up and down the column, with inertia: each formulation against its own exact solution, which differ.
TEST(Consolidation, FollowsTheTelegraphColumn) {
  for (const char* formulation : formulations)
    for (const char* shape : shapes)
      for (const double courant : {0.2, 0.8}) {
        SCOPED_TRACE(fmt::format("{}, {}, Courant {}", formulation, shape, courant));
        EXPECT_LT(inertial_error(with_courant(loaded(1e-3, formulation, shape, 80), courant), {0.02, 0.05}), 3e-3);
      }
}

// First order, that of the steps, which shrink with the cells: symplectic in the skeleton, implicit in drag.
TEST(Consolidation, ConvergesToTheTelegraphColumn) {
  for (const char* formulation : formulations)
    for (const char* shape : shapes) {
      std::vector<double> errors;
      for (const int cells : {20, 40, 80})
        errors.push_back(inertial_error(with_courant(loaded(1e-3, formulation, shape, cells), 0.4), {0.02}));
      SCOPED_TRACE(fmt::format("{}, {}: {:.2e} {:.2e} {:.2e}", formulation, shape, errors[0], errors[1], errors[2]));
      EXPECT_GT(std::log2(errors[0] / errors[2]) / 2, 0.9);
    }
}

// The control: at k = 1e-2 m/s the two exact solutions are 3 % apart, and neither formulation passes for the other.
TEST(Consolidation, FormulationsDifferAsTheirSolutionsDo) {
  SaturatedColumn u_p = loaded(1e-2, "u-p", "quadratic_bspline", 80),
                  v_w_p = loaded(1e-2, "v-w-p", "quadratic_bspline", 80);
  const double own = std::max(inertial_error(u_p, {0.02}), inertial_error(v_w_p, {0.02}));
  EXPECT_LT(own, 0.01);
  const auto height = heights(simulate(u_p)->particles());
  const auto simulation = simulate(u_p);
  simulation->advance_to(0.02);
  const exact::TelegraphColumn other = telegraph(v_w_p);
  EXPECT_GT(pressure_error(simulation->particles(), height, [&](double z) { return other.at(z, 0.02).pressure; }),
            2 * own * load);
}

}  // namespace
}  // namespace sluice
