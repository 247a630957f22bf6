/// Energies of the particles of a scene.
#pragma once

#include "core/simulation/scene.h"

namespace sluice {

/// Sum of m |v|^2 / 2 over the particles [J], with the velocities of the middle of the last step.
template <int Dim>
double kinetic_energy(const Scene<Dim>& scene);

/// Minus the sum of m g . x [J]; zero at the origin of coordinates.
template <int Dim>
double potential_energy(const Scene<Dim>& scene);

}  // namespace sluice
