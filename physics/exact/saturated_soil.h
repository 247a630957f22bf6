/// What the exact solutions of this folder need to know of a saturated, linearly elastic soil, and the numbers that
/// follow from it. SI units. Pressure is positive in compression, stress positive in tension: sigma = sigma' - p.
/// Equation numbers (EX.n) are those of docs/exact_solutions.md.
#pragma once

#include <limits>
#include <stdexcept>

namespace sluice::exact {

/// Constrained modulus lambda + 2 G.
inline double constrained_modulus(double youngs_modulus, double poisson_ratio) {
  return youngs_modulus * (1 - poisson_ratio) / ((1 + poisson_ratio) * (1 - 2 * poisson_ratio));
}

struct SaturatedSoil {
  double porosity = 0.4;
  double solid_density = 2650;  ///< of the grains, kg/m3
  double water_density = 1000;  ///< kg/m3
  double modulus = 0;           ///< constrained modulus M = lambda + 2 G of the skeleton, Pa
  double conductivity = 0;      ///< k, m/s
  double gravity = 9.81;        ///< m/s2, for the unit weight of water
  double water_bulk_modulus = std::numeric_limits<double>::infinity();  ///< K_w, Pa

  double density() const { return (1 - porosity) * solid_density + porosity * water_density; }
  double buoyant_unit_weight() const { return (density() - water_density) * gravity; }
  double water_unit_weight() const { return water_density * gravity; }

  /// M / Q with Q = K_w / n: 0 for incompressible water.
  double compliance_ratio() const { return modulus * porosity / water_bulk_modulus; }

  /// Pore pressure over total stress in undrained confined loading, Q / (M + Q).
  double undrained_ratio() const { return 1 / (1 + compliance_ratio()); }

  /// c_v = k / (gamma_w (1/M + n/K_w)), m2/s.
  double consolidation_coefficient() const {
    return conductivity * modulus / (water_unit_weight() * (1 + compliance_ratio()));
  }

  /// Drag per volume and relative velocity, D = n^2 gamma_w / k.
  double drag() const { return porosity * porosity * water_unit_weight() / conductivity; }

  /// mu = m_s m_w / rho with the partial densities of grains and water.
  double reduced_density() const { return (1 - porosity) * solid_density * porosity * water_density / density(); }

  /// D / mu: without other forces v_w - v_s decays as exp(-D/mu t), and m_s v_s + m_w v_w stays (EX.2).
  double drag_rate() const { return drag() / reduced_density(); }
};

inline void require(bool condition, const char* message) {
  if (!condition) throw std::invalid_argument(message);
}

}  // namespace sluice::exact
