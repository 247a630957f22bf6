/// CellCoefficients: what a cell gives to the equations of its corners, from the sums over its particles.
/// docs/theory.md, eqs. (44) and (47).
#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/grid/geometry.h"
#include "physics/two_phase/cell_sums.h"

namespace sluice {

/// What the coefficients of all cells have in common in a step.
template <int Dim>
struct StepCoefficients {
  double density;    ///< rho_w [kg/m3]
  double increment;  ///< 1: the old pressure has driven the prediction; 0: it has not
  double kick;       ///< time over which the pressure accelerates [s]
  double corner_volume_per_dt;
  double steadied;                       ///< 3/2 of the volume of a corner, or 0 without stabilisation
  std::array<double, Dim> stabilised{};  ///< h^2 / (4 dt), or 0 without stabilisation
  std::array<double, Dim> softest{};     ///< (50 dt / h)^2
};

/// Columns by cell; a cell without water has zeros. Those by axis multiply integrals over the cell, CornerIntegrals.
template <int Dim>
class CellCoefficients {
 public:
  std::array<std::vector<double>, Dim> implicit, old;  ///< of the Laplacian of the new and of the old pressure
  std::array<std::vector<double>, Dim> push;           ///< what drives water but the pressure [m/s]
  std::vector<double> storage;                         ///< of each corner
  std::vector<double>
      steadied;  ///< of each corner, per unevenness: 3/2 kick / rho where there is a skeleton, eq. (47a)

  void resize(std::size_t cells);
  /// For the cells from `first` on, as many as there are sums. Cells may be set in parallel.
  void set(std::size_t first, std::span<const CellSums<Dim>> sums, const StepCoefficients<Dim>& step);
};

extern template class CellCoefficients<2>;
extern template class CellCoefficients<3>;

}  // namespace sluice
