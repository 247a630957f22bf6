/// One-dimensional consolidation without inertia: a layer of thickness H, drained at the top, impermeable and fixed at
/// the base (EX.3)-(EX.6). Source: Terzaghi (1923); Terzaghi, Theoretical Soil Mechanics (1943), ch. XIII. With
/// compressible water the same series holds for c_v of SaturatedSoil and the initial pressure Q/(M+Q) of the load.
/// Dimensionless: depth Z = depth / H from the drained face, T = c_v t / H^2; pressures over the largest initial one.
#pragma once

#include <cmath>
#include <numbers>

#include "physics/exact/saturated_soil.h"

namespace sluice::exact {

/// sum over m of f(kappa, (-1)^m) exp(-kappa^2 T), kappa = (2 m + 1) pi / 2; T > 0.
template <class Term>
double sum_consolidation_series(double T, Term&& term) {
  double sum = 0, sign = 1;
  for (int m = 0; m < 100000; ++m, sign = -sign) {
    const double kappa = (m + 0.5) * std::numbers::pi;
    if (kappa * kappa * T > 45) break;
    sum += term(kappa, sign) * std::exp(-kappa * kappa * T);
  }
  return sum;
}

/// Uniform initial pressure: p / p0 (EX.4).
inline double terzaghi_pressure(double Z, double T) {
  if (T <= 0) return Z > 0 ? 1 : 0;
  if (T > 0.05) return sum_consolidation_series(T, [&](double k, double) { return 2 / k * std::sin(k * Z); });
  // Images of the half-space solution: few terms where the series needs many.
  double p = 1, sign = 1;
  for (int j = 0; j < 4; ++j, sign = -sign)
    p -= sign * (std::erfc((2 * j + Z) / (2 * std::sqrt(T))) + std::erfc((2 * j + 2 - Z) / (2 * std::sqrt(T))));
  return p;
}

/// Degree of consolidation: 1 - mean(p) / p0.
inline double terzaghi_consolidation(double T) {
  if (T <= 0) return 0;
  return 1 - sum_consolidation_series(T, [](double k, double) { return 2 / (k * k); });
}

/// Initial pressure p0 Z, as of a column deposited at once: p / p0 (EX.5).
inline double linear_consolidation_pressure(double Z, double T) {
  if (T <= 0) return Z;
  return sum_consolidation_series(T, [&](double k, double sign) { return 2 * sign / (k * k) * std::sin(k * Z); });
}

/// Its degree of consolidation: 1 - mean(p) / (p0 / 2).
inline double linear_consolidation(double T) {
  if (T <= 0) return 0;
  return 1 - sum_consolidation_series(T, [](double k, double sign) { return 4 * sign / (k * k * k); });
}

/// Integral of p / p0 from depth Z to the base, for both initial pressures.
inline double terzaghi_pressure_below(double Z, double T) {
  if (T <= 0) return 1 - Z;
  return sum_consolidation_series(T, [&](double k, double) { return 2 / (k * k) * std::cos(k * Z); });
}

inline double linear_pressure_below(double Z, double T) {
  if (T <= 0) return (1 - Z * Z) / 2;
  return sum_consolidation_series(T, [&](double k, double sign) { return 2 * sign / (k * k * k) * std::cos(k * Z); });
}

/// A layer under a load q at its top and, if `self_weight` is not 0, its own buoyant weight, both applied at t = 0.
/// Excess pressures and displacements are those on top of the hydrostatic state without effective stress.
struct ConsolidatingLayer {
  SaturatedSoil soil;
  double height;           ///< H, m
  double load = 0;         ///< q, Pa, compression positive
  double self_weight = 0;  ///< gamma', N/m3: soil.buoyant_unit_weight() for self-weight consolidation

  double time_factor(double t) const { return soil.consolidation_coefficient() * t / (height * height); }

  /// Excess pore pressure at the height z above the base, Pa.
  double pressure(double z, double t) const {
    const double Z = 1 - z / height, T = time_factor(t);
    return soil.undrained_ratio() *
           (load * terzaghi_pressure(Z, T) + self_weight * height * linear_consolidation_pressure(Z, T));
  }

  /// Vertical effective stress at z, Pa, negative in compression.
  double effective_stress(double z, double t) const { return -(load + self_weight * (height - z) - pressure(z, t)); }

  /// Vertical displacement at z, m, upwards positive: the integral of effective_stress / M from the base (EX.6).
  double displacement(double z, double t) const {
    const double Z = 1 - z / height, T = time_factor(t);
    const double water = soil.undrained_ratio() * (load * height * terzaghi_pressure_below(Z, T) +
                                                   self_weight * height * height * linear_pressure_below(Z, T));
    return -(load * z + self_weight * z * (height - z / 2) - water) / soil.modulus;
  }

  double settlement(double t) const { return -displacement(height, t); }
};

}  // namespace sluice::exact
