/// Mean and deviator of the stress of a chunk, which the models with a surface of revolution share.
#pragma once

#include <cmath>

#include "physics/materials/chunk.h"

namespace sluice {

/// Takes the mean out of the normal components of `stress`, and gives it and the root of J2 = s:s / 2 [Pa].
template <int Dim>
SLUICE_ALWAYS_INLINE void split(double (&stress)[symmetric_components<Dim>][chunk_lanes], double (&mean)[chunk_lanes],
                                double (&root_j2)[chunk_lanes]) {
  SLUICE_LANE_LOOP
  for (int i = 0; i < chunk_lanes; ++i) {
    const double third = (stress[0][i] + stress[1][i] + stress[2][i]) * (1.0 / 3);
    double half = 0, shear = 0;
    for (int k = 0; k < 3; ++k) {
      stress[k][i] -= third;
      half += stress[k][i] * stress[k][i];
    }
    for (int k = 3; k < symmetric_components<Dim>; ++k) shear += stress[k][i] * stress[k][i];
    mean[i] = third;
    root_j2[i] = std::sqrt(0.5 * half + shear);
  }
}

/// `deviator` becomes the stress: `scale` times the deviator plus `mean`.
template <int Dim>
SLUICE_ALWAYS_INLINE void join(double (&deviator)[symmetric_components<Dim>][chunk_lanes],
                               const double (&scale)[chunk_lanes], const double (&mean)[chunk_lanes]) {
  SLUICE_LANE_LOOP
  for (int i = 0; i < chunk_lanes; ++i) {
    for (int k = 0; k < 3; ++k) deviator[k][i] = scale[i] * deviator[k][i] + mean[i];
    for (int k = 3; k < symmetric_components<Dim>; ++k) deviator[k][i] *= scale[i];
  }
}

}  // namespace sluice
