#include "physics/total_stress/total_stress.h"

#include <fmt/format.h>

#include <limits>

#include "core/case/problems.h"
#include "core/simulation/energy.h"
#include "core/simulation/time_step.h"

namespace sluice {

namespace {

const char* const refusal = "total_stress knows no water; take `physics: two_phase`";

/// The case, if nothing in it asks for water. Throws CaseError.
const Case& without_water(const Case& definition) {
  Problems problems;
  if (const Node* const section = definition.source.find("water"))
    problems.add(section->place, fmt::format("water: the physics {}; a reservoir without water in the pores is a level "
                                             "in `surface_loads`",
                                             refusal));
  for (const auto& [name, section] : definition.materials)
    if (const Node* const pores = section.find("water"))
      problems.add(pores->place, fmt::format("material '{}': water: the physics {}", name, refusal));
  problems.throw_if_any();
  return definition;
}

/// The case, if nothing in it is unknown here. Throws CaseError.
const Case& checked(const Case& definition) {
  without_water(definition);
  ContactProblems(definition).throw_if_any();
  return definition;
}

}  // namespace

template <int Dim>
TotalStress<Dim>::TotalStress(const Case& definition)
    : stress_(checked(definition)),
      implicit_(definition),
      initial_stress_(read_initial_stress(definition.initial_stress)),
      loads_(read_surface_loads(definition)),
      outside_(loads_, {}, 0, grid_of<Dim>(definition.grid)) {
  for (std::size_t m = 0; m < definition.materials.size(); ++m) {
    const auto& [name, section] = definition.materials[m];
    if (stress_.materials()[m].liquid())
      throw CaseError(section.find("model")->place, fmt::format("material '{}': the physics {}", name, refusal));
  }
}

template <int Dim>
void TotalStress<Dim>::declare(Particles& particles) {
  stress_.declare(particles.columns, particles.mass);
  implicit_.declare(particles.columns);
  if (!outside_.any()) return;
  pressed_.declare(particles);
  loaded_stress_ = particles.columns.declare(
      {"loaded_stress", "Pa", Dim, Role::derived, "Normal stresses with the pressure from outside.", false});
  no_stress_ = particles.columns.declare({"no_stress", "Pa", 1, Role::derived, "Zeros.", false});
}

template <int Dim>
double TotalStress<Dim>::density(int material) const {
  return stress_.materials()[static_cast<std::size_t>(material)].density();
}

template <int Dim>
void TotalStress<Dim>::initialise(Scene<Dim>& scene) {
  apply_initial_stress(initial_stress_, scene, stress_, loads_at_rest(scene));
  stress_.initialise(scene);
}

template <int Dim>
SkeletonLoads<Dim> TotalStress<Dim>::loads_at_rest(Scene<Dim>& scene) {
  if (!outside_.any()) return {};
  activate_blocks(scene);
  double* push = scene.particles.columns.data(loaded_stress_);
  std::fill_n(push, scene.particles.size(), 0.0);
  return pressed_.at_rest(scene, outside_, stress_.workspaces(), push);
}

template <int Dim>
std::vector<TimeStepLimit> TotalStress<Dim>::time_step_limits(const Scene<Dim>& scene) const {
  if (implicit_.active()) return hard_limits(scene);
  const auto& s = scene.scheme;
  return explicit_limits(scene, stress_.fastest_wave(), {s.courant, s.advection, s.strain_per_step});
}

template <int Dim>
std::vector<TimeStepLimit> TotalStress<Dim>::hard_limits(const Scene<Dim>& scene) const {
  if (implicit_.active()) return {{std::numeric_limits<double>::infinity(), "none"}};
  return explicit_limits(scene, stress_.fastest_wave(), {1, 0.5, 0.5});
}

// ---- the step ----

template <int Dim>
void TotalStress<Dim>::step(Scene<Dim>& scene, double dt) {
  activate_blocks(scene);
  pressed_.begin_step(scene);
  if (implicit_.active()) {
    step_implicit(scene, dt);
    return;
  }
  stress_.begin_step(scene);
  if (rough_under_load(scene)) scene.resize(wall_);
  switch (stress_.timing()) {
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
  pressed_.end_step();
  stress_.end_step(scene);
}

/// Update stress first: with the velocities that the particles brought along, over the interval just past.
template <int Dim>
void TotalStress<Dim>::step_usf(Scene<Dim>& scene, double dt) {
  Sweep<Dim> sweep(scene.blocks);
  sweep.over_particles([&](Items some) { scatter(scene, ScatterWhat::momentum, 0, some); });
  if (outside_.any())
    sweep.over_particles([&](Items some) {
      const auto body = [&](std::size_t b, const auto& block, Workspace<Dim>&) {
        pressed_.take(scene, block, outside_);
        pressed_.start_work(scene, b, block);
      };
      for_each_block(scene, stress_.workspaces(), body, some);
    });
  sweep.over_nodes([&](Items some) { velocity_from_momentum(scene, Moment::before, some); });
  stress_.update(sweep, scene, scene.previous_dt, [&](std::size_t b, const auto& block, Workspace<Dim>&) {
    pressed_.add_work(scene, b, block);  // that of the volumes
    scatter_forces(scene, b, block, ScatterWhat::force);
  });
  if (scene.wants_area()) sweep.over_particles([&](Items some) { scatter_surface(scene, some); });
  sweep.over_nodes([&](Items some) { advance_nodes(scene, scene.kick(dt), false, true, some, loads_alone(scene)); });
  stress_.gather_motion(sweep, scene, dt);
  add_load_work(sweep, scene);
  sweep.run();
}

/// Update stress last: with the new velocities of the nodes.
template <int Dim>
void TotalStress<Dim>::step_usl(Scene<Dim>& scene, double dt) {
  Sweep<Dim> sweep(scene.blocks);
  scatter_momentum_and_advance(sweep, scene, dt);
  stress_.gather_motion_and_update(sweep, scene, dt);
  add_load_work(sweep, scene);
  sweep.run();
}

/// Modified update stress last: the new velocities of the particles are mapped to the nodes once more.
template <int Dim>
void TotalStress<Dim>::step_musl(Scene<Dim>& scene, double dt) {
  Sweep<Dim> sweep(scene.blocks);
  scatter_momentum_and_advance(sweep, scene, dt);
  stress_.gather_motion_and_map_again(sweep, scene, dt);
  add_load_work(sweep, scene);
  sweep.run();
}

/// Displacements from the balance of forces at the end. The loads act on the surface as it is at the beginning.
template <int Dim>
void TotalStress<Dim>::step_implicit(Scene<Dim>& scene, double dt) {
  const double now = scene.time;
  scene.time = now + implicit_.load_time() * dt;
  const SkeletonLoads<Dim> loads = loads_at_rest(scene);
  scene.time = now;
  for_each_block(scene, stress_.workspaces(),
                 [&](std::size_t b, const auto& block, Workspace<Dim>&) { pressed_.start_work(scene, b, block); });
  implicit_.advance(scene, stress_, loads, dt);
  for_each_block(scene, stress_.workspaces(),
                 [&](std::size_t b, const auto& block, Workspace<Dim>&) { pressed_.add_work(scene, b, block); });
  pressed_.end_step();
}

/// With APIC nobody but dashpots asks for the nodes' change of velocity: momentum and impulse can share a lane. Not
/// with linear functions, where forces on nearly empty nodes must be told apart to be left out (ShapeKernels::smooth).
template <int Dim>
void TotalStress<Dim>::scatter_momentum_and_advance(Sweep<Dim>& sweep, Scene<Dim>& scene, double dt) {
  const double kick = scene.kick(dt);
  if (scene.wants_area()) sweep.over_particles([&scene](Items some) { scatter_surface(scene, some); });
  if (outside_.any()) {
    sweep.over_particles([this, &scene](Items some) {
      const auto timing = scene.clock.time(Stage::scatter);
      const auto body = [&](std::size_t b, const auto& block, Workspace<Dim>&) {
        scatter_forces(scene, b, block, ScatterWhat::momentum_and_force);
      };
      for_each_block(scene, stress_.workspaces(), body, some);
    });
    sweep.over_nodes(
        [this, &scene, kick](Items some) { advance_nodes(scene, kick, true, true, some, loads_alone(scene)); });
    return;
  }
  const bool together = scene.transfer.affine && scene.shape->smooth() && !scene.dashpots.any();
  const auto what = together ? ScatterWhat::momentum_and_impulse : ScatterWhat::momentum_and_force;
  sweep.over_particles([&scene, what, kick](Items some) { scatter(scene, what, kick, some); });
  sweep.over_nodes([&scene, together, kick](Items some) { advance_nodes(scene, kick, true, !together, some); });
}

/// Forces of stresses and loads, eq. (34), and momentum if `what` says so. The work of loads counts from here.
template <int Dim>
void TotalStress<Dim>::scatter_forces(Scene<Dim>& scene, std::size_t b, const ParticleBlock<Dim>& block,
                                      ScatterWhat what) {
  if (!outside_.any()) {
    scatter_block(scene, what, 0, b, scene.scatter_input(block));
    return;
  }
  ScatterInput<Dim> in = scene.scatter_input(block);
  Columns& columns = scene.particles.columns;
  pressed_.take(scene, block, outside_);
  const double* here = pressed_.pressure(scene.particles);
  for (int a = 0; a < Dim; ++a) {
    const double* own = in.stress[a];
    double* loaded = columns.data(loaded_stress_, a);
    for (std::uint32_t p = block.begin; p < block.end; ++p) loaded[p] = own[p] + here[p];
    in.stress[a] = loaded;
  }
  pressed_.scatter(scene, b, in, what, scene.nodes);
  if (rough_under_load(scene)) {
    in.stress.fill(columns.data(no_stress_));
    for (int a = 0; a < Dim; ++a) in.stress[a] = here;
    pressed_.scatter(scene, b, in, ScatterWhat::force, wall_.front());
  }
  pressed_.start_work(scene, b, block);
}

template <int Dim>
void TotalStress<Dim>::add_load_work(Sweep<Dim>& sweep, Scene<Dim>& scene) {
  if (!outside_.any()) return;
  sweep.over_particles([this, &scene](Items some) {
    const auto body = [&](std::size_t b, const auto& block, Workspace<Dim>&) { pressed_.add_work(scene, b, block); };
    for_each_block(scene, stress_.workspaces(), body, some);
  });
}

// ---- reporting ----

template <int Dim>
std::vector<std::pair<std::string, double>> TotalStress<Dim>::energies(const Scene<Dim>& scene) const {
  std::vector<std::pair<std::string, double>> all = {{"kinetic", kinetic_energy(scene)},
                                                     {"elastic", stress_.materials().stored_energy(scene.particles)},
                                                     {"potential", potential_energy(scene)}};
  if (outside_.any()) all.emplace_back("load_work", pressed_.work());
  return all;
}

template <int Dim>
std::vector<std::pair<std::string, double>> TotalStress<Dim>::step_numbers() const {
  if (!implicit_.active()) return {};
  return implicit_.numbers();
}

template <int Dim>
std::vector<std::pair<std::string, Node>> TotalStress<Dim>::resolved_sections() const {
  return {{"materials", stress_.materials().resolved()},
          {"initial_stress", resolved(initial_stress_)},
          {"surface_loads", resolved_surface_loads(loads_)}};
}

namespace {

const char* const summary =
    "Single-phase soil in total stresses, explicit in time or implicit: runout of dams and slopes, granular flow, "
    "undrained clay.";

std::vector<FieldDoc> keys() { return {initial_stress_doc(), surface_loads_doc()}; }

template <int Dim>
bool register_module() {
  return physics_registry<Dim>().add("total_stress", {summary, keys},
                                     [](const Case& definition) -> std::unique_ptr<PhysicsModule<Dim>> {
                                       return std::make_unique<TotalStress<Dim>>(definition);
                                     });
}

const bool registered = register_module<2>() && register_module<3>();

}  // namespace

}  // namespace sluice
