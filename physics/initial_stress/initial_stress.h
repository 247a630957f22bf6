/// The stress in the ground before anything moves.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/case/schema.h"
#include "core/simulation/scene.h"
#include "physics/materials/stress_update.h"
#include "physics/statics/skeleton_loads.h"

namespace sluice {

/// The section `initial_stress` of a case.
struct InitialStress {
  enum class Method {
    none,                 ///< no stress
    uniform,              ///< the same everywhere
    elastic_equilibrium,  ///< linear-elastic equilibrium under gravity
    equilibrium,          ///< equilibrium with the strength of the materials
    k0,                   ///< the weight of what lies above, and a share of it sideways
    from_file             ///< that of an earlier run
  };
  /// Which particle of the earlier run gives its stress to which of this one.
  enum class By {
    automatic,  ///< by particles if they are the same, else by cells
    particles,  ///< the one of the same identity
    cells       ///< those around it: a linear fit over cells
  };
  Method method = Method::none;
  std::vector<double> stress;  ///< [Pa], tension positive, for `uniform`: xx yy zz xy (yz xz)

  int increments = 1;       ///< of weight and loads, for `equilibrium`
  double tolerance = 1e-4;  ///< of forces out of balance, over the largest force on a node

  std::vector<std::array<double, 2>> surface;  ///< [m], for `k0`: one point for a level; empty: the top of the bodies
  std::optional<double> k0;                    ///< of all materials
  std::map<std::string, double> k0_of;         ///< by name of the material
  std::map<std::string, Place> k0_places;

  std::string file;            ///< for `from_file`: results.h5 of the earlier run
  std::optional<double> time;  ///< [s]; absent: the last
  By by = By::automatic;
  bool state = true;  ///< takes the state variables of the materials, too
  Place place;
};

/// An absent section means `none`. Throws CaseError.
InitialStress read_initial_stress(const Node& section);
Node resolved(const InitialStress& initial_stress);
/// The section with its keys, for the reference.
FieldDoc initial_stress_doc();

/// Sets the stress of all particles. `by: automatic` becomes what was done. Throws CaseError.
template <int Dim>
void apply_initial_stress(InitialStress& initial_stress, Scene<Dim>& scene, const StressUpdate<Dim>& stress,
                          const SkeletonLoads<Dim>& loads = {});

/// Linear-elastic equilibrium of the particles where they are, under gravity and the faces of the grid: one sparse
/// factorization of the stiffness matrix on the grid, with the particles as quadrature points and the shape functions
/// of the scheme. The stresses are kept, the displacements dropped: docs/theory.md, eqs. (30)-(32). A face with
/// friction holds the material. Throws CaseError if nothing holds the body.
template <int Dim>
void elastic_equilibrium(Scene<Dim>& scene, const Materials<Dim>& materials, const SkeletonLoads<Dim>& loads);

/// Equilibrium with the materials as they are, from zero to the whole of weight and loads, with the stress update of
/// the steps: docs/theory.md, eqs. (32e) and (32f). State variables follow. Throws CaseError where there is none.
template <int Dim>
void equilibrium(const InitialStress& initial, Scene<Dim>& scene, const StressUpdate<Dim>& stress,
                 const SkeletonLoads<Dim>& loads);

/// Vertical stress from the weight of what lies above, balanced on the grid, and K0 times it sideways; no shear:
/// docs/theory.md, eqs. (32a)-(32d). Throws CaseError.
template <int Dim>
void k0_stress(const InitialStress& initial_stress, Scene<Dim>& scene, const Materials<Dim>& materials,
               const SkeletonLoads<Dim>& loads);

/// Stress and state variables of an earlier run. Throws CaseError.
template <int Dim>
void stress_from_file(InitialStress& initial_stress, Scene<Dim>& scene, const Materials<Dim>& materials);

}  // namespace sluice
