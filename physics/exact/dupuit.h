/// Steady seepage through a rectangular dam of length L on an impermeable base, water levels h1 and h2 above it
/// (EX.34). The discharge is exact, seepage face and vertical flow included: Charny (1951); Bear, Dynamics of Fluids in
/// Porous Media (1972), sec. 8.1. The parabola of Dupuit is not: the free surface lies above it and leaves the dam
/// above h2.
#pragma once

#include <cmath>

namespace sluice::exact {

/// Discharge per metre of dam, m2/s. In anisotropic soil k is the horizontal conductivity: (EX.34) holds as it stands.
inline double dupuit_discharge(double conductivity, double h1, double h2, double length) {
  return conductivity * (h1 * h1 - h2 * h2) / (2 * length);
}

/// Dupuit's free surface at the distance x from the upstream face, m: a lower bound.
inline double dupuit_surface(double h1, double h2, double length, double x) {
  return std::sqrt(h1 * h1 - (h1 * h1 - h2 * h2) * x / length);
}

}  // namespace sluice::exact
