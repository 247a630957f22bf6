/// SkeletonLoads: what acts on the skeleton beside gravity.
#pragma once

#include <array>

namespace sluice {

/// Columns of all particles, null where there is nothing.
template <int Dim>
struct SkeletonLoads {
  const double* pressure = nullptr;                ///< pushes its surroundings apart, like pore water [Pa]
  std::array<const double*, Dim> body_force = {};  ///< [N]
};

}  // namespace sluice
