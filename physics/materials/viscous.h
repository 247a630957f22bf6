/// Viscous stress of a chunk, which liquids share.
#pragma once

#include "physics/materials/chunk.h"

namespace sluice {

/// `stress[k][lane]` becomes 2 mu dev(d eps) / dt (W.1); zero where dt is, before the first step.
template <int Dim, int States>
SLUICE_ALWAYS_INLINE void viscous_stress(const Chunk<Dim, States>& chunk, double viscosity, double dt,
                                         double (&stress)[symmetric_components<Dim>][chunk_lanes]) {
  const double factor = dt > 0 ? 2 * viscosity / dt : 0;
  const auto& e = chunk.strain_increment;
  SLUICE_LANE_LOOP
  for (int i = 0; i < chunk_lanes; ++i) {
    const double mean = (e[0][i] + e[1][i] + e[2][i]) / 3;
    for (int k = 0; k < 3; ++k) stress[k][i] = factor * (e[k][i] - mean);
    for (int k = 3; k < symmetric_components<Dim>; ++k) stress[k][i] = factor * e[k][i];
  }
}

/// The pressure of a weakly compressible liquid: the mean stress of the chunk and K tr(d eps), at most `cutoff` (NF.1).
template <int Dim, int States>
SLUICE_ALWAYS_INLINE void compress(const Chunk<Dim, States>& chunk, double bulk_modulus, double cutoff,
                                   double (&mean)[chunk_lanes]) {
  const auto& e = chunk.strain_increment;
  const auto& s = chunk.stress;
  SLUICE_LANE_LOOP
  for (int i = 0; i < chunk_lanes; ++i) {
    const double volume = e[0][i] + e[1][i] + e[2][i];
    const double trial = (s[0][i] + s[1][i] + s[2][i]) / 3 + bulk_modulus * volume;
    mean[i] = trial < cutoff ? trial : cutoff;
  }
}

/// Adds `mean` to the normal components.
template <int Dim>
SLUICE_ALWAYS_INLINE void add_mean(const double (&mean)[chunk_lanes],
                                   double (&stress)[symmetric_components<Dim>][chunk_lanes]) {
  for (int k = 0; k < 3; ++k) {
    SLUICE_LANE_LOOP
    for (int i = 0; i < chunk_lanes; ++i) stress[k][i] += mean[i];
  }
}

}  // namespace sluice
