/// The permeability that a projection adds to the soil's (EX.26)-(EX.28).
///
/// If the drag acts on the intermediate velocities only, and the pressure correction phi = p^{n+1} - beta p^n
/// accelerates grains and water as if there were none, the water gains n (dv_w - dv_s) = -n dt (1/rho_w - 1/rho_s) grad
/// phi. Where the pressure changes slowly phi = (1 - beta) p: a flux that knows neither k nor Darcy. The Poisson
/// coefficient that goes with it is (1-n)/rho_s + n/rho_w. Published: Kularathna et al. (2021), Int. J. Numer. Anal.
/// Methods Geomech. 45; the symptom was reported by Morikawa & Asai (2022), Computers and Geotechnics 142, 104570.
#pragma once

#include "tests/verification/exact/saturated_soil.h"

namespace sluice::exact {

/// (1 - beta) n g dt (1 - rho_w / rho_s), m/s.
inline double spurious_conductivity(const SaturatedSoil& soil, double beta, double dt) {
  return (1 - beta) * soil.porosity * soil.gravity * dt * (1 - soil.water_density / soil.solid_density);
}

/// Rate of consolidation over the exact one, c_eff / c_v, of the published scheme.
inline double spurious_consolidation_factor(const SaturatedSoil& soil, double beta, double dt) {
  return 1 + spurious_conductivity(soil, beta, dt) / soil.conductivity;
}

/// The same of a projection with consistent drag: what is left is the difference of the assembled Laplacian and the
/// product of divergence and gradient, (gamma_w dt / rho) (wave_number h)^2 / 4, for linear elements of size h.
inline double consistent_consolidation_factor(const SaturatedSoil& soil, double beta, double dt, double wave_number,
                                              double h) {
  const double kh = wave_number * h;
  return 1 + (1 - beta) * soil.water_unit_weight() * dt / soil.density() * kh * kh / 4 / soil.conductivity;
}

}  // namespace sluice::exact
