/// The elastic step of a chunk, which linear elasticity and the elastic predictor of plasticity share.
#pragma once

#include "physics/materials/chunk.h"

namespace sluice {

/// `stress[k][lane]` becomes sigma + lambda tr(d eps) 1 + 2 G d eps (LE.1) of the chunk's stress and strain increment.
template <int Dim, int States>
SLUICE_ALWAYS_INLINE void elastic_trial(const Chunk<Dim, States>& chunk, IsotropicElasticity elasticity,
                                        double (&stress)[symmetric_components<Dim>][chunk_lanes]) {
  const double lambda = elasticity.lambda, twice_shear = 2 * elasticity.shear;
  const double* const exx = chunk.strain_increment[0];
  const double* const eyy = chunk.strain_increment[1];
  const double* const ezz = chunk.strain_increment[2];
#pragma GCC ivdep
  for (int i = 0; i < chunk_lanes; ++i) {
    const double spherical = lambda * (exx[i] + eyy[i] + ezz[i]);
    stress[0][i] = chunk.stress[0][i] + spherical + twice_shear * exx[i];
    stress[1][i] = chunk.stress[1][i] + spherical + twice_shear * eyy[i];
    stress[2][i] = chunk.stress[2][i] + spherical + twice_shear * ezz[i];
    for (int k = 3; k < symmetric_components<Dim>; ++k) {
      stress[k][i] = chunk.stress[k][i] + twice_shear * chunk.strain_increment[k][i];
    }
  }
}

/// Writes the rows of `stress` to the chunk.
template <int Dim, int States>
SLUICE_ALWAYS_INLINE void store_stress(const double (&stress)[symmetric_components<Dim>][chunk_lanes],
                                       const Chunk<Dim, States>& chunk) {
  for (int k = 0; k < symmetric_components<Dim>; ++k) {
    double* const target = chunk.stress[k];
#pragma GCC ivdep
    for (int i = 0; i < chunk_lanes; ++i) target[i] = stress[k][i];
  }
}

}  // namespace sluice
