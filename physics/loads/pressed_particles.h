/// PressedParticles: the outside pressure at the particles, the forces that come of it, and the work that they do.
/// Every physics module with loads on surfaces owns one. docs/theory.md, section 8.
#pragma once

#include <array>
#include <vector>

#include "core/simulation/stages.h"
#include "physics/initial_stress/initial_stress.h"
#include "physics/loads/external_pressure.h"

namespace sluice {

template <int Dim>
class PressedParticles {
 public:
  /// To be called only in a case with loads; without, `active` stays false and nothing is kept.
  void declare(Particles& particles);
  bool active() const { return active_; }

  /// P and -V grad P at the particles of a block, at the time of the scene.
  void take(Scene<Dim>& scene, const ParticleBlock<Dim>& block, const ExternalPressure<Dim>& outside);

  /// P as taken [Pa], a whole column.
  const double* pressure(const Particles& particles) const { return particles.columns.data(pressure_); }

  /// Adds P to a normal stress and -V grad P to a body force of the particles of a block, whole columns.
  void add_to(double* stress, const std::array<double*, Dim>& force, const Particles& particles,
              const ParticleBlock<Dim>& block) const;

  /// Takes at all particles, and gives what acts on a body at rest: less P in `push`, the pressure that the particles
  /// have otherwise [Pa], and the body force.
  SkeletonLoads<Dim> at_rest(Scene<Dim>& scene, const ExternalPressure<Dim>& outside,
                             std::vector<Workspace<Dim>>& workspaces, double* push);

  /// Scatters a block with the body force; the normal stresses of `in` hold P already. `what` is `force` or
  /// `momentum_and_force`. Tiles are those of `nodes`.
  void scatter(const Scene<Dim>& scene, std::size_t b, ScatterInput<Dim> in, ScatterWhat what,
               NodeFields<Dim>& nodes) const;

  // ---- work: written by block, summed in block order ----

  void begin_step(const Scene<Dim>& scene);
  /// Counts the work of the pressure that the particles of a block have taken, from here on.
  void start_work(const Scene<Dim>& scene, std::size_t b, const ParticleBlock<Dim>& block);
  /// Adds the work done since then.
  void add_work(const Scene<Dim>& scene, std::size_t b, const ParticleBlock<Dim>& block);
  void end_step();
  /// Since the start [J].
  double work() const { return work_; }
  void restore_work(double work) { work_ = work; }

 private:
  /// Sums of P V and of f x over the particles of a block, with the force f = -V grad P [J]. Where volumes change, P
  /// does the work of minus what is gained of the first; where positions change, f does that of the second.
  struct Sums {
    double pressure_volume = 0, force_position = 0;
  };
  struct BlockWork {
    Sums from;
    double work = 0;  // [J]
  };
  Sums sums(const Scene<Dim>& scene, const ParticleBlock<Dim>& block) const;

  bool active_ = false;
  ColumnId pressure_, force_;
  std::vector<BlockWork> blocks_;
  double work_ = 0;
};

extern template class PressedParticles<2>;
extern template class PressedParticles<3>;

}  // namespace sluice
