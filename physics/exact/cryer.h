/// Cryer's sphere: a saturated elastic sphere of radius a, drained surface, all-round total pressure p0 from t = 0 on,
/// incompressible water and grains, no inertia (EX.21)-(EX.25). The pressure in the centre rises above p0 before it
/// falls, because the drained shell squeezes the core (Mandel-Cryer effect). Source of the problem: Cryer (1963), A
/// comparison of the three-dimensional consolidation theories of Biot and Terzaghi, Quarterly Journal of Mechanics and
/// Applied Mathematics 16, 401-412. Derived in docs/exact_solutions.md. Dimensionless: rho = r / a, T = c_v t / a^2
/// with c_v = k (lambda + 2 G) / gamma_w; p > 0 in compression.
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "physics/exact/saturated_soil.h"

namespace sluice::exact {

class CryerSphere {
 public:
  /// `roots` of the series: enough for T down to about 4 / roots^2.
  explicit CryerSphere(double poisson_ratio, int roots = 1000) : eta((1 - 2 * poisson_ratio) / (1 - poisson_ratio)) {
    require(poisson_ratio > -1 && poisson_ratio < 0.5, "Poisson's ratio must lie between -1 and 0.5");
    for (int m = 0; m < roots; ++m) modes.push_back(mode(m));
  }

  /// p(r, t) / p0 at rho = r / a.
  double pressure(double rho, double T) const {
    if (T <= 0) return rho < 1 ? 1 : 0;
    return sum(T, [&](double x) { return std::sin(x) - (rho * x < 1e-6 ? x : std::sin(rho * x) / rho); });
  }

  double centre_pressure(double T) const { return pressure(0, T); }

  /// Radial displacement of the surface over its final value, -p0 a / (3 K) with the drained bulk modulus K.
  double settlement(double T) const {
    if (T <= 0) return 0;
    return 1 + (3 - 2 * eta) / (2 * eta) * sum(T, [](double x) { return std::sin(x); });
  }

 private:
  struct Root {
    double x, denominator;
  };

  /// D(x) = (2 eta - x^2) sin x - 2 eta x cos x, whose sign differs at the ends of every interval (m pi, (m + 1) pi).
  Root mode(int m) const {
    double low = m * std::numbers::pi + 1e-3, high = (m + 1) * std::numbers::pi;
    const double side = m % 2 ? 1 : -1;
    for (int i = 0; i < 80; ++i) {
      const double x = (low + high) / 2, D = (2 * eta - x * x) * std::sin(x) - 2 * eta * x * std::cos(x);
      (side * D > 0 ? low : high) = x;
    }
    const double x = (low + high) / 2;
    return {x, x * std::cos(x) + 2 * (1 - eta) * std::sin(x)};
  }

  template <class Numerator>
  double sum(double T, Numerator&& numerator) const {
    double value = 0;
    for (const Root& root : modes) {
      if (root.x * root.x * T > 45) break;
      value += 2 * numerator(root.x) / root.denominator * std::exp(-root.x * root.x * T);
    }
    return value;
  }

  double eta;  // 2 G / (lambda + 2 G)
  std::vector<Root> modes;
};

}  // namespace sluice::exact
