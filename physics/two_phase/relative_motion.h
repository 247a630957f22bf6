/// RelativeMotion: the velocity of the pore water relative to the solid, where it has an inertia of its own (v-w-p).
/// Its drag is solved for at the nodes, in closed form. docs/theory.md, section 9, eqs. (51)-(54).
#pragma once

#include <memory>
#include <vector>

#include "core/simulation/stages.h"
#include "core/simulation/sweep.h"
#include "core/simulation/velocity_filter.h"
#include "physics/two_phase/pore_water.h"

namespace sluice {

template <int Dim>
class RelativeMotion {
 public:
  RelativeMotion(const Case& definition, const WaterCase& water, PoreWater<Dim>& pores);

  bool active() const { return active_; }
  void declare(Particles& particles, bool affine);

  /// Relative velocities of the particles; nulls where there are none.
  std::array<const double*, Dim> velocity(const Particles& particles) const;

  /// Kinetic energy that the water has because it does not move with the solid: m_w ((v + r)^2 - v^2) / 2 [J].
  double kinetic_energy(const Particles& particles) const;

  /// To be called before the first stage of a step.
  void begin_step(const Scene<Dim>& scene);

  // Each of the following is a stage over `some` blocks, or adds its stages to a sweep: see Sweep.

  /// Particles to nodes: {m_w, m_w r}.
  void scatter(Scene<Dim>& scene, Items some);
  /// Sums them. With a projection, the nodes' velocity becomes that of the mixture, V = v + (m_w / m) r, until they are
  /// corrected.
  void collect(Scene<Dim>& scene, Items some);
  /// The new relative velocity of the nodes from the new pressure; the nodes' velocity becomes that of the solid again.
  void advance(Sweep<Dim>& sweep, Scene<Dim>& scene, std::vector<Workspace<Dim>>& workspaces, double kick);
  /// `explicit`: the pressure of the particles from the divergences of the nodes' new velocities.
  void compress(Scene<Dim>& scene, std::vector<Workspace<Dim>>& workspaces, double dt, Items some);
  /// Nodes to particles.
  void gather(Sweep<Dim>& sweep, Scene<Dim>& scene, std::vector<Workspace<Dim>>& workspaces, double dt);

 private:
  ScatterInput<Dim> water_input(Scene<Dim>& scene, const ParticleBlock<Dim>& block);
  void set_drag(Scene<Dim>& scene, const ParticleBlock<Dim>& block);
  void scatter_drag(Scene<Dim>& scene, std::size_t b, const ParticleBlock<Dim>& block);
  void advance_nodes(Scene<Dim>& scene, std::size_t b, double kick);
  void take_from_nodes(Scene<Dim>& scene, std::vector<Workspace<Dim>>& workspaces, double dt, Items some);

  const WaterCase& water_;
  PoreWater<Dim>& pores_;
  bool active_, projected_;
  std::unique_ptr<Faces<Dim>> faces_;  // what they are to the water
  NodeFields<Dim> nodes_;
  VelocityFilter<Dim> filter_;
  std::vector<Lane> before_;  // {r} of the nodes at the beginning of the step, and the share m_w / m
  ColumnId velocity_, affine_;
  ColumnId water_mass_, drag_, drive_, scratch_, partial_stress_, relative_divergence_;
};

}  // namespace sluice
