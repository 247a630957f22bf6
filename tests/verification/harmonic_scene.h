/// A saturated column under a harmonic load, in steady oscillation, at a point of the plane of Pi1 (drainage) and Pi2
/// (inertia), in any formulation; amplitudes and phases of its particles, and how far they are from a closed form.
///
/// Amplitude and phase of every particle are its Fourier coefficient over a whole period, as a complex number over the
/// load. The load grows over some periods, and as many pass before it is taken, so that what is not harmonic has
/// decayed. Errors are root mean squares over the particles. The scheme is of first order in the step, most of it a lag
/// of the pressure by one step, omega dt. Cells and steps are therefore halved together and extrapolated.
#pragma once

#include <complex>
#include <map>
#include <numbers>

#include "physics/exact/harmonic_column.h"
#include "tests/verification/saturated_column.h"

namespace sluice::harmonic {

using Complex = std::complex<double>;
using exact::ColumnModel;

inline constexpr double load = 100;  // [Pa]: strains of 1e-5
inline constexpr double kappa = 0.9;

/// A point of the plane.
struct Point {
  double lg_pi_1, lg_pi_2;
  int growth;  ///< periods over which the load grows
  int cells = 20;
  double tolerance = 0.01;
};

inline void PrintTo(const Point& point, std::ostream* out) { *out << point.lg_pi_1 << ", " << point.lg_pi_2; }

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

/// Runs into steady oscillation and over one more period of `steps` steps; `pressure` gives the pore pressures by id.
template <class Pressure>
Amplitudes run(Simulation& simulation, const Oscillation& oscillation, int steps, const Pressure& pressure) {
  const SaturatedColumn& column = oscillation.column;
  const auto start = heights(simulation.particles());
  Amplitudes found;
  for (const double z : start) found.depth.push_back(1 - z / column.height);
  found.p.resize(start.size());
  found.u.resize(start.size());
  take_steps(simulation, oscillation.periods * steps);
  for (int i = 0; i < steps; ++i) {
    simulation.advance(1e6);
    const double phase = 2 * std::numbers::pi * simulation.time() / oscillation.period;
    const Complex turn = std::polar(2.0 / steps, -phase);
    const std::vector<double> now = pressure(simulation.particles());
    const auto height = heights(simulation.particles());
    for (std::size_t p = 0; p < start.size(); ++p) {
      found.p[p] += turn * now[p] / load;
      found.u[p] += turn * (start[p] - height[p]) * column.soil.modulus / (load * column.height);
    }
  }
  return found;
}

inline Amplitudes run(const Oscillation& oscillation) {
  const auto simulation = simulate(oscillation.column);
  return run(*simulation, oscillation, oscillation.steps,
             [](const Particles& particles) { return by_id(particles, "pore_pressure"); });
}

/// Without what is of first order as cells and steps go to zero together: twice the finer less the coarser. A particle
/// of the coarser stands in the middle of four of the finer.
inline Amplitudes extrapolated(const Amplitudes& coarse, const Amplitudes& fine) {
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

inline Amplitudes closed_form(ColumnModel model, const exact::HarmonicGroups& groups,
                              const std::vector<double>& depth) {
  const exact::HarmonicColumn column(model, groups);
  Amplitudes exact{.depth = depth, .p = {}, .u = {}};
  for (const double z : depth) {
    const auto state = column.at(z);
    exact.p.push_back(state.p);
    exact.u.push_back(state.u);
  }
  return exact;
}

inline std::vector<Complex> difference(std::vector<Complex> a, const std::vector<Complex>& b) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] -= b[i];
  return a;
}

inline double rms(const std::vector<Complex>& a) {
  double sum = 0;
  for (const Complex& x : a) sum += std::norm(x);
  return std::sqrt(sum / static_cast<double>(a.size()));
}

/// Normalised as exact::model_error is.
inline exact::ModelError error(const Amplitudes& found, const Amplitudes& exact) {
  return {rms(difference(found.u, exact.u)) / rms(exact.u),
          rms(difference(found.p, exact.p)) / std::max(rms(exact.p), 0.1)};
}

}  // namespace sluice::harmonic
