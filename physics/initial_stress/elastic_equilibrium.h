/// What elastic_equilibrium shares with the equilibrium of the real materials, which begins with it.
#pragma once

#include <Eigen/Core>

#include "physics/materials/materials.h"
#include "physics/statics/grid_unknowns.h"

namespace sluice {

/// The stress of each particle from the displacements of the unknowns, eq. (31). Throws CaseError if they say that
/// nothing holds the bodies.
template <int Dim>
void set_elastic_stress(Scene<Dim>& scene, const Materials<Dim>& materials, Unknowns<Dim>& unknowns,
                        const Eigen::VectorXd& solution);

}  // namespace sluice
