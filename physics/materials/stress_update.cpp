#include "physics/materials/stress_update.h"

#include <algorithm>
#include <map>

#include "core/simulation/guard.h"
#include "physics/materials/f_bar.h"

namespace sluice {

namespace {

StressTiming timing_of(const Case& definition) {
  static const std::map<std::string, StressTiming> words = {
      {"usf", StressTiming::usf}, {"usl", StressTiming::usl}, {"musl", StressTiming::musl}};
  return words.at(definition.scheme.stress_update);
}

}  // namespace

template <int Dim>
StressUpdate<Dim>::StressUpdate(const Case& definition)
    : materials_(definition), timing_(timing_of(definition)), f_bar_(definition.scheme.f_bar) {}

template <int Dim>
void StressUpdate<Dim>::declare(Columns& particles, ColumnId inertia) {
  inertia_ = inertia;
  materials_.declare(particles);
  if (timing_ == StressTiming::musl) {
    next_position_ = particles.declare({"next_position", "m", Dim, Role::derived,
                                        "Position at the end of the step, while stresses are updated.", false});
    if (particles.contains("domain"))
      next_domain_ = particles.declare({"next_domain", "m", particles.spec(particles.find("domain")).components,
                                        Role::derived, "Domain at the end of the step.", false});
  }
  if (f_bar_) {
    strain_increment_ = particles.declare({"strain_increment", "1", symmetric_components<Dim>, Role::derived,
                                           "Strain increment of the step, before F-bar.", false});
    spin_increment_ = particles.declare(
        {"spin_increment", "1", spin_components<Dim>, Role::derived, "Rotation increment of the step.", false});
  }
}

// ---- the stages of each way to update: see Sweep ----

template <int Dim>
void StressUpdate<Dim>::gather_motion(Sweep<Dim>& sweep, Scene<Dim>& scene, double dt) {
  filter_.add(sweep, scene);
  sweep.over_particles(
      [this, &scene, dt](Items some) { move(scene, dt, scene.particles.position, scene.domain, some); });
}

template <int Dim>
void StressUpdate<Dim>::gather_motion_and_update(Sweep<Dim>& sweep, Scene<Dim>& scene, double dt) {
  filter_.add(sweep, scene);
  sweep.over_particles([this, &scene, dt](Items some) { move_and_strain(scene, dt, some); });
  if (f_bar_) sweep.over_particles([this, &scene, dt](Items some) { apply_f_bar(scene, dt, {}, some); });
}

template <int Dim>
void StressUpdate<Dim>::gather_motion_and_map_again(Sweep<Dim>& sweep, Scene<Dim>& scene, double dt) {
  filter_.add(sweep, scene);
  sweep.over_particles([this, &scene, dt](Items some) { move(scene, dt, next_position_, next_domain_, some); });
  sweep.over_particles([&scene](Items some) { scatter(scene, ScatterWhat::momentum, 0, some); });
  sweep.over_nodes([&scene](Items some) { velocity_from_momentum(scene, Moment::now, some); });
  update(sweep, scene, dt);
  sweep.over_particles([this, &scene](Items some) { take_next_position(scene, some); });
}

template <int Dim>
void StressUpdate<Dim>::update(Sweep<Dim>& sweep, Scene<Dim>& scene, double dt, const AfterBlock& after_block) {
  sweep.over_particles([this, &scene, dt, after_block](Items some) { strain(scene, dt, after_block, some); });
  if (f_bar_)
    sweep.over_particles([this, &scene, dt, after_block](Items some) { apply_f_bar(scene, dt, after_block, some); });
}

// ---- the stages ----

template <int Dim>
void StressUpdate<Dim>::move(Scene<Dim>& scene, double dt, ColumnId positions, ColumnId domains, Items some) {
  const auto timing = scene.clock.time(Stage::gather);
  const MotionUpdate<Dim> update = motion_update(scene, dt, positions, domains);
  const auto body = [&](std::size_t b, const ParticleBlock<Dim>& block, Workspace<Dim>& work) {
    const double strain_rate = motion_[b].largest_strain_rate;  // of the stress update, if that came first
    motion_[b] = {};
    from_nodes(scene, b, block, work.motion_tile.data(), [&](const BlockParticles<Dim>& particles, std::uint32_t) {
      motion_[b].include(scene.shape->gather_motion(particles, work.motion_tile.data(), update));
    });
    motion_[b].largest_strain_rate = strain_rate;
  };
  for_each_block(scene, workspaces_, body, some);
}

template <int Dim>
void StressUpdate<Dim>::move_and_strain(Scene<Dim>& scene, double dt, Items some) {
  const auto timing = scene.clock.time(Stage::gather);
  const MotionUpdate<Dim> update = motion_update(scene, dt, scene.particles.position, scene.domain);
  const auto body = [&](std::size_t b, const ParticleBlock<Dim>& block, Workspace<Dim>& work) {
    const StrainIncrements<Dim> strain = f_bar_ ? kept_strain(scene, block.begin) : work.strain;
    if (f_bar_) locate_in_cells(scene, block);
    motion_[b] = {};
    from_nodes(scene, b, block, work.motion_tile.data(),
               [&](const BlockParticles<Dim>& particles, std::uint32_t first) {
                 MotionUpdate<Dim> own = update;
                 const StrainIncrements<Dim> of_run = strain.from(first);
                 own.strain = &of_run;
                 motion_[b].include(scene.shape->gather_motion(particles, work.motion_tile.data(), own));
               });
    if (f_bar_)
      add_to_cells(scene, b, block, work);
    else
      stress_[b] = update_block(scene, block, strain, dt);
  };
  for_each_block(scene, workspaces_, body, some);
}

template <int Dim>
void StressUpdate<Dim>::strain(Scene<Dim>& scene, double dt, const AfterBlock& after_block, Items some) {
  const auto timing = scene.clock.time(Stage::stress);
  const auto body = [&](std::size_t b, const ParticleBlock<Dim>& block, Workspace<Dim>& work) {
    const StrainIncrements<Dim> strain = f_bar_ ? kept_strain(scene, block.begin) : work.strain;
    double largest = 0;
    from_nodes(
        scene, b, block, work.motion_tile.data(), [&](const BlockParticles<Dim>& particles, std::uint32_t first) {
          largest =
              std::max(largest, scene.shape->gather_strain(particles, work.motion_tile.data(), dt, strain.from(first)));
        });
    motion_[b].largest_strain_rate = dt > 0 ? largest / dt : 0;
    if (f_bar_) {
      locate_in_cells(scene, block);
      add_to_cells(scene, b, block, work);
      return;
    }
    stress_[b] = update_block(scene, block, strain, dt);
    if (after_block) after_block(b, block, work);
  };
  for_each_block(scene, workspaces_, body, some);
}

template <int Dim>
void StressUpdate<Dim>::locate_in_cells(const Scene<Dim>& scene, const ParticleBlock<Dim>& block) {
  for_bodies(scene, block, [&](int body, const BlockParticles<Dim>& particles, std::uint32_t) {
    cells_[static_cast<std::size_t>(body)].locate(particles);
  });
}

/// F-bar on cells, eq. (26): the volumetric strain increment of each particle gives way to the mean of its body in its
/// cell. Here the increments of a block go to the cells.
template <int Dim>
void StressUpdate<Dim>::add_to_cells(Scene<Dim>& scene, std::size_t number, const ParticleBlock<Dim>& block,
                                     Workspace<Dim>& work) {
  double* const dilation = work.numbers.data();
  volumetric_strain(kept_strain(scene, block.begin), block.end - block.begin, dilation);
  for (auto& cells : cells_) cells.clear(number);
  for_bodies(scene, block, [&](int body, const BlockParticles<Dim>& particles, std::uint32_t first) {
    cells_[static_cast<std::size_t>(body)].add(number, particles, scene.particles.columns.data(scene.particles.volume),
                                               dilation + first);
  });
}

/// Here the means of the cells come back, and stresses follow.
template <int Dim>
void StressUpdate<Dim>::apply_f_bar(Scene<Dim>& scene, double dt, const AfterBlock& after_block, Items some) {
  const auto timing = scene.clock.time(Stage::stress);
  const auto body = [&](std::size_t b, const ParticleBlock<Dim>& block, Workspace<Dim>& work) {
    const StrainIncrements<Dim> strain = kept_strain(scene, block.begin);
    double* const mean = work.numbers.data();
    for_bodies(scene, block, [&](int own, const BlockParticles<Dim>& particles, std::uint32_t first) {
      cells_[static_cast<std::size_t>(own)].mean(scene.blocks, b, particles, mean + first);
    });
    set_volumetric_strain(mean, block.end - block.begin, strain);
    stress_[b] = update_block(scene, block, strain, dt);
    if (after_block) after_block(b, block, work);
  };
  for_each_block(scene, workspaces_, body, some);
}

/// MUSL: the particles go where `move` has found that they go.
template <int Dim>
void StressUpdate<Dim>::take_next_position(Scene<Dim>& scene, Items some) {
  Columns& columns = scene.particles.columns;
  parallel_for(some, [&](std::size_t b) {
    const auto& block = scene.blocks.particle_blocks()[b];
    const auto take = [&](ColumnId next, ColumnId column, int components) {
      for (int c = 0; c < components; ++c)
        std::copy(columns.data(next, c) + block.begin, columns.data(next, c) + block.end,
                  columns.data(column, c) + block.begin);
    };
    take(next_position_, scene.particles.position, Dim);
    if (next_domain_.index >= 0) take(next_domain_, scene.domain, scene.domain_components());
  });
}

template <int Dim>
StressReport StressUpdate<Dim>::update_block(Scene<Dim>& scene, const ParticleBlock<Dim>& block,
                                             const StrainIncrements<Dim>& strain, double dt) {
  return materials_.update_stress(scene.particles, inertia_, scene.blocks, block, strain, dt, scene.time);
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
  if (f_bar_) {
    cells_.resize(static_cast<std::size_t>(scene.bodies()));
    for (auto& cells : cells_) cells.resize(scene.blocks, scene.shape->node_shift());
  }
  motion_.assign(scene.blocks.particle_blocks().size(), {});
  stress_.assign(scene.blocks.particle_blocks().size(), {});
}

template <int Dim>
void StressUpdate<Dim>::end_step(Scene<Dim>& scene) {
  MotionReport all;
  for (const MotionReport& r : motion_) all.include(r);
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
