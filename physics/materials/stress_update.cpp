#include "physics/materials/stress_update.h"

#include <algorithm>
#include <map>

#include "core/simulation/guard.h"

namespace sluice {

namespace {

StressTiming timing_of(const Case& definition) {
  static const std::map<std::string, StressTiming> words = {
      {"usf", StressTiming::usf}, {"usl", StressTiming::usl}, {"musl", StressTiming::musl}};
  return words.at(definition.scheme.stress_update);
}

/// The in-plane trace of the strain increments of n particles.
template <int Dim>
void volumetric_strain(const StrainIncrements<Dim>& strain, std::size_t n, double* __restrict trace) {
  std::copy_n(strain.strain[0], n, trace);
  for (std::size_t a = 1; a < Dim; ++a)
    for (std::size_t p = 0; p < n; ++p) trace[p] += strain.strain[a][p];
}

/// Changes the in-plane trace of the strain increments to `trace`, in equal parts; destroys `trace`.
template <int Dim>
void set_volumetric_strain(double* __restrict trace, std::size_t n, const StrainIncrements<Dim>& strain) {
  for (std::size_t a = 0; a < Dim; ++a)
    for (std::size_t p = 0; p < n; ++p) trace[p] -= strain.strain[a][p];
  for (std::size_t a = 0; a < Dim; ++a)
    for (std::size_t p = 0; p < n; ++p) strain.strain[a][p] += trace[p] / Dim;
}

}  // namespace

template <int Dim>
StressUpdate<Dim>::StressUpdate(const Case& definition)
    : materials_(definition), timing_(timing_of(definition)), f_bar_(definition.scheme.f_bar) {}

template <int Dim>
void StressUpdate<Dim>::declare(Columns& particles, ColumnId inertia) {
  inertia_ = inertia;
  materials_.declare(particles);
  if (timing_ == StressTiming::musl)
    next_position_ = particles.declare({"next_position", "m", Dim, Role::derived,
                                        "Position at the end of the step, while stresses are updated.", false});
  if (f_bar_) {
    strain_increment_ = particles.declare({"strain_increment", "1", symmetric_components<Dim>, Role::derived,
                                           "Strain increment of the step, before F-bar.", false});
    spin_increment_ = particles.declare(
        {"spin_increment", "1", spin_components<Dim>, Role::derived, "Rotation increment of the step.", false});
  }
}

template <int Dim>
void StressUpdate<Dim>::gather_motion(Scene<Dim>& scene, double dt, ColumnId positions) {
  const auto timing = scene.clock.time(Stage::gather);
  const MotionUpdate<Dim> update = motion_update(scene, dt, positions);
  for_each_block(scene, workspaces_, [&](std::size_t b, const ParticleBlock<Dim>& block, Workspace<Dim>& work) {
    scene.nodes.load_motion(scene.blocks, b, work.motion_tile.data());
    const double strain_rate = motion_[b].largest_strain_rate;  // of the stress update, if that came first
    motion_[b] = scene.shape->gather_motion(scene.view(block), work.motion_tile.data(), update);
    motion_[b].largest_strain_rate = strain_rate;
  });
}

template <int Dim>
void StressUpdate<Dim>::gather_motion_and_update(Scene<Dim>& scene, double dt) {
  {
    const auto timing = scene.clock.time(Stage::gather);
    const MotionUpdate<Dim> update = motion_update(scene, dt, scene.particles.position);
    for_each_block(scene, workspaces_, [&](std::size_t b, const ParticleBlock<Dim>& block, Workspace<Dim>& work) {
      const StrainIncrements<Dim> strain = f_bar_ ? kept_strain(scene, block.begin) : work.strain;
      MotionUpdate<Dim> own = update;
      own.strain = &strain;
      if (f_bar_) cells_.locate(scene.view(block));
      scene.nodes.load_motion(scene.blocks, b, work.motion_tile.data());
      motion_[b] = scene.shape->gather_motion(scene.view(block), work.motion_tile.data(), own);
      if (!f_bar_) stress_[b] = update_block(scene, block, strain, dt);
    });
  }
  if (f_bar_) apply_f_bar(scene, dt, {});
}

template <int Dim>
void StressUpdate<Dim>::gather_motion_and_map_again(Scene<Dim>& scene, double dt) {
  gather_motion(scene, dt, next_position_);
  scatter(scene, ScatterWhat::momentum);
  velocity_from_momentum(scene);
  update(scene, dt);
  Columns& columns = scene.particles.columns;
  for (int a = 0; a < Dim; ++a)
    std::ranges::copy(columns.values(next_position_, a), columns.data(scene.particles.position, a));
}

template <int Dim>
void StressUpdate<Dim>::update(Scene<Dim>& scene, double dt, const AfterBlock& after_block) {
  {
    const auto timing = scene.clock.time(Stage::stress);
    for_each_block(scene, workspaces_, [&](std::size_t b, const ParticleBlock<Dim>& block, Workspace<Dim>& work) {
      const StrainIncrements<Dim> strain = f_bar_ ? kept_strain(scene, block.begin) : work.strain;
      scene.nodes.load_motion(scene.blocks, b, work.motion_tile.data());
      const double largest = scene.shape->gather_strain(scene.view(block), work.motion_tile.data(), dt, strain);
      motion_[b].largest_strain_rate = dt > 0 ? largest / dt : 0;
      if (f_bar_) {
        cells_.locate(scene.view(block));
        return;
      }
      stress_[b] = update_block(scene, block, strain, dt);
      if (after_block) after_block(b, block, work);
    });
  }
  if (f_bar_) apply_f_bar(scene, dt, after_block);
}

/// F-bar on cells, eq. (26): the volumetric strain increment of each particle gives way to the mean of its cell.
template <int Dim>
void StressUpdate<Dim>::apply_f_bar(Scene<Dim>& scene, double dt, const AfterBlock& after_block) {
  const auto timing = scene.clock.time(Stage::stress);
  const double* volume = scene.particles.columns.data(scene.particles.volume);
  for_each_block(scene, workspaces_, [&](std::size_t b, const ParticleBlock<Dim>& block, Workspace<Dim>& work) {
    double* const dilation = work.numbers.data();
    volumetric_strain(kept_strain(scene, block.begin), block.end - block.begin, dilation);
    cells_.add(b, scene.view(block), volume, dilation);
  });
  for_each_block(scene, workspaces_, [&](std::size_t b, const ParticleBlock<Dim>& block, Workspace<Dim>& work) {
    const StrainIncrements<Dim> strain = kept_strain(scene, block.begin);
    double* const mean = work.numbers.data();
    cells_.mean(scene.blocks, b, scene.view(block), mean);
    set_volumetric_strain(mean, block.end - block.begin, strain);
    stress_[b] = update_block(scene, block, strain, dt);
    if (after_block) after_block(b, block, work);
  });
}

template <int Dim>
StressReport StressUpdate<Dim>::update_block(Scene<Dim>& scene, const ParticleBlock<Dim>& block,
                                             const StrainIncrements<Dim>& strain, double dt) {
  return materials_.update_stress(scene.particles, inertia_, scene.blocks, block, strain, dt);
}

/// The strain columns, from particle `first` on.
template <int Dim>
StrainIncrements<Dim> StressUpdate<Dim>::kept_strain(Scene<Dim>& scene, std::uint32_t first) {
  Columns& columns = scene.particles.columns;
  StrainIncrements<Dim> strain;
  for (int c = 0; c < symmetric_components<Dim>; ++c) strain.strain[c] = columns.data(strain_increment_, c) + first;
  for (int c = 0; c < spin_components<Dim>; ++c) strain.rotation[c] = columns.data(spin_increment_, c) + first;
  return strain;
}

// ---- reports: written by block, summed in block order ----

template <int Dim>
void StressUpdate<Dim>::begin_step(const Scene<Dim>& scene) {
  if (f_bar_) cells_.resize(scene.blocks);
  motion_.assign(scene.blocks.particle_blocks().size(), {});
  stress_.assign(scene.blocks.particle_blocks().size(), {});
}

template <int Dim>
void StressUpdate<Dim>::end_step(Scene<Dim>& scene) {
  MotionReport all;
  for (const MotionReport& r : motion_) {
    all.largest_speed_squared = std::max(all.largest_speed_squared, r.largest_speed_squared);
    all.largest_travel = std::max(all.largest_travel, r.largest_travel);
    all.largest_strain_rate = std::max(all.largest_strain_rate, r.largest_strain_rate);
    all.finite = all.finite && r.finite;
    all.inside = all.inside && r.inside;
  }
  scene.motion = all;
  scene.travelled += all.largest_travel;

  fastest_wave_ = 0;
  bool sound = true;
  for (const StressReport& r : stress_) {
    fastest_wave_ = std::max(fastest_wave_, r.fastest_wave);
    sound = sound && r.sound;
  }
  if (!sound || !all.finite) throw_first_bad_particle(scene);
}

template class StressUpdate<2>;
template class StressUpdate<3>;

}  // namespace sluice
