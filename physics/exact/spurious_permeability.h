/// The permeability that a projection adds to the soil's (EX.26)-(EX.28).
///
/// If the drag acts on the intermediate velocities only, and the pressure correction phi = p^{n+1} - beta p^n
/// accelerates grains and water as if there were none, the water gains n (dv_w - dv_s) = -n dt (1/rho_w - 1/rho_s) grad
/// phi. Where the pressure changes slowly phi = (1 - beta) p: a flux that knows neither k nor Darcy. The Poisson
/// coefficient that goes with it is (1-n)/rho_s + n/rho_w. Published: Kularathna et al. (2021), Int. J. Numer. Anal.
/// Methods Geomech. 45; the symptom was reported by Morikawa & Asai (2022), Computers and Geotechnics 142, 104570.
#pragma once

#include <Eigen/Dense>
#include <cmath>

#include "physics/exact/saturated_soil.h"

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

/// One Fourier mode of a saturated column on linear elements of size h: velocities are sines of the height; pressure
/// and stress cosines. Returns c_eff / c_v over `steps`, from an equilibrated start. `consistent` lets the drag act on
/// the pressure correction too.
inline double measured_consolidation_factor(const SaturatedSoil& soil, double beta, double dt, double wave_number,
                                            double h, bool consistent, int steps) {
  const double n = soil.porosity, ms = (1 - n) * soil.solid_density, mw = n * soil.water_density, rho = ms + mw;
  const double D = soil.drag(), jump = soil.solid_density - soil.water_density;
  const double E = 2 * std::sin(wave_number * h / 2) / h, G = std::sin(wave_number * h) / h;
  const double C = consistent ? 1 / rho + n * (1 - n) * jump * jump / (rho * soil.solid_density * soil.water_density) /
                                              (1 + dt * soil.drag_rate())
                              : (1 - n) / soil.solid_density + n / soil.water_density;
  Eigen::Matrix2d drag;
  drag << ms + dt * D, -dt * D, -dt * D, mw + dt * D;
  const Eigen::Matrix2d mass = Eigen::Vector2d(ms, mw).asDiagonal();
  const Eigen::Vector2d share(1 - n, n);
  const Eigen::Matrix2d predict = drag.inverse(), correct = consistent ? predict : Eigen::Matrix2d(mass.inverse());
  Eigen::Vector2d v = Eigen::Vector2d::Zero();
  double p = 1, stress = 1, early = 0;
  for (int step = 0; step < steps; ++step) {
    if (step == steps / 2) early = p;
    Eigen::Vector2d force = beta * G * p * share;
    force[0] -= E * stress;
    v = predict * (mass * v + dt * force);
    const double phi = -G * share.dot(v) / (dt * C * E * E);
    v += dt * G * phi * (correct * share);
    p = beta * p + phi;
    stress += soil.modulus * dt * E * v[0];
  }
  const double rate = std::log(early / p) / ((steps - steps / 2) * dt);
  return rate / (soil.consolidation_coefficient() * wave_number * wave_number);
}

}  // namespace sluice::exact
