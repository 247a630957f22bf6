/// The stress in the ground before anything moves.
#pragma once

#include "core/case/schema.h"
#include "core/simulation/scene.h"
#include "physics/materials/materials.h"

namespace sluice {

/// The section `initial_stress` of a case.
struct InitialStress {
  enum class Method {
    none,                 ///< no stress
    uniform,              ///< the same everywhere
    elastic_equilibrium,  ///< linear-elastic equilibrium under gravity
  };
  Method method = Method::none;
  std::vector<double> stress;  ///< [Pa], tension positive, for `uniform`: xx yy zz xy (yz xz)
};

/// An absent section means `none`. Throws CaseError.
InitialStress read_initial_stress(const Node& section);
Node resolved(const InitialStress& initial_stress);
/// The keys of the section, for the reference.
std::vector<FieldDoc> initial_stress_docs();

/// What acts on the skeleton beside gravity; columns of all particles, null where there is nothing.
template <int Dim>
struct SkeletonLoads {
  const double* pressure = nullptr;                ///< pushes its surroundings apart, like pore water [Pa]
  std::array<const double*, Dim> body_force = {};  ///< [N]
};

/// Sets the stress of all particles. Throws CaseError.
template <int Dim>
void apply_initial_stress(const InitialStress& initial_stress, Scene<Dim>& scene, const Materials<Dim>& materials,
                          const SkeletonLoads<Dim>& loads = {});

/// Linear-elastic equilibrium of the particles where they are, under gravity and the faces of the grid: one sparse
/// factorization of the stiffness matrix on the grid, with the particles as quadrature points and the shape functions
/// of the scheme. The stresses are kept, the displacements dropped: docs/theory.md, eqs. (30)-(32). A face with
/// friction holds the material. Throws CaseError if nothing holds the body.
template <int Dim>
void elastic_equilibrium(Scene<Dim>& scene, const Materials<Dim>& materials, const SkeletonLoads<Dim>& loads);

}  // namespace sluice
