/// A short elastic bar that nothing holds, its particles put anywhere: the longest stable step, measured by running it,
/// and predicted by the eigenvalues of the step.
#pragma once

#include <map>
#include <optional>
#include <random>

#include "tests/verification/linear_bar.h"

namespace sluice {

/// Eight cells of 1 m, in a grid of twelve; one cell of 4 m across, so that nothing across is as fast as what is along;
/// E = 100 Pa and 1 kg/m3, so that h / c = 0.1 s.
struct FreeBar {
  static constexpr int first = 2, length = 8, cells = 12;
  static constexpr double modulus = 100, wave_step = 0.1;

  Scheme scheme;
  int per_axis = 2;           ///< particles in the width of a cell
  double offset = 0;          ///< of all particles, in cells
  std::optional<double> cut;  ///< the last column of particles stands so far inside the cell behind the bar
  int xpic_order = 2;

  double place(double on_lattice) const {
    const bool last = on_lattice > first + length - 0.75 / per_axis;
    return cut && last ? first + length + *cut : on_lattice + offset;
  }

  /// At rest, in steps of this Courant number.
  std::unique_ptr<Simulation> simulation(double courant) const {
    auto simulation = simulate(
        {.grid = fmt::format("{{min: [0 m, 0 m], max: [{} m, 4 m], cell: [1 m, 4 m]}}", cells),
         .material = "{model: linear_elastic, density: 1 kg/m3, youngs_modulus: 100 Pa, poisson_ratio: 0}",
         .bodies =
             fmt::format("  - {{material: soil, particles_per_cell: {}, box: {{min: [{} m, 0 m], max: [{} m, 4 m]}}}}",
                         per_axis * per_axis, first, first + length),
         .boundaries = "{bottom: roller, top: roller}",
         .scheme = scheme.with(fmt::format("time_step: {} s, xpic_order: {}", courant * wave_step, xpic_order))});
    set_column(simulation->particles(), "position", 0, [&](const auto& x) { return place(x[0]); });
    return simulation;
  }

  /// Whether small random velocities stay small over two thousand steps.
  bool is_stable(double courant) const {
    const auto simulation = this->simulation(courant);
    Particles& particles = simulation->particles();
    std::mt19937 generator(5);
    std::normal_distribution<double> normal(0, 1e-8);
    std::map<long, double> of_column;  // one velocity for all particles of the same x
    set_column(particles, "velocity", 0, [&](const auto& x) {
      return of_column.try_emplace(std::lround(1e6 * x[0]), normal(generator)).first->second;
    });
    const double start = kinetic_and_elastic_energy(*simulation);
    try {
      for (int i = 0; i < 40; ++i) {
        take_steps(*simulation, 50);
        if (kinetic_and_elastic_energy(*simulation) > 100 * start) return false;
      }
    } catch (const std::exception&) {
      return false;
    }
    return true;
  }

  /// Whether no eigenvalue is above one, by so much as would show in as many steps.
  bool is_stable_in_theory(double courant) const {
    Eigen::VectorXd places(length * per_axis);
    for (Eigen::Index p = 0; p < places.size(); ++p)
      places[p] = place(first + (static_cast<double>(p) + 0.5) / per_axis);
    const LinearBar bar(scheme, xpic_order, places, per_axis, cells, modulus, courant * wave_step);
    return bar.growth() < 1.001;
  }
};

/// The largest Courant number up to `high` that is stable, to 2 %; the smallest that is tried, `low`, if none is.
template <class Stable>
double stable_limit(const Stable& stable, double low, double high) {
  if (stable(high)) return high;
  while (high / low > 1.02) {
    const double middle = std::sqrt(low * high);
    (stable(middle) ? low : high) = middle;
  }
  return low;
}

/// Beyond the wave limit the program refuses to run.
constexpr double largest_courant = 0.999;

inline double measured_limit(const FreeBar& bar, double low = 0.02) {
  return stable_limit([&](double courant) { return bar.is_stable(courant); }, low, largest_courant);
}
inline double predicted_limit(const FreeBar& bar, double low = 0.02) {
  return stable_limit([&](double courant) { return bar.is_stable_in_theory(courant); }, low, largest_courant);
}

}  // namespace sluice
