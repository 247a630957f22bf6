/// A saturated column under a harmonic load, in steady oscillation: v-w-p follows Biot's closed form, u-p its own, and
/// what u-p gets wrong is what its closed form gets wrong, over the plane of Pi1 (drainage) and Pi2 (inertia). Source:
/// Zienkiewicz, Chang & Bettess (1980); docs/exact_solutions.md, section 4.
///
/// Amplitude and phase of every particle are its Fourier coefficient over a whole period, as a complex number over the
/// load. The load grows over some periods, and as many pass before it is taken, so that what is not harmonic has
/// decayed. Errors are root mean squares over the particles. The scheme is of first order in the step, most of it a lag
/// of the pressure by one step, omega dt. Cells and steps are therefore halved together and extrapolated; one test
/// shows the order.
#include <complex>
#include <map>
#include <numbers>

#include "physics/exact/harmonic_column.h"
#include "tests/verification/saturated_column.h"

namespace sluice {
namespace {

using Complex = std::complex<double>;
using exact::ColumnModel;

constexpr double load = 100;  // [Pa]: strains of 1e-5
constexpr double kappa = 0.9;

/// A point of the plane.
struct Point {
  double lg_pi_1, lg_pi_2;
  int growth;  ///< periods over which the load grows
  int cells = 20;
  double tolerance = 0.01;
};

/// A column whose groups are those of the point: modulus and height stay; period, permeability and water follow.
struct Oscillation {
  SaturatedColumn column;
  exact::HarmonicGroups groups;
  double period = 0;  ///< [s]
  int steps = 0;      ///< in a period
  int periods = 0;    ///< before the one that is looked at

  Oscillation(const Point& point, const std::string& formulation, int cells) {
    exact::SaturatedSoil& soil = column.soil;
    groups = exact::zienkiewicz_groups(std::pow(10, point.lg_pi_1), std::pow(10, point.lg_pi_2), kappa,
                                       soil.water_density / soil.density(), soil.porosity);
    column.height = 0.25;  // small, for a permeability at which u-p is not refused
    column.cells = cells;
    column.formulation = formulation;
    const double crossing = column.height / std::sqrt(soil.modulus / soil.density());
    period = 2 * std::numbers::pi * crossing / std::sqrt(groups.inertia);
    soil.conductivity = soil.water_unit_weight() * 2 * std::numbers::pi / period * column.height * column.height /
                        (groups.drag * soil.modulus);
    soil.water_bulk_modulus = soil.porosity * soil.modulus / groups.compliance;
    const double wave = column.cell() * std::sqrt((1 - soil.porosity) * soil.solid_density / soil.modulus);
    steps = static_cast<int>(std::ceil(period / (0.5 * wave)));  // half of the limit, as by default
    column.scheme = column.scheme.with(fmt::format("time_step: {} s", period / steps));
    periods = 2 * point.growth - 1;
    write_load(point.growth);
  }

  /// Straight lines between 200 points in a period, whose harmonic is 1e-4 too small.
  void write_load(int growth) {
    constexpr int corners = 200;
    for (int i = 0; i <= (periods + 1) * corners; ++i) {
      const double cycles = static_cast<double>(i) / corners, s = std::min(1.0, cycles / growth);
      column.load += fmt::format("{}[{} s, {} Pa]", i == 0 ? "[" : ", ", cycles * period,
                                 load * s * s * (3 - 2 * s) * std::cos(2 * std::numbers::pi * cycles));
    }
    column.load += "]";
  }
};

/// Complex amplitudes by particle: of the pressure over the load, and of the settlement over load * height / modulus.
struct Amplitudes {
  std::vector<double> depth;  ///< over the height
  std::vector<Complex> p, u;
};

Amplitudes run(const Oscillation& oscillation) {
  const SaturatedColumn& column = oscillation.column;
  const auto simulation = simulate(column);
  const auto start = heights(simulation->particles());
  Amplitudes found;
  for (const double z : start) found.depth.push_back(1 - z / column.height);
  found.p.resize(start.size());
  found.u.resize(start.size());
  take_steps(*simulation, oscillation.periods * oscillation.steps);
  for (int i = 0; i < oscillation.steps; ++i) {
    simulation->advance(1e6);
    const double phase = 2 * std::numbers::pi * simulation->time() / oscillation.period;
    const Complex turn = std::polar(2.0 / oscillation.steps, -phase);
    const auto pressure = by_id(simulation->particles(), "pore_pressure");
    const auto height = heights(simulation->particles());
    for (std::size_t p = 0; p < start.size(); ++p) {
      found.p[p] += turn * pressure[p] / load;
      found.u[p] += turn * (start[p] - height[p]) * column.soil.modulus / (load * column.height);
    }
  }
  return found;
}

/// Without what is of first order as cells and steps go to zero together: twice the finer less the coarser. A particle
/// of the coarser stands in the middle of four of the finer.
Amplitudes extrapolated(const Amplitudes& coarse, const Amplitudes& fine) {
  const double rows = static_cast<double>(coarse.depth.size()) / 2;
  const auto row = [&](double depth) { return static_cast<int>(depth * rows); };
  std::map<int, std::pair<Complex, Complex>> means;
  for (std::size_t i = 0; i < fine.depth.size(); ++i) {
    means[row(fine.depth[i])].first += fine.p[i] / 4.0;
    means[row(fine.depth[i])].second += fine.u[i] / 4.0;
  }
  Amplitudes limit = coarse;
  for (std::size_t i = 0; i < coarse.depth.size(); ++i) {
    const auto& [p, u] = means.at(row(coarse.depth[i]));
    limit.p[i] = 2.0 * p - coarse.p[i];
    limit.u[i] = 2.0 * u - coarse.u[i];
  }
  return limit;
}

Amplitudes closed_form(const std::string& formulation, const exact::HarmonicGroups& groups,
                       const std::vector<double>& depth) {
  const exact::HarmonicColumn column(formulation == "u-p" ? ColumnModel::u_p : ColumnModel::full, groups);
  Amplitudes exact{.depth = depth, .p = {}, .u = {}};
  for (const double z : depth) {
    const auto state = column.at(z);
    exact.p.push_back(state.p);
    exact.u.push_back(state.u);
  }
  return exact;
}

std::vector<Complex> difference(std::vector<Complex> a, const std::vector<Complex>& b) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] -= b[i];
  return a;
}

double rms(const std::vector<Complex>& a) {
  double sum = 0;
  for (const Complex& x : a) sum += std::norm(x);
  return std::sqrt(sum / static_cast<double>(a.size()));
}

/// Normalised as exact::model_error is.
exact::ModelError error(const Amplitudes& found, const Amplitudes& exact) {
  return {rms(difference(found.u, exact.u)) / rms(exact.u),
          rms(difference(found.p, exact.p)) / std::max(rms(exact.p), 0.1)};
}

/// How much of the deviation `predicted` is in `found`: 1 where it is as large and in phase.
Complex share(const std::vector<Complex>& found, const std::vector<Complex>& predicted) {
  Complex product = 0;
  double square = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    product += std::conj(predicted[i]) * found[i];
    square += std::norm(predicted[i]);
  }
  return product / square;
}

/// Slow: u-p is as good as Biot's equations. Moderate: it is 5 % off. Then fast ones in undrained and in half-drained
/// soil, and drained soil that is not slow for water. At the point with the shortest waves, 0.6 of the height, cells
/// are half as large, and what is left of second order is still twice as much.
const Point slow{0, -2, 2}, moderate{-0.5, -0.5, 5};
const Point fast[] = {{-1, 0, 8}, {0, 0, 6}, {0.5, 0, 5}, {-1, 1, 8, 40, 0.02}, {1, -2, 2}, {2, -2, 2}};

/// Both formulations at a point against their closed forms: within the tolerance of the point, 1 % of the root mean
/// square of pressure or settlement. Deviations from Biot are returned: of both, and what is predicted for u-p.
struct Deviations {
  exact::ModelError predicted, u_p, v_w_p;
  Complex pressure, settlement;  ///< shares of the prediction in u-p
  Complex pressure_v_w_p;        ///< and in v-w-p
};

Deviations deviations(const Point& point) {
  std::map<std::string, Amplitudes> found;
  Amplitudes biot, predicted;
  for (const std::string formulation : {"u-p", "v-w-p"}) {
    const Oscillation coarse(point, formulation, point.cells), fine(point, formulation, 2 * point.cells);
    const Amplitudes limit = extrapolated(run(coarse), run(fine));
    biot = closed_form("v-w-p", coarse.groups, limit.depth);
    predicted = closed_form("u-p", coarse.groups, limit.depth);
    const exact::ModelError own = error(limit, formulation == "u-p" ? predicted : biot);
    EXPECT_LT(own.pressure, point.tolerance) << formulation;
    EXPECT_LT(own.displacement, point.tolerance) << formulation;
    found[formulation] = limit;
  }
  const auto in_pressure = difference(predicted.p, biot.p);
  return {error(predicted, biot),
          error(found["u-p"], biot),
          error(found["v-w-p"], biot),
          share(difference(found["u-p"].p, biot.p), in_pressure),
          share(difference(found["u-p"].u, biot.u), difference(predicted.u, biot.u)),
          share(difference(found["v-w-p"].p, biot.p), in_pressure)};
}

// Where inertia is small both are Biot's column, within the 1 % of the discretisation.
TEST(HarmonicColumn, SlowNeedsNoInertiaOfTheWater) {
  const Deviations found = deviations(slow);
  EXPECT_LT(found.predicted.pressure, 0.006);
  EXPECT_LT(found.u_p.pressure, 0.01);
  EXPECT_LT(found.v_w_p.pressure, 0.01);
}

// From 5 % to twice the pressure itself. The prediction is met to a tenth in size and phase: errors of the
// discretisation, up to 0.5 % where the error of the model is 6 %, are that large beside it. v-w-p has none of it.
TEST(HarmonicColumn, UpHasTheErrorThatItsClosedFormPredicts) {
  std::vector<Point> points(std::begin(fast), std::end(fast));
  points.push_back(moderate);
  for (const Point& point : points) {
    SCOPED_TRACE(fmt::format("lg Pi1 = {}, lg Pi2 = {}", point.lg_pi_1, point.lg_pi_2));
    const Deviations found = deviations(point);
    EXPECT_GT(found.predicted.pressure, 0.05);
    EXPECT_LT(std::abs(found.pressure - 1.0), 0.1) << found.pressure;
    EXPECT_LT(std::abs(found.settlement - 1.0), 0.1) << found.settlement;
    EXPECT_LT(std::abs(found.pressure_v_w_p), 0.1) << found.pressure_v_w_p;
  }
}

// First order in cells and steps together, without extrapolation; and neither passes for the other.
TEST(HarmonicColumn, ConvergesToItsClosedForm) {
  const Point point{0, 0, 6};
  for (const std::string formulation : {"u-p", "v-w-p"}) {
    const std::string other = formulation == "u-p" ? "v-w-p" : "u-p";
    std::vector<double> own, wrong;
    for (const int cells : {10, 20, 40}) {
      const Oscillation oscillation(point, formulation, cells);
      const Amplitudes found = run(oscillation);
      own.push_back(error(found, closed_form(formulation, oscillation.groups, found.depth)).pressure);
      wrong.push_back(error(found, closed_form(other, oscillation.groups, found.depth)).pressure);
    }
    SCOPED_TRACE(fmt::format("{}: {:.3f} {:.3f} {:.3f}", formulation, own[0], own[1], own[2]));
    EXPECT_GT(std::log2(own[0] / own[2]) / 2, 0.9);
    EXPECT_LT(own[2], 0.06);
    EXPECT_GT(wrong[2], 0.25) << "the control";
  }
}

}  // namespace
}  // namespace sluice
