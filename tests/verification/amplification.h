/// By how much a step makes the waves of a saturated column grow: spectral radii of one step for waves of the number
/// theta / h. One dimension, linear functions, lumped masses, particles that integrate their cells exactly.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "physics/exact/explicit_limits.h"

namespace sluice::exact {

/// Of explicit v-w, symplectic Euler: velocities and strains of both.
inline double explicit_amplification(const SaturatedSoil& soil, double h, double theta, double dt, bool implicit_drag) {
  const double n = soil.porosity, ms = (1 - n) * soil.solid_density, mw = n * soil.water_density,
               Q = soil.water_bulk_modulus / n;
  const double E = 2 * std::sin(theta / 2) / h;
  Eigen::Matrix2d K, D;
  K << soil.modulus + (1 - n) * (1 - n) * Q, n * (1 - n) * Q, n * (1 - n) * Q, n * n * Q;
  D << 1, -1, -1, 1;
  D *= soil.drag() * dt;
  const Eigen::Matrix2d mass = Eigen::Vector2d(ms, mw).asDiagonal(), one = Eigen::Matrix2d::Identity();
  const Eigen::Matrix2d inverse =
      implicit_drag ? Eigen::Matrix2d((mass + D).inverse()) : Eigen::Matrix2d(mass.inverse());
  const Eigen::Matrix2d A = inverse * (implicit_drag ? mass : Eigen::Matrix2d(mass - D)), B = -dt * E * inverse * K;
  Eigen::Matrix4d step;
  step << A, B, dt * E * A, one + dt * E * B;
  return step.eigenvalues().cwiseAbs().maxCoeff();
}

/// Of the projection u-p with increments of the pressure and stabilisation: velocity, effective stress and pressure, by
/// docs/theory.md (41)-(47). The divergence and the gradient of the pressure reach the nodes by the means over cells,
/// sin(theta), the skeleton by differences, 2 sin(theta / 2).
inline double up_amplification(const SaturatedSoil& soil, double h, double theta, double dt) {
  const double n = soil.porosity, rho = soil.density(), M = soil.modulus, ell = soil.water_density / rho;
  const double mobility = soil.conductivity / soil.water_unit_weight();
  const double C = dt / rho + mobility * (1 - ell), C_old = dt / rho - mobility * ell;
  const double tau = std::max(
      {0.0, h * h / (4 * dt) * std::min(1 / M, 2500 * dt * dt / (rho * h * h)) - C, (ell - 0.4) * mobility - dt / rho});
  const double storage = n / (soil.water_bulk_modulus * dt);
  const std::complex<double> cell(0, 2 * std::sin(theta / 2) / h), vertex(0, std::sin(theta) / h);
  const double laplacian = std::norm(cell);
  using Row = Eigen::RowVector3cd;
  const Row v = Row::Unit(0), stress = Row::Unit(1), p = Row::Unit(2);
  const Row change = dt / rho * (cell * stress - vertex * p), predicted = v + change;
  const Row supply = ((C_old + tau) * laplacian + storage) * p - vertex * predicted +
                     mobility * soil.water_density / dt * vertex * change;
  Eigen::Matrix3cd step;
  step.row(2) = supply / ((C + tau) * laplacian + storage);
  step.row(0) = predicted - dt / rho * vertex * (step.row(2) - p);
  step.row(1) = stress + M * dt * cell * step.row(0);
  return step.eigenvalues().cwiseAbs().maxCoeff();
}

/// Of the projection v-w-p, for the wave from node to node, which has no pressure: velocity of the grains, relative
/// velocity and effective stress, by (51)-(53).
inline double vwp_sawtooth_amplification(const SaturatedSoil& soil, double h, double dt) {
  const double n = soil.porosity, rho = soil.density(), water = n * soil.water_density / rho;  // its share
  const double mu = (1 - water) * water * rho;
  const std::complex<double> cell(0, 2 / h);
  using Row = Eigen::RowVector3cd;
  const Row v = Row::Unit(0), relative = Row::Unit(1), stress = Row::Unit(2);
  const Row change = dt / rho * cell * stress;
  Eigen::Matrix3cd step;
  step.row(1) = (mu * relative - water * rho * change) / (mu + dt * soil.drag());
  step.row(0) = v + water * relative + change - water * step.row(1);
  step.row(2) = stress + soil.modulus * dt * cell * step.row(0);
  return step.eigenvalues().cwiseAbs().maxCoeff();
}

}  // namespace sluice::exact
