/// Elasticity in logarithmic strain (Hencky), for any material that is linear in it: docs/theory.md, eqs. (24a)-(24e).
///
/// The Kirchhoff stress tau = J sigma of such a material is D times its logarithmic elastic strain, so that the stress
/// itself remembers the elastic deformation, and nothing else has to be kept but the initial volume.
#pragma once

#include <array>
#include <cstddef>

#include "core/transfer/shape_kernels.h"
#include "physics/materials/material.h"

namespace sluice::hencky {

/// Before the law: stress becomes the Kirchhoff stress of the beginning of the step, and the strain increments become
/// the change of the logarithmic elastic strain that the step would make if it were elastic. `initial_volume` is set to
/// `volume` where it is 0.
void begin(std::size_t n, const std::array<double*, 4>& stress, const std::array<double*, 4>& strain,
           const std::array<const double*, 1>& rotation, const double* volume, double* initial_volume,
           const IsotropicElasticity& elasticity);
void begin(std::size_t n, const std::array<double*, 6>& stress, const std::array<double*, 6>& strain,
           const std::array<const double*, 3>& rotation, const double* volume, double* initial_volume,
           const IsotropicElasticity& elasticity);

/// After it: Cauchy stress again, with the new volume.
template <std::size_t Components>
void end(std::size_t n, const std::array<double*, Components>& stress, const double* volume,
         const double* initial_volume) {
  for (std::size_t p = 0; p < n; ++p) {
    const double inverse = initial_volume[p] / volume[p];
    for (double* const column : stress) column[p] *= inverse;
  }
}

}  // namespace sluice::hencky
