#include "physics/total_stress/total_stress.h"

#include <fmt/format.h>

#include "core/case/problems.h"
#include "core/simulation/energy.h"
#include "core/simulation/time_step.h"

namespace sluice {

namespace {

const char* const refusal = "total_stress has neither water nor loads on surfaces; take `physics: two_phase`";

/// The case, if nothing in it asks for water. Throws CaseError.
const Case& without_water(const Case& definition) {
  Problems problems;
  for (const char* const key : {"water", "surface_loads"})
    if (const Node* const section = definition.source.find(key))
      problems.add(section->place, fmt::format("{}: the physics {}", key, refusal));
  for (const auto& [name, section] : definition.materials)
    if (const Node* const pores = section.find("water"))
      problems.add(pores->place, fmt::format("material '{}': water: the physics {}", name, refusal));
  problems.throw_if_any();
  return definition;
}

}  // namespace

template <int Dim>
TotalStress<Dim>::TotalStress(const Case& definition)
    : stress_(without_water(definition)), initial_stress_(read_initial_stress(definition.initial_stress)) {
  for (std::size_t m = 0; m < definition.materials.size(); ++m) {
    const auto& [name, section] = definition.materials[m];
    if (stress_.materials()[m].liquid())
      throw CaseError(section.find("model")->place, fmt::format("material '{}': the physics {}", name, refusal));
  }
}

template <int Dim>
void TotalStress<Dim>::declare(Particles& particles) {
  stress_.declare(particles.columns, particles.mass);
}

template <int Dim>
double TotalStress<Dim>::density(int material) const {
  return stress_.materials()[static_cast<std::size_t>(material)].density();
}

template <int Dim>
void TotalStress<Dim>::initialise(Scene<Dim>& scene) {
  apply_initial_stress(initial_stress_, scene, stress_.materials());
  stress_.initialise(scene);
}

template <int Dim>
std::vector<TimeStepLimit> TotalStress<Dim>::time_step_limits(const Scene<Dim>& scene) const {
  const auto& s = scene.scheme;
  return explicit_limits(scene, stress_.fastest_wave(), {s.courant, s.advection, s.strain_per_step});
}

template <int Dim>
std::vector<TimeStepLimit> TotalStress<Dim>::hard_limits(const Scene<Dim>& scene) const {
  return explicit_limits(scene, stress_.fastest_wave(), {1, 0.5, 0.5});
}

// ---- the step ----

template <int Dim>
void TotalStress<Dim>::step(Scene<Dim>& scene, double dt) {
  activate_blocks(scene);
  stress_.begin_step(scene);
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
  stress_.end_step(scene);
}

/// Update stress first: with the velocities that the particles brought along, over the interval just past.
template <int Dim>
void TotalStress<Dim>::step_usf(Scene<Dim>& scene, double dt) {
  Sweep<Dim> sweep(scene.blocks);
  sweep.over_particles([&](Items some) { scatter(scene, ScatterWhat::momentum, 0, some); });
  sweep.over_nodes([&](Items some) { velocity_from_momentum(scene, some); });
  stress_.update(sweep, scene, scene.previous_dt, [&](std::size_t b, const ParticleBlock<Dim>& block, Workspace<Dim>&) {
    scene.shape->scatter(ScatterWhat::force, scene.scatter_input(block), 0, nullptr, scene.nodes.force_tile(b));
  });
  sweep.over_nodes([&](Items some) { advance_nodes(scene, scene.kick(dt), false, true, some); });
  stress_.gather_motion(sweep, scene, dt);
  sweep.run();
}

/// Update stress last: with the new velocities of the nodes.
template <int Dim>
void TotalStress<Dim>::step_usl(Scene<Dim>& scene, double dt) {
  Sweep<Dim> sweep(scene.blocks);
  scatter_momentum_and_advance(sweep, scene, dt);
  stress_.gather_motion_and_update(sweep, scene, dt);
  sweep.run();
}

/// Modified update stress last: the new velocities of the particles are mapped to the nodes once more.
template <int Dim>
void TotalStress<Dim>::step_musl(Scene<Dim>& scene, double dt) {
  Sweep<Dim> sweep(scene.blocks);
  scatter_momentum_and_advance(sweep, scene, dt);
  stress_.gather_motion_and_map_again(sweep, scene, dt);
  sweep.run();
}

/// With APIC nobody asks for the nodes' change of velocity: momentum and impulse can share a lane. Not with linear
/// functions, where forces on nearly empty nodes must be told apart to be left out (ShapeKernels::negligible_weight).
template <int Dim>
void TotalStress<Dim>::scatter_momentum_and_advance(Sweep<Dim>& sweep, Scene<Dim>& scene, double dt) {
  const bool together = scene.transfer.affine && scene.shape->degree() > 1;
  const auto what = together ? ScatterWhat::momentum_and_impulse : ScatterWhat::momentum_and_force;
  const double kick = scene.kick(dt);
  sweep.over_particles([&scene, what, kick](Items some) { scatter(scene, what, kick, some); });
  sweep.over_nodes([&scene, together, kick](Items some) { advance_nodes(scene, kick, true, !together, some); });
}

// ---- reporting ----

template <int Dim>
std::vector<std::pair<std::string, double>> TotalStress<Dim>::energies(const Scene<Dim>& scene) const {
  return {{"kinetic", kinetic_energy(scene)},
          {"elastic", stress_.materials().stored_energy(scene.particles)},
          {"potential", potential_energy(scene)}};
}

template <int Dim>
std::vector<std::pair<std::string, Node>> TotalStress<Dim>::resolved_sections() const {
  return {{"materials", stress_.materials().resolved()}, {"initial_stress", resolved(initial_stress_)}};
}

namespace {

const char* const summary =
    "Single-phase soil in total stresses, explicit in time: runout of dams and slopes, granular flow, undrained clay.";

std::vector<FieldDoc> keys() { return {initial_stress_doc()}; }

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
