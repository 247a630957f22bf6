/// PoreWater: the water that particles hold, and what they tell the nodes, cells and vertices of it.
#pragma once

#include <vector>

#include "core/simulation/stages.h"
#include "physics/initial_stress/initial_stress.h"
#include "physics/loads/pressed_particles.h"
#include "physics/materials/materials.h"
#include "physics/two_phase/cell_sums.h"
#include "physics/two_phase/pressure_equation.h"
#include "physics/two_phase/water.h"

namespace sluice {

/// Permeabilities are given for this gravity, whatever the gravity of the case is (a centrifuge) [m/s2].
inline constexpr double standard_gravity = 9.81;

template <int Dim>
class PoreWater {
 public:
  PoreWater(const WaterCase& water, std::vector<PoreSpace> spaces, const Materials<Dim>& materials);

  void declare(Particles& particles, bool with_body_force);
  /// Sets porosity, masses and which particles hold water, from the table and the materials.
  void fill(Scene<Dim>& scene);

  /// The pore pressure at the start, where it needs no solution.
  void set_initial_pressure(Scene<Dim>& scene);

  /// What pore pressure and outside pressure do to the skeleton.
  SkeletonLoads<Dim> skeleton_loads(Scene<Dim>& scene, const ExternalPressure<Dim>& outside,
                                    std::vector<Workspace<Dim>>& workspaces);

  const std::vector<PoreSpace>& spaces() const { return spaces_; }
  ColumnId inertia() const { return inertia_; }
  ColumnId pressure() const { return pressure_; }
  ColumnId pressure_gradient() const { return pressure_gradient_; }
  ColumnId divergence() const { return divergence_; }
  ColumnId acceleration() const { return acceleration_; }
  ColumnId porosity() const { return porosity_; }
  ColumnId wet() const { return wet_; }
  ColumnId zero() const { return zero_; }
  bool any_liquid() const;

  /// Which blocks hold water.
  std::vector<char> wet_blocks(const Scene<Dim>& scene) const;

  /// Forces on the nodes from the total stress sigma' - beta p, from outside pressure and its gradient; `what` is
  /// `force` or `momentum_and_force`.
  void scatter_forces(Scene<Dim>& scene, std::size_t b, const ParticleBlock<Dim>& block,
                      const ExternalPressure<Dim>& outside, ScatterWhat what);

  /// Divergence and change of the predicted velocities of the nodes, for the particles of a block.
  void take_prediction(Scene<Dim>& scene, std::size_t b, const ParticleBlock<Dim>& block, Workspace<Dim>& work);
  /// Particles of a block to its cells and vertices: eq. (45), with the prediction that they have taken. `relative`
  /// holds the velocities of the water relative to the solid, or nulls where it has no inertia of its own. Returns the
  /// power that the flow through the pores dissipates [W].
  double collect(Scene<Dim>& scene, std::size_t b, const ParticleBlock<Dim>& block, double kick,
                 const std::array<const double*, Dim>& relative, PressureEquation<Dim>& equation);

  /// The same for all blocks, with soil and water at rest.
  void collect_at_rest(Scene<Dim>& scene, PressureEquation<Dim>& equation);
  /// Particles whose pressure, as taken, is not positive hold no water.
  void dry_above_zero_pressure(Scene<Dim>& scene);

  /// The new pressure from the vertices, and the forces of what it adds to the old one.
  void correct(Scene<Dim>& scene, std::size_t b, const ParticleBlock<Dim>& block,
               const PressureEquation<Dim>& equation);
  /// What the new pressure, less that from outside, does on the surface of the material, eq. (49d), to the force tiles
  /// of `nodes`; after `correct`. Then the predicted change of the particles is gone.
  void scatter_traction(Scene<Dim>& scene, std::size_t b, const ParticleBlock<Dim>& block,
                        const ExternalPressure<Dim>& outside, FieldsByBody<Dim>& nodes);
  /// Pressure and its gradient at the particles, without forces: at the start.
  void take_pressure(Scene<Dim>& scene, std::size_t b, const ParticleBlock<Dim>& block,
                     const PressureEquation<Dim>& equation);

  /// p -= dt (div v + n div r) K_w / n, eq. (55); `divergence` of v and r by particle [1/s].
  void compress(Scene<Dim>& scene, const ParticleBlock<Dim>& block, const double* solid, const double* relative,
                double dt);

  /// Porosity and masses from the volumes, eq. (50).
  void follow_volume(Scene<Dim>& scene, const ParticleBlock<Dim>& block);

  /// Largest speed of sound, where no drag holds the water back [m/s].
  double fastest_sound(const Particles& particles) const;
  /// Of liquids, whose pressure resists the changes of volume that vertices do not see, like a bulk modulus (62a)
  /// [m/s].
  double fastest_under_pressure(const Particles& particles) const;

  /// The pressure from outside at the particles.
  PressedParticles<Dim>& pressed() { return pressed_; }
  const PressedParticles<Dim>& pressed() const { return pressed_; }

  /// Energy stored in the compressed water [J].
  double compression_energy(const Particles& particles) const;

  /// How easily water passes a material.
  Mobility<Dim> mobility(const PoreSpace& space) const;

 private:
  const WaterCase& water_;
  std::vector<PoreSpace> spaces_;
  const Materials<Dim>& materials_;

  ColumnId pressure_, pressure_gradient_, porosity_, solid_mass_, inertia_, wet_;  // state
  ColumnId divergence_, acceleration_, new_pressure_, total_stress_, zero_;        // derived
  PressedParticles<Dim> pressed_;
};

}  // namespace sluice
