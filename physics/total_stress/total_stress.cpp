#include "physics/total_stress/total_stress.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/simulation/energy.h"
#include "core/simulation/guard.h"
#include "core/simulation/time_step.h"

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
TotalStress<Dim>::TotalStress(const Case& definition)
    : materials_(definition),
      initial_stress_(read_initial_stress(definition.initial_stress)),
      timing_(timing_of(definition)),
      f_bar_(definition.scheme.f_bar) {}

template <int Dim>
void TotalStress<Dim>::declare(Columns& particles) {
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
double TotalStress<Dim>::density(int material) const {
  return materials_[static_cast<std::size_t>(material)].density();
}

template <int Dim>
void TotalStress<Dim>::initialise(Scene<Dim>& scene) {
  apply_initial_stress(initial_stress_, scene, materials_);
  fastest_wave_ = materials_.fastest_wave(scene.particles);
}

template <int Dim>
std::vector<TimeStepLimit> TotalStress<Dim>::time_step_limits(const Scene<Dim>& scene) const {
  const auto& s = scene.scheme;
  return explicit_limits(scene, fastest_wave_, {s.courant, s.advection, s.strain_per_step});
}

template <int Dim>
std::vector<TimeStepLimit> TotalStress<Dim>::hard_limits(const Scene<Dim>& scene) const {
  return explicit_limits(scene, fastest_wave_, {1, 0.5, 0.5});
}

// ---- the step ------------------------------------------------------------------------------------------------------

template <int Dim>
void TotalStress<Dim>::step(Scene<Dim>& scene, double dt) {
  activate_blocks(scene);
  if (f_bar_) cells_.resize(scene.blocks);
  begin_reports(scene);
  switch (timing_) {
    case StressTiming::usf:
      step_usf(scene, dt);
      break;
    case StressTiming::usl:
      step_usl(scene, dt);
      break;
    case StressTiming::musl:
      step_musl(scene, dt);
      break;
  }
  end_motion_reports(scene);
  end_stress_reports(scene);
}

/// Update stress first: with the velocities that the particles brought along, over the interval just past.
template <int Dim>
void TotalStress<Dim>::step_usf(Scene<Dim>& scene, double dt) {
  scatter(scene, ScatterWhat::momentum);
  velocity_from_momentum(scene);
  update_stress(scene, scene.previous_dt, true);
  advance_nodes(scene, scene.kick(dt), false, true);
  gather_motion(scene, dt, scene.particles.position);
}

/// Update stress last: with the new velocities of the nodes.
template <int Dim>
void TotalStress<Dim>::step_usl(Scene<Dim>& scene, double dt) {
  const ScatterWhat what = momentum_with_force(scene);
  scatter(scene, what, scene.kick(dt));
  advance_nodes(scene, scene.kick(dt), true, what == ScatterWhat::momentum_and_force);
  gather_motion_and_update_stress(scene, dt);
}

/// Modified update stress last: the new velocities of the particles are mapped to the nodes once more.
template <int Dim>
void TotalStress<Dim>::step_musl(Scene<Dim>& scene, double dt) {
  const ScatterWhat what = momentum_with_force(scene);
  scatter(scene, what, scene.kick(dt));
  advance_nodes(scene, scene.kick(dt), true, what == ScatterWhat::momentum_and_force);
  gather_motion(scene, dt, next_position_);
  scatter(scene, ScatterWhat::momentum);
  velocity_from_momentum(scene);
  update_stress(scene, dt, false);
  Columns& columns = scene.particles.columns;
  for (int a = 0; a < Dim; ++a)
    std::ranges::copy(columns.values(next_position_, a), columns.data(scene.particles.position, a));
}

/// With APIC nobody asks for the nodes' change of velocity: momentum and impulse can share a lane. Not with linear
/// functions, where forces on nearly empty nodes must be told apart to be left out (ShapeKernels::negligible_weight).
template <int Dim>
ScatterWhat TotalStress<Dim>::momentum_with_force(const Scene<Dim>& scene) const {
  return scene.transfer.affine && scene.shape->degree() > 1 ? ScatterWhat::momentum_and_impulse
                                                            : ScatterWhat::momentum_and_force;
}

// ---- stages that belong to this module -----------------------------------------------------------------------------

template <int Dim>
void TotalStress<Dim>::gather_motion(Scene<Dim>& scene, double dt, ColumnId positions) {
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
void TotalStress<Dim>::gather_motion_and_update_stress(Scene<Dim>& scene, double dt) {
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
      if (!f_bar_) stress_[b] = materials_.update_stress(scene.particles, scene.blocks, block, strain);
    });
  }
  if (f_bar_) apply_f_bar(scene, false);
}

template <int Dim>
void TotalStress<Dim>::update_stress(Scene<Dim>& scene, double dt, bool then_scatter_force) {
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
      stress_[b] = materials_.update_stress(scene.particles, scene.blocks, block, strain);
      if (then_scatter_force)
        scene.shape->scatter(ScatterWhat::force, scene.scatter_input(block), 0, nullptr, scene.nodes.force_tile(b));
    });
  }
  if (f_bar_) apply_f_bar(scene, then_scatter_force);
}

/// F-bar on cells, eq. (26): the volumetric strain increment of each particle gives way to the mean of its cell.
template <int Dim>
void TotalStress<Dim>::apply_f_bar(Scene<Dim>& scene, bool then_scatter_force) {
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
    stress_[b] = materials_.update_stress(scene.particles, scene.blocks, block, strain);
    if (then_scatter_force)
      scene.shape->scatter(ScatterWhat::force, scene.scatter_input(block), 0, nullptr, scene.nodes.force_tile(b));
  });
}

/// The strain columns, from particle `first` on.
template <int Dim>
StrainIncrements<Dim> TotalStress<Dim>::kept_strain(Scene<Dim>& scene, std::uint32_t first) {
  Columns& columns = scene.particles.columns;
  StrainIncrements<Dim> strain;
  for (int c = 0; c < symmetric_components<Dim>; ++c) strain.strain[c] = columns.data(strain_increment_, c) + first;
  for (int c = 0; c < spin_components<Dim>; ++c) strain.rotation[c] = columns.data(spin_increment_, c) + first;
  return strain;
}

// ---- reports: written by block, summed in block order
// ----------------------------------------------------------------

template <int Dim>
void TotalStress<Dim>::begin_reports(const Scene<Dim>& scene) {
  motion_.assign(scene.blocks.particle_blocks().size(), {});
  stress_.assign(scene.blocks.particle_blocks().size(), {});
}

template <int Dim>
void TotalStress<Dim>::end_motion_reports(Scene<Dim>& scene) {
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
}

template <int Dim>
void TotalStress<Dim>::end_stress_reports(const Scene<Dim>& scene) {
  double fastest = 0;
  bool sound = true;
  for (const StressReport& r : stress_) {
    fastest = std::max(fastest, r.fastest_wave);
    sound = sound && r.sound;
  }
  fastest_wave_ = fastest;
  if (!sound || !scene.motion.finite) throw_first_bad_particle(scene);
}

// ---- reporting
// ---------------------------------------------------------------------------------------------------------

template <int Dim>
std::vector<std::pair<std::string, double>> TotalStress<Dim>::energies(const Scene<Dim>& scene) const {
  return {{"kinetic", kinetic_energy(scene)},
          {"elastic", materials_.stored_energy(scene.particles)},
          {"potential", potential_energy(scene)}};
}

template <int Dim>
std::vector<std::pair<std::string, Node>> TotalStress<Dim>::resolved_sections() const {
  return {{"materials", materials_.resolved()}, {"initial_stress", resolved(initial_stress_)}};
}

namespace {

const char* const summary =
    "Single-phase soil in total stresses, explicit in time: runout of dams and slopes, granular flow, undrained clay.";

template <int Dim>
bool register_module() {
  return physics_registry<Dim>().add("total_stress", {summary, {}},
                                     [](const Case& definition) -> std::unique_ptr<PhysicsModule<Dim>> {
                                       return std::make_unique<TotalStress<Dim>>(definition);
                                     });
}

const bool registered = register_module<2>() && register_module<3>();

}  // namespace

}  // namespace sluice
