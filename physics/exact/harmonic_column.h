/// Saturated layer of thickness L on a rigid impermeable base under the surface load q exp(i omega t), drained top, in
/// five models of decreasing completeness (EX.14)-(EX.20). Source of the problem: Zienkiewicz, Chang & Bettess (1980),
/// Drained, undrained, consolidating and dynamic behaviour assumptions in soils, Geotechnique 30, 385-395.
///
/// Depth z = 0 (top) ... 1 (base); u: displacement of the grains, w = n (U - u): displacement of the water relative to
/// them, both downwards positive and over q L / M; p: pore pressure over q; q > 0 in compression. All complex
/// amplitudes.
///
/// With O = rho omega^2 L^2 / M, d = gamma_w omega L^2 / (k M), e = M / Q = n M / K_w, b = rho_w / rho:
///     mixture   u'' - p' = -O (u + [b w])                                                                 (EX.15)
///     water        -p' = -O b u - [O b / n] w + i d w                                                     (EX.16)
///     storage    u' + w' = -e p                                                                           (EX.17)
/// Full keeps the terms in brackets, u-p drops them (rho_w u_tt stays in the water), quasi-static has O = 0, undrained
/// w = 0, drained p = 0. Groups over M and not over M + Q, as usual, so that e = 0 is an ordinary value.
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

#include "physics/exact/saturated_soil.h"

namespace sluice::exact {

enum class ColumnModel { full, u_p, quasi_static, undrained, drained };

struct HarmonicGroups {
  double inertia;        ///< O = rho omega^2 L^2 / M
  double drag;           ///< d = gamma_w omega L^2 / (k M)
  double compliance;     ///< e = M / Q, 0 for incompressible water
  double density_ratio;  ///< b = rho_w / rho
  double porosity;

  /// The groups of Zienkiewicz et al., for e > 0, and those of the rules of thumb.
  double kappa() const { return 1 / (1 + compliance); }        ///< Q / (M + Q)
  double pi_1() const { return (1 + 1 / compliance) / drag; }  ///< k V_c^2 / (g b omega L^2)
  double pi_2() const { return inertia * (1 - kappa()); }      ///< omega^2 L^2 / V_c^2
  double pi_3() const { return inertia / drag; }               ///< Pi1 Pi2 = k omega / (b g): relative inertia
  double drainage() const { return kappa() / drag; }           ///< T_d = c_v / (omega L^2)
};

/// From Pi1, Pi2, kappa < 1, b = rho_w / rho and n.
inline HarmonicGroups zienkiewicz_groups(double pi_1, double pi_2, double kappa, double density_ratio,
                                         double porosity) {
  require(kappa < 1, "Pi1 and Pi2 are scaled by V_c, which is infinite for kappa = 1");
  return {pi_2 / (1 - kappa), 1 / (pi_1 * (1 - kappa)), (1 - kappa) / kappa, density_ratio, porosity};
}

inline HarmonicGroups harmonic_groups(const SaturatedSoil& soil, double thickness, double omega) {
  const double L2 = thickness * thickness;
  return {soil.density() * omega * omega * L2 / soil.modulus,
          soil.water_unit_weight() * omega * L2 / (soil.conductivity * soil.modulus), soil.compliance_ratio(),
          soil.water_density / soil.density(), soil.porosity};
}

struct HarmonicState {
  std::complex<double> u, w, p;
  std::complex<double> strain;  ///< u' over q / M: effective stress over q, negative in compression
};

class HarmonicColumn {
 public:
  HarmonicColumn(ColumnModel model, const HarmonicGroups& groups) {
    const double O = groups.inertia, e = groups.compliance;
    if (model == ColumnModel::undrained) {
      modes = {{std::sqrt(Complex(-O * e / (1 + e))), e / (1 + e), 0, 1 / (1 + e)}};
    } else if (model == ColumnModel::drained) {
      modes = {{std::sqrt(Complex(-O)), 1, -1, 0}};
    } else {
      two_waves(model, groups);
    }
  }

  /// At the relative depth z.
  HarmonicState at(double z) const {
    HarmonicState state{};
    for (const Mode& m : modes) {
      const Complex sine = sinh_ratio(m.lambda, z), cosine = cosh_ratio(m.lambda, z);
      state.u += m.u * sine;
      state.w += m.w * sine;
      state.p += m.p * cosine;
      state.strain -= m.u * cosine;
    }
    return state;
  }

 private:
  using Complex = std::complex<double>;

  /// u and w = amplitude sinh(lambda (1 - z)) / (lambda cosh lambda), p = amplitude cosh(lambda (1 - z)) / cosh lambda.
  struct Mode {
    Complex lambda, u, w, p;
  };

  /// (EX.18)-(EX.20). The modes are scaled by p, which stays finite for e -> 0, where the fast wave no longer moves.
  void two_waves(ColumnModel model, const HarmonicGroups& groups) {
    const double relative = model == ColumnModel::full ? 1 : 0;  // 1 keeps the inertia of w
    const double O = model == ColumnModel::quasi_static ? 0 : groups.inertia, e = groups.compliance;
    const double Ob = O * groups.density_ratio;
    const Complex g(-relative * Ob / groups.porosity, groups.drag);
    // (s + A) (s - e g) - (s + e B) (O b + g) = 0 for s = lambda^2.
    const double A = O - relative * Ob, B = relative * Ob;
    const Complex half = 0.5 * (A - e * g - Ob - g), product = -e * g * A - e * B * (Ob + g);
    const Complex root = std::sqrt(half * half - product);
    const Complex large = std::abs(half + root) > std::abs(half - root) ? -(half + root) : root - half;
    const Complex s[2] = {large, product / large};
    for (int j = 0; j < 2; ++j) {
      const Complex p = (j == 0 ? -1.0 : 1.0) * (Ob + g) / (s[0] - s[1]);
      const Complex u = (j == 0 ? 1.0 : -1.0) * (s[j] - e * g) / (s[0] - s[1]);
      modes.push_back({std::sqrt(s[j]), u, e * p - u, p});
    }
  }

  /// Written with decaying exponentials: Re(lambda) >= 0 for a principal root.
  static Complex sinh_ratio(const Complex& l, double z) {
    if (std::abs(l) < 1e-6) return 1 - z;
    return (std::exp(-l * z) - std::exp(-l * (2 - z))) / (l * (1.0 + std::exp(-2.0 * l)));
  }
  static Complex cosh_ratio(const Complex& l, double z) {
    return (std::exp(-l * z) + std::exp(-l * (2 - z))) / (1.0 + std::exp(-2.0 * l));
  }

  std::vector<Mode> modes;
};

struct ModelError {
  double displacement;  ///< rms of the difference in u over the rms of u
  double pressure;      ///< rms of the difference in p over the rms of p, but not less than a tenth of the load
};

/// By how much a model differs from the full one over the depth, at `points` midpoints.
inline ModelError model_error(ColumnModel model, const HarmonicGroups& groups, int points = 200) {
  const HarmonicColumn column(model, groups), full(ColumnModel::full, groups);
  double du = 0, dp = 0, u = 0, p = 0;
  for (int i = 0; i < points; ++i) {
    const HarmonicState a = column.at((i + 0.5) / points), b = full.at((i + 0.5) / points);
    du += std::norm(a.u - b.u);
    dp += std::norm(a.p - b.p);
    u += std::norm(b.u);
    p += std::norm(b.p);
  }
  return {std::sqrt(du / u), std::sqrt(dp / points) / std::max(std::sqrt(p / points), 0.1)};
}

/// The cheapest model whose two errors stay below the tolerance.
inline ColumnModel cheapest_model(const HarmonicGroups& groups, double tolerance) {
  for (const ColumnModel model :
       {ColumnModel::drained, ColumnModel::undrained, ColumnModel::quasi_static, ColumnModel::u_p}) {
    const ModelError error = model_error(model, groups);
    if (error.displacement < tolerance && error.pressure < tolerance) return model;
  }
  return ColumnModel::full;
}

}  // namespace sluice::exact
