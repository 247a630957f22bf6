/// A thick cylinder in plane strain under internal pressure, elastic and perfectly plastic with the strength of Tresca.
/// Source: R. Hill, The Mathematical Theory of Plasticity, Oxford 1950, chapter V.2. Tension positive.
#pragma once

#include <cmath>

namespace sluice::exact {

/// The axial stress is the middle one, as it is for usual ratios of Poisson and b / a < 5.
struct ThickCylinder {
  double inner, outer;  ///< radii [m]
  double strength;      ///< largest shear stress c [Pa]

  /// The pressure at which the material is plastic to this radius [Pa]: 2 c (ln(rho / a) + (1 - rho^2 / b^2) / 2).
  double pressure(double plastic) const {
    return 2 * strength * (std::log(plastic / inner) + 0.5 * (1 - plastic * plastic / (outer * outer)));
  }
  /// The most that it bears [Pa]: 2 c ln(b / a).
  double collapse_pressure() const { return pressure(outer); }

  struct Stress {
    double radial, hoop;
  };
  Stress stress(double r, double plastic) const {
    if (r < plastic) {
      const double radial = -pressure(plastic) + 2 * strength * std::log(r / inner);
      return {radial, radial + 2 * strength};
    }
    const double size = strength * plastic * plastic / (outer * outer), ratio = outer * outer / (r * r);
    return {size * (1 - ratio), size * (1 + ratio)};
  }
  /// In the elastic part, outwards [m].
  double displacement(double r, double plastic, double youngs_modulus, double poisson_ratio) const {
    const double size = (1 + poisson_ratio) * strength * plastic * plastic / (youngs_modulus * outer * outer);
    return size * ((1 - 2 * poisson_ratio) * r + outer * outer / r);
  }
};

}  // namespace sluice::exact
