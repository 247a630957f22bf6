#include "physics/loads/pressed_particles.h"

namespace sluice {

template <int Dim>
void PressedParticles<Dim>::declare(Particles& particles) {
  Columns& columns = particles.columns;
  using enum Role;
  pressure_ = columns.declare({"outside_pressure", "Pa", 1, derived, "Pressure from outside.", false});
  force_ = columns.declare({"body_force", "N", Dim, derived, "Force that goes with outside pressure.", false});
  active_ = true;
}

template <int Dim>
void PressedParticles<Dim>::take(Scene<Dim>& scene, const ParticleBlock<Dim>& block,
                                 const ExternalPressure<Dim>& outside) {
  Columns& columns = scene.particles.columns;
  const double* volume = columns.data(scene.particles.volume);
  FieldAtParticles<Dim> out{columns.data(pressure_), {}};
  for (int a = 0; a < Dim; ++a) out.gradient[a] = columns.data(force_, a);
  VertexTile<Dim> tile;
  outside.load(block.first_cell, scene.time, tile);
  interpolate<Dim>(tile, scene.view(block), out);
  for (int a = 0; a < Dim; ++a)
    for (std::uint32_t p = block.begin; p < block.end; ++p) out.gradient[a][p] *= -volume[p];
}

template <int Dim>
void PressedParticles<Dim>::add_to(double* stress, const std::array<double*, Dim>& force, const Particles& particles,
                                   const ParticleBlock<Dim>& block) const {
  const double* const here = pressure(particles);
  for (std::uint32_t p = block.begin; p < block.end; ++p) stress[p] += here[p];
  for (int a = 0; a < Dim; ++a) {
    const double* const own = particles.columns.data(force_, a);
    for (std::uint32_t p = block.begin; p < block.end; ++p) force[static_cast<std::size_t>(a)][p] += own[p];
  }
}

template <int Dim>
SkeletonLoads<Dim> PressedParticles<Dim>::at_rest(Scene<Dim>& scene, const ExternalPressure<Dim>& outside,
                                                  std::vector<Workspace<Dim>>& workspaces, double* push) {
  const double* here = pressure(scene.particles);
  for_each_block(scene, workspaces, [&](std::size_t, const auto& block, Workspace<Dim>&) {
    take(scene, block, outside);
    for (std::uint32_t p = block.begin; p < block.end; ++p) push[p] -= here[p];
  });
  SkeletonLoads<Dim> loads{push, {}};
  for (int a = 0; a < Dim; ++a) loads.body_force[a] = scene.particles.columns.data(force_, a);
  return loads;
}

template <int Dim>
void PressedParticles<Dim>::scatter(const Scene<Dim>& scene, std::size_t b, ScatterInput<Dim> in, ScatterWhat what,
                                    NodeFields<Dim>& nodes) const {
  for (int a = 0; a < Dim; ++a) in.body_force[a] = scene.particles.columns.data(force_, a);
  // Body forces go with the forces alone.
  if (what == ScatterWhat::momentum_and_force)
    scene.shape->scatter(ScatterWhat::momentum, in, 0, nodes.momentum_tile(b), nullptr);
  scene.shape->scatter(ScatterWhat::force, in, 0, nullptr, nodes.force_tile(b));
}

// ---- work ----

template <int Dim>
typename PressedParticles<Dim>::Sums PressedParticles<Dim>::sums(const Scene<Dim>& scene,
                                                                 const ParticleBlock<Dim>& block) const {
  const Columns& columns = scene.particles.columns;
  const double* here = columns.data(pressure_);
  const double* volume = columns.data(scene.particles.volume);
  Sums sums;
  for (std::uint32_t p = block.begin; p < block.end; ++p) sums.pressure_volume += here[p] * volume[p];
  for (int a = 0; a < Dim; ++a) {
    const double* force = columns.data(force_, a);
    const double* position = columns.data(scene.particles.position, a);
    for (std::uint32_t p = block.begin; p < block.end; ++p) sums.force_position += force[p] * position[p];
  }
  return sums;
}

template <int Dim>
void PressedParticles<Dim>::begin_step(const Scene<Dim>& scene) {
  if (active()) blocks_.assign(scene.blocks.particle_blocks().size(), {});
}

template <int Dim>
void PressedParticles<Dim>::start_work(const Scene<Dim>& scene, std::size_t b, const ParticleBlock<Dim>& block) {
  if (active()) blocks_[b].from = sums(scene, block);
}

template <int Dim>
void PressedParticles<Dim>::add_work(const Scene<Dim>& scene, std::size_t b, const ParticleBlock<Dim>& block) {
  if (!active()) return;
  const Sums now = sums(scene, block);
  const Sums& from = blocks_[b].from;
  blocks_[b].work += now.force_position - from.force_position - (now.pressure_volume - from.pressure_volume);
}

template <int Dim>
void PressedParticles<Dim>::end_step() {
  for (const BlockWork& block : blocks_) work_ += block.work;
}

template class PressedParticles<2>;
template class PressedParticles<3>;

}  // namespace sluice
