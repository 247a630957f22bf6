/// Critical time steps in one dimension, for cells of size h, linear functions, lumped masses and symplectic Euler,
/// without flow through the grid and without a margin (EX.29)-(EX.33).
#pragma once

#include <cmath>

#include "physics/exact/saturated_soil.h"

namespace sluice::exact {

/// One phase, drained: the skeleton carries the mass rho. h / sqrt(M / rho).
inline double drained_limit(const SaturatedSoil& soil, double h) {
  return h * std::sqrt(soil.density() / soil.modulus);
}

/// One phase, undrained: h / sqrt((M + K_w / n) / rho).
inline double undrained_limit(const SaturatedSoil& soil, double h) {
  const double Q = soil.water_bulk_modulus / soil.porosity;
  return h * std::sqrt(soil.density() / (soil.modulus + Q));
}

/// The highest squared frequency of grains and water without drag, 1/s2: (b + sqrt(b^2 - 4 d)) / 2 (EX.30).
inline double highest_frequency_squared(const SaturatedSoil& soil, double h) {
  const double n = soil.porosity, grains = (1 - n) * soil.solid_density, K = soil.water_bulk_modulus, h2 = h * h;
  const double b = 4 / h2 * ((soil.modulus + (1 - n) * (1 - n) * K / n) / grains + K / soil.water_density);
  const double d = 16 * soil.modulus * K / (grains * soil.water_density * h2 * h2);
  return (b + std::sqrt(b * b - 4 * d)) / 2;
}

/// Explicit v-w with explicit drag (EX.31): the published estimate, a lower bound that takes the fastest wave to be
/// damped with the whole rate a = D / mu. Mieremet, Stolle, Ceccato & Vuik (2016), Int. J. Numer. Anal. Methods
/// Geomech. 40.
inline double explicit_drag_limit(const SaturatedSoil& soil, double h) {
  const double a = soil.drag_rate();
  return 4 / (a + std::sqrt(a * a + 4 * highest_frequency_squared(soil, h)));
}

/// Explicit v-w without drag, 2 / omega_max; implicit nodal drag does not lower it.
inline double explicit_limit_without_drag(const SaturatedSoil& soil, double h) {
  return 2 / std::sqrt(highest_frequency_squared(soil, h));
}

/// Explicit v-w when drag decides, 2 / a = 2 (1-n) rho_s k / (n rho g).
inline double drag_limit(const SaturatedSoil& soil) { return 2 / soil.drag_rate(); }

/// Explicit u-p: the pressure diffuses explicitly, h^2 gamma_w / (2 d k Q) in d dimensions (EX.32).
inline double explicit_diffusion_limit(const SaturatedSoil& soil, double h, int dimension) {
  return h * h * soil.water_unit_weight() * soil.porosity /
         (2 * dimension * soil.conductivity * soil.water_bulk_modulus);
}

/// Projection: the limit lies between these two for every k and K_w (EX.33); the lower is the one to use.
struct ProjectionLimit {
  double lower;  ///< h sqrt((1-n) rho_s / M): high conductivity, the grains move alone
  double upper;  ///< h sqrt(rho / M): low conductivity, the water moves with them
};

inline ProjectionLimit projection_limit(const SaturatedSoil& soil, double h) {
  return {h * std::sqrt((1 - soil.porosity) * soil.solid_density / soil.modulus), drained_limit(soil, h)};
}

}  // namespace sluice::exact
