/// Half-plane (plane strain) under a uniform pressure q on the strip |x| <= a of its surface (EX.35)-(EX.37).
/// In saturated soil with incompressible water and grains no volume changes at t = 0+, hence the mean effective stress
/// does not either, and the pore pressure is the mean total pressure, p = q alpha / pi with the angle alpha under which
/// the strip is seen. Total stresses of a half-plane do not depend on the elastic constants. Sources: Michell (1902)
/// for the stresses; Schiffman, Chen & Jordan (1969), An analysis of consolidation theories, J. Soil Mech. Found. Div.
/// ASCE 95, 285-312, for the strip as a problem of consolidation. Holds below the surface: there, drainage sets in at
/// once. x from the middle, y = depth > 0; stresses positive in tension, y axis downwards for the shear stress.
#pragma once

#include <cmath>
#include <numbers>

namespace sluice::exact {

struct PlaneStress {
  double xx, yy, xy;
};

/// Changes of total stress, Pa.
inline PlaneStress strip_load_stress(double q, double half_width, double x, double depth) {
  const double t1 = std::atan2(x + half_width, depth), t2 = std::atan2(x - half_width, depth);
  const double alpha = t1 - t2, sine = (std::sin(2 * t1) - std::sin(2 * t2)) / 2;
  const double cosine = (std::cos(2 * t2) - std::cos(2 * t1)) / 2, scale = -q / std::numbers::pi;
  return {scale * (alpha - sine), scale * (alpha + sine), scale * cosine};
}

/// Pore pressure at t = 0+, Pa: q times the angle of the strip over pi.
inline double strip_load_undrained_pressure(double q, double half_width, double x, double depth) {
  return q / std::numbers::pi * (std::atan2(x + half_width, depth) - std::atan2(x - half_width, depth));
}

}  // namespace sluice::exact
