/// ObstacleWater: the pressure of the pore water on the surfaces of obstacles, and the water that does not pass them.
///
/// The nodes around a surface feel the gradient of the pressure, which needs no wall to hold it; and what they let
/// through the surface is taken out of the balance of volume by the transpose of the same. docs/theory.md,
/// section 9.14, eqs. (49a) and (49b).
#pragma once

#include <vector>

#include "core/simulation/stages.h"
#include "physics/loads/external_pressure.h"
#include "physics/statics/skeleton_loads.h"
#include "physics/two_phase/pore_water.h"

namespace sluice {

template <int Dim>
class ObstacleWater {
 public:
  /// Does nothing in a case without obstacles.
  ObstacleWater(const Case& definition, const PoreWater<Dim>& pores);

  bool active() const { return active_; }
  void declare(Particles& particles);

  /// To be called before the first stage of a step.
  void begin_step(Scene<Dim>& scene);

  /// The pressure to the nodes around obstacles, for a block: the share `share` of that of its particles, less that of
  /// ponds.
  void scatter(Scene<Dim>& scene, std::size_t b, const ParticleBlock<Dim>& block, double share,
               const ExternalPressure<Dim>& outside);
  NodeFields<Dim>* nodes() { return active_ ? &pressure_ : nullptr; }

  /// After the nodes have their predicted velocities, on some blocks of nodes: parts those that count with their
  /// divergence from those that count with what flows along surfaces.
  void part(Scene<Dim>& scene, Items some);
  /// For a block, before its particles are summed: the divergence of the first, to the column of `pores`.
  void take_divergence(Scene<Dim>& scene, std::size_t b, const ParticleBlock<Dim>& block, Workspace<Dim>& work);
  /// After: the flow of the second, to the expansion of the vertices, the tile of linear functions; and how much of it
  /// leaves a surface behind.
  void add_flow(Scene<Dim>& scene, std::size_t b, const ParticleBlock<Dim>& block, Lane* vertices) const;

  /// Adds what the pressure does to the skeleton at rest around obstacles.
  void add_at_rest(Scene<Dim>& scene, const ExternalPressure<Dim>& outside, std::vector<Workspace<Dim>>& workspaces,
                   SkeletonLoads<Dim>& loads);

 private:
  void take(Scene<Dim>& scene, const ParticleBlock<Dim>& block, double share, const ExternalPressure<Dim>& outside);

  const PoreWater<Dim>& pores_;
  bool active_;
  NodeFields<Dim> pressure_, parted_;
  std::vector<char> near_;  // by block of particles: obstacles are near
  ColumnId volume_, pressure_column_, slope_, flow_, flow_divergence_;
};

extern template class ObstacleWater<2>;
extern template class ObstacleWater<3>;

}  // namespace sluice
