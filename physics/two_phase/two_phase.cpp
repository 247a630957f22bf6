#include "physics/two_phase/two_phase.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/simulation/energy.h"

namespace sluice {

namespace {

template <int Dim>
std::vector<bool> liquids(const Materials<Dim>& materials) {
  std::vector<bool> liquid;
  for (std::size_t m = 0; m < materials.size(); ++m) liquid.push_back(materials[m].liquid());
  return liquid;
}

}  // namespace

template <int Dim>
TwoPhase<Dim>::TwoPhase(const Case& definition)
    : water_(read_water(definition)),
      initial_stress_(read_initial_stress(definition.initial_stress)),
      loads_(read_surface_loads(definition)),
      stress_(without_pores(definition)),
      pores_(water_, read_pore_spaces(definition, water_, liquids(stress_.materials())), stress_.materials()),
      at_obstacles_(definition, pores_),
      relative_(definition, water_, pores_),
      outside_(loads_, water_.ponds, -water_.density * definition.gravity.back(), grid_of<Dim>(definition.grid)),
      pressure_(water_, grid_of<Dim>(definition.grid), definition.gravity.back()) {
  check_changes(definition);
  if (definition.scheme.integration != "explicit")
    throw CaseError(
        definition.source.find("scheme")->find("integration")->place,
        fmt::format("scheme.integration: {} is for `physics: total_stress`; two_phase takes explicit steps of "
                    "the soil, with the pressure of the water implicit",
                    definition.scheme.integration));
  if (!definition.obstacles.empty() && water_.formulation == Formulation::explicit_)
    throw CaseError(definition.obstacles.front().place,
                    "obstacles: `formulation: explicit` does not know them, for its particles have no gradient of the "
                    "pressure that could stand at their surfaces; take `formulation: u-p` or `v-w-p`");
  check_contact(definition);
}

template <int Dim>
void TwoPhase<Dim>::check_contact(const Case& definition) const {
  ContactProblems problems(definition);
  if (water_.formulation != Formulation::u_p) problems.refuse("this `water.formulation`", "take u-p");
  if (!definition.obstacles.empty()) problems.refuse("`obstacles` where there is water", "take faces of the grid");
  if (outside_.any_ponds()) problems.refuse("`water.ponds`", "they would press into the joint between the bodies");
  for (const auto& [name, face] : definition.faces)
    if (face.absorbing) problems.refuse("`absorbing` of boundaries." + name + " where there is water", "take a roller");
  problems.throw_if_any();
}

/// Points that change keep their grains and their water: porosity follows from the density of the grains.
template <int Dim>
void TwoPhase<Dim>::check_changes(const Case& definition) const {
  const auto number = [&](const std::string& name) {
    return static_cast<std::size_t>(
        std::ranges::find(
            definition.materials, name, [](const auto& m) -> const auto& { return m.first; }) -
        definition.materials.begin());
  };
  for (const ChangeCase& change : definition.changes) {
    const std::size_t from = number(change.material), to = number(change.becomes);
    const PoreSpace &a = pores_.spaces()[from], &b = pores_.spaces()[to];
    if (a.liquid == b.liquid && a.saturated == b.saturated && a.porosity == b.porosity &&
        stress_.materials()[from].density() == stress_.materials()[to].density())
      continue;
    throw CaseError(change.place, fmt::format("changes: '{}' and '{}' must have the same density and porosity, or both "
                                              "be dry: the points keep their grains and their water",
                                              change.material, change.becomes));
  }
}

template <int Dim>
void TwoPhase<Dim>::declare(Particles& particles) {
  pores_.declare(particles, outside_.any());
  at_obstacles_.declare(particles);
  relative_.declare(particles, particles.columns.contains("affine_velocity"));
  stress_.declare(particles.columns, pores_.inertia());
}

template <int Dim>
double TwoPhase<Dim>::density(int material) const {
  return stress_.materials()[static_cast<std::size_t>(material)].density();
}

// ---- the start ----

template <int Dim>
void TwoPhase<Dim>::initialise(Scene<Dim>& scene) {
  pores_.fill(scene);
  pores_.set_initial_pressure(scene);
  if (water_.initial.method == InitialPressure::Method::steady_seepage) start_seepage(scene);
  activate_blocks(scene);
  SkeletonLoads<Dim> loads = pores_.skeleton_loads(scene, outside_, stress_.workspaces());
  at_obstacles_.add_at_rest(scene, outside_, stress_.workspaces(), loads);
  apply_initial_stress(initial_stress_, scene, stress_, loads);
  stress_.initialise(scene);
}

/// Steady seepage decides which part of the soil is wet, too.
template <int Dim>
void TwoPhase<Dim>::start_seepage(Scene<Dim>& scene) {
  if (pores_.any_liquid())
    throw CaseError("water.initial: steady_seepage does not know bodies of water; use ponds, or `method: hydrostatic`");
  activate_blocks(scene);
  pressure_.prepare(scene, pores_.wet_blocks(scene));
  pores_.collect_at_rest(scene, pressure_);
  discharge_ = pressure_.solve_steady(scene, outside_);
  for_each_block(scene, stress_.workspaces(), [&](std::size_t b, const auto& block, Workspace<Dim>&) {
    pores_.take_pressure(scene, b, block, pressure_);
  });
  pores_.dry_above_zero_pressure(scene);
}

// ---- the step ----

template <int Dim>
void TwoPhase<Dim>::step(Scene<Dim>& scene, double dt) {
  if (activate_blocks(scene) || !placed_) {
    pressure_.prepare(scene, pores_.wet_blocks(scene));
    if (water_.join_films) films_.find(scene);
  }
  placed_ = true;
  stress_.begin_step(scene);
  if (relative_.active()) relative_.begin_step(scene);
  at_obstacles_.begin_step(scene);
  begin_sums(scene);
  if (water_.formulation == Formulation::explicit_)
    step_explicit(scene, dt);
  else
    step_projected(scene, dt);
  end_sums(scene.kick(dt));
  stress_.end_step(scene);
}

template <int Dim>
void TwoPhase<Dim>::step_projected(Scene<Dim>& scene, double dt) {
  const double kick = scene.kick(dt);
  Sweep<Dim> to_nodes(scene.blocks);
  predict(to_nodes, scene, kick);
  to_nodes.run();
  join_films(scene);

  Sweep<Dim> to_vertices(scene.blocks);
  collect(to_vertices, scene, kick);
  to_vertices.run();
  pressure_.solve(scene, outside_, {dt, kick, scene.time + dt, water_.stabilisation, scene.step == 0});

  Sweep<Dim> correction(scene.blocks);
  correct(correction, scene, kick);
  correction.run();
  join_films(scene);

  Sweep<Dim> to_particles(scene.blocks);
  if (relative_.active()) relative_.advance(to_particles, scene, stress_.workspaces(), kick);
  gather(to_particles, scene, dt);
  to_particles.run();
}

/// Nothing is solved for: the pressure follows from how the water was compressed, and limits the step.
template <int Dim>
void TwoPhase<Dim>::step_explicit(Scene<Dim>& scene, double dt) {
  Sweep<Dim> sweep(scene.blocks);
  predict(sweep, scene, scene.kick(dt));
  relative_.advance(sweep, scene, stress_.workspaces(), scene.kick(dt));
  sweep.over_particles([&](Items some) { relative_.compress(scene, stress_.workspaces(), dt, some); });
  gather(sweep, scene, dt);
  sweep.run();
}

/// Velocities of the nodes under gravity, effective stress and the old pressure, eq. (41).
template <int Dim>
void TwoPhase<Dim>::predict(Sweep<Dim>& sweep, Scene<Dim>& scene, double kick) {
  const bool stress_first = stress_.timing() == StressTiming::usf;
  const auto forces = [this, &scene](std::size_t b, const auto& block, ScatterWhat what) {
    pores_.scatter_forces(scene, b, block, outside_, what);
    at_obstacles_.scatter(scene, b, block, water_.increment, outside_);
    pores_.pressed().start_work(scene, b, block);
  };
  sweep.over_particles([this, &scene, forces, stress_first](Items some) {
    const auto timing = scene.clock.time(Stage::scatter);
    const auto body = [&](std::size_t b, const auto& block, Workspace<Dim>&) {
      if (!stress_first) {
        forces(b, block, ScatterWhat::momentum_and_force);
        return;
      }
      scene.shape->scatter(ScatterWhat::momentum, scene.scatter_input(block), 0, scene.nodes.momentum_tile(b), nullptr);
      if (outside_.any()) pores_.pressed().take(scene, block, outside_);
      pores_.pressed().start_work(scene, b, block);
    };
    for_each_block(scene, stress_.workspaces(), body, some);
  });
  if (relative_.active()) sweep.over_particles([&](Items some) { relative_.scatter(scene, some); });
  if (scene.wants_area()) sweep.over_particles([&scene](Items some) { scatter_surface(scene, some); });
  if (stress_first) {
    sweep.over_nodes([&scene](Items some) { velocity_from_momentum(scene, Moment::before, some); });
    stress_.update(sweep, scene, scene.previous_dt, [=, this, &scene](std::size_t b, const auto& block, auto&) {
      pores_.pressed().add_work(scene, b, block);
      forces(b, block, ScatterWhat::force);
    });
  }
  sweep.over_nodes([this, &scene, kick, stress_first](Items some) {
    advance_nodes<Dim>(scene, kick, !stress_first, true, some, nullptr, at_obstacles_.nodes());
    if (relative_.active()) relative_.collect(scene, some);
    if (at_obstacles_.active()) at_obstacles_.part(scene, some);
  });
}

/// What the balance of volume needs of the particles, eq. (45).
template <int Dim>
void TwoPhase<Dim>::collect(Sweep<Dim>& sweep, Scene<Dim>& scene, double kick) {
  sweep.over_particles([this, &scene, kick](Items some) {
    const auto timing = scene.clock.time(Stage::pressure_assembly);
    const auto relative = relative_.velocity(scene.particles);
    const auto body = [&](std::size_t b, const auto& block, Workspace<Dim>& work) {
      if (!pressure_.is_wet(b)) return;
      pores_.take_prediction(scene, b, block, work);
      at_obstacles_.take_divergence(scene, b, block, work);
      dissipation_[b] = pores_.collect(scene, b, block, kick, relative, pressure_);
      at_obstacles_.add_flow(scene, b, block, pressure_.vertex_sums(b));
    };
    for_each_block(scene, stress_.workspaces(), body, some);
  });
}

/// The nodes take up the new pressure, eq. (49).
template <int Dim>
void TwoPhase<Dim>::correct(Sweep<Dim>& sweep, Scene<Dim>& scene, double kick) {
  const bool friction = scene.any_friction();
  if (friction) scene.resize(wall_);
  sweep.over_particles([this, &scene, friction](Items some) {
    const auto timing = scene.clock.time(Stage::scatter);
    const auto body = [&](std::size_t b, const auto& block, Workspace<Dim>&) {
      pores_.correct(scene, b, block, pressure_);
      at_obstacles_.scatter(scene, b, block, 1, outside_);
      if (friction) pores_.scatter_traction(scene, b, block, outside_, wall_);
    };
    for_each_block(scene, stress_.workspaces(), body, some);
  });
  sweep.over_nodes([this, &scene, kick, friction](Items some) {
    correct_nodes(scene, kick, friction ? &wall_ : nullptr, some, at_obstacles_.nodes());
  });
}

template <int Dim>
void TwoPhase<Dim>::join_films(Scene<Dim>& scene) {
  const auto timing = scene.clock.time(Stage::nodes);
  films_.join(scene);
}

/// Particles move and strain with the nodes; their pores follow.
template <int Dim>
void TwoPhase<Dim>::gather(Sweep<Dim>& sweep, Scene<Dim>& scene, double dt) {
  if (relative_.active()) relative_.gather(sweep, scene, stress_.workspaces(), dt);
  switch (stress_.timing()) {
    case StressTiming::usf:
      stress_.gather_motion(sweep, scene, dt);
      break;
    case StressTiming::usl:
      stress_.gather_motion_and_update(sweep, scene, dt);
      break;
    case StressTiming::musl:
      stress_.gather_motion_and_map_again(sweep, scene, dt);
      break;
  }
  sweep.over_particles([this, &scene](Items some) {
    const auto timing = scene.clock.time(Stage::gather);
    const auto body = [&](std::size_t b, const auto& block, Workspace<Dim>&) {
      pores_.pressed().add_work(scene, b, block);
      pores_.follow_volume(scene, block);
    };
    for_each_block(scene, stress_.workspaces(), body, some);
  });
}

// ---- energy: written by block, summed in block order ----

template <int Dim>
void TwoPhase<Dim>::begin_sums(const Scene<Dim>& scene) {
  dissipation_.assign(scene.blocks.particle_blocks().size(), 0);
  pores_.pressed().begin_step(scene);
}

template <int Dim>
void TwoPhase<Dim>::end_sums(double kick) {
  for (const double power : dissipation_) dissipated_ += kick * power;
  pores_.pressed().end_step();
}

// ---- limits ----

/// Those of the skeleton, whose waves the pressure does not see; and for surfaces of water, that of a fall by a cell.
template <int Dim>
std::vector<TimeStepLimit> TwoPhase<Dim>::limits(const Scene<Dim>& scene, const SafetyFactors& factors) const {
  const bool sound = water_.formulation == Formulation::explicit_;
  const double fastest = sound ? pores_.fastest_sound(scene.particles) : stress_.fastest_wave();
  std::vector<TimeStepLimit> all = explicit_limits(scene, fastest, factors);
  if (sound) all.front().name = "sound";
  double g = 0;
  for (const double component : scene.gravity) g = std::hypot(g, component);
  if (pores_.any_liquid()) {
    const double h = scene.grid.smallest_cell();
    if (g > 0) all.push_back({factors.courant * std::sqrt(h / g), "gravity"});
    all.push_back({factors.courant * h / pores_.fastest_under_pressure(scene.particles), "pressure"});
  }
  return all;
}

template <int Dim>
std::vector<TimeStepLimit> TwoPhase<Dim>::time_step_limits(const Scene<Dim>& scene) const {
  const auto& s = scene.scheme;
  return limits(scene, {s.courant, s.advection, s.strain_per_step});
}

template <int Dim>
std::vector<TimeStepLimit> TwoPhase<Dim>::hard_limits(const Scene<Dim>& scene) const {
  return limits(scene, {1, 0.5, 0.5});
}

// ---- reporting ----

template <int Dim>
void TwoPhase<Dim>::store(Archive& archive) const {
  archive.reals["two_phase"] = {stress_.fastest_wave(), dissipated_, discharge_, pores_.pressed().work()};
  pressure_.store(archive);
}

template <int Dim>
void TwoPhase<Dim>::restore(const Archive& archive) {
  const auto& own = archive.reals.at("two_phase");
  stress_.restore_fastest_wave(own.at(0));
  dissipated_ = own.at(1);
  discharge_ = own.at(2);
  pores_.pressed().restore_work(own.at(3));
  pressure_.restore(archive);
  placed_ = false;
}

template <int Dim>
std::vector<std::pair<std::string, double>> TwoPhase<Dim>::energies(const Scene<Dim>& scene) const {
  std::vector<std::pair<std::string, double>> all = {
      {"kinetic", kinetic_energy(scene) + relative_.kinetic_energy(scene.particles)},
      {"elastic", stress_.materials().stored_energy(scene.particles)},
      {"potential", potential_energy(scene)},
      {"water_compression", pores_.compression_energy(scene.particles)},
      {"seepage_dissipation", dissipated_}};
  if (outside_.any()) all.emplace_back("load_work", pores_.pressed().work());
  return all;
}

template <int Dim>
std::vector<std::pair<std::string, double>> TwoPhase<Dim>::step_numbers() const {
  return {{"pressure_unknowns", static_cast<double>(pressure_.unknowns())},
          {"pressure_iterations", pressure_.report().iterations},
          {"pressure_factorized", pressure_.report().factorized ? 1 : 0}};
}

template <int Dim>
std::vector<std::pair<std::string, double>> TwoPhase<Dim>::totals() const {
  const LaggedCholeskyStatistics& s = pressure_.statistics();
  return {{"pressure_analyses", s.analyses},
          {"pressure_factorizations", s.factorizations},
          {"pressure_solves", s.solves},
          {"pressure_iterations", s.iterations},
          {"pressure_factor_nonzeros", static_cast<double>(s.factor_nonzeros)},
          {"pressure_analyze_seconds", s.analyze_seconds},
          {"pressure_factorize_seconds", s.factorize_seconds},
          {"pressure_solve_seconds", s.solve_seconds},
          {"initial_discharge", discharge_}};
}

template <int Dim>
std::vector<std::pair<std::string, Node>> TwoPhase<Dim>::resolved_sections() const {
  Node materials = stress_.materials().resolved();
  for (std::size_t m = 0; m < materials.items.size(); ++m)
    if (const PoreSpace& space = pores_.spaces()[m]; space.saturated && !space.liquid)
      materials.items[m].set("water", resolved(space));
  return {{"materials", materials},
          {"initial_stress", resolved(initial_stress_)},
          {"surface_loads", resolved_surface_loads(loads_)},
          {"water", resolved(water_)}};
}

namespace {

const char* const summary =
    "Soil with water in its pores, and water beside it: effective stresses explicit in time, the pressure of the water "
    "by "
    "a semi-implicit projection. Consolidation, seepage, undrained failure and liquefaction.";

std::vector<FieldDoc> keys() {
  std::vector<FieldDoc> all{initial_stress_doc()};
  for (FieldDoc& doc : water_docs()) all.push_back(std::move(doc));
  return all;
}

const bool registered = physics_registry<2>().add("two_phase", {summary, keys}, [](const Case& definition) {
  return std::make_unique<TwoPhase<2>>(definition);
}) && physics_registry<3>().add("two_phase", {summary, keys}, [](const Case& definition) {
  return std::make_unique<TwoPhase<3>>(definition);
});

}  // namespace

template class TwoPhase<2>;
template class TwoPhase<3>;

}  // namespace sluice
