/// SkeletonLoads: what acts on the skeleton beside gravity.
#pragma once

#include <array>

namespace sluice {

/// Columns of all particles, null where there is nothing.
template <int Dim>
struct SkeletonLoads {
  const double* pressure = nullptr;                ///< pushes its surroundings apart, like pore water [Pa]
  std::array<const double*, Dim> body_force = {};  ///< [N]
  /// The part q of the pressure that stands at obstacles as well, and its gradient: docs/theory.md, eq. (49a).
  const double* on_obstacles = nullptr;       ///< [Pa]
  std::array<const double*, Dim> slope = {};  ///< [Pa/m]
};

}  // namespace sluice
