/// A short elastic bar that nothing holds, its particles put anywhere: the longest stable step, measured by running it,
/// and predicted by the eigenvalues of the step.
#pragma once

#include <map>
#include <optional>
#include <random>

#include "tests/stability/unguarded_run.h"
#include "tests/verification/linear_bar.h"

namespace sluice {

/// Eight cells of 1 m, in a grid of twelve; one cell of 4 m across, so that nothing across is as fast as what is along.
/// E = 100 Pa and 1 kg/m3, so that h / c = 0.1 s.
struct FreeBar {
  static constexpr int first = 2, length = 8, cells = 12;
  static constexpr double modulus = 100, wave_step = 0.1;

  Scheme scheme;
  int per_axis = 2;           ///< particles in the width of a cell
  double offset = 0;          ///< of all particles, in cells
  std::optional<double> cut;  ///< the last column of particles stands so far inside the cell behind the bar

  double place(double on_lattice) const {
    const bool last = on_lattice > first + length - 0.75 / per_axis;
    return cut && last ? first + length + *cut : on_lattice + offset;
  }

  SceneText scene() const {
    return {.grid = fmt::format("{{min: [0 m, 0 m], max: [{} m, 4 m], cell: [1 m, 4 m]}}", cells),
            .material = "{model: linear_elastic, density: 1 kg/m3, youngs_modulus: 100 Pa, poisson_ratio: 0}",
            .bodies = fmt::format(
                "  - {{material: soil, particles_per_cell: {}, box: {{min: [{} m, 0 m], max: [{} m, 4 m]}}}}",
                per_axis * per_axis, first, first + length),
            .boundaries = "{bottom: roller, top: roller}",
            .scheme = scheme};
  }

  bool is_stable(double courant) const {
    constexpr double start = 1e-8;
    UnguardedRun run(scene());
    std::mt19937 generator(5);
    std::normal_distribution<double> normal(0, start);
    std::map<long, double> of_column;  // one velocity for all particles of the same x
    set_column(run.particles(), "velocity", 0, [&](const auto& x) {
      return of_column.try_emplace(std::lround(1e6 * x[0]), normal(generator)).first->second;
    });
    set_column(run.particles(), "position", 0, [&](const auto& x) { return place(x[0]); });
    return stays_small(run, courant * wave_step, start);
  }

  /// Whether no eigenvalue is above one, by so much as would show in as many steps.
  bool is_stable_in_theory(double courant) const {
    Eigen::VectorXd places(length * per_axis);
    for (Eigen::Index p = 0; p < places.size(); ++p)
      places[p] = place(first + (static_cast<double>(p) + 0.5) / per_axis);
    const LinearBar bar(scheme, 2, places, per_axis, cells, modulus, courant * wave_step);
    return bar.growth() < 1.002;
  }
};

inline double measured_limit(const FreeBar& bar, double low = 0.02) {
  return stable_limit([&](double courant) { return bar.is_stable(courant); }, low, 2);
}
inline double predicted_limit(const FreeBar& bar, double low = 0.02) {
  return stable_limit([&](double courant) { return bar.is_stable_in_theory(courant); }, low, 2);
}

}  // namespace sluice
