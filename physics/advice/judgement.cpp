#include "physics/advice/judgement.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/simulation/trial.h"
#include "physics/advice/conversion.h"

namespace sluice::advice {

namespace {

/// Seconds of a step over those of total_stress with the same particles: docs/performance.md.
constexpr std::array<double, 4> documented{1, 1, 3, 4.6};

constexpr std::size_t in_total_stress_drained = 0, in_total_stress_undrained = 1, u_p = 2, v_w_p = 3;

/// What a model gets wrong where water cannot leave at all is what it gets wrong where hardly any does.
ColumnErrors errors_of(exact::SaturatedSoil soil, double conductivity, double length, double height,
                       const Loading& loading) {
  soil.conductivity = conductivity;
  if (std::isfinite(length)) return column_errors(soil, length, loading);
  constexpr double hardly = 1e-12;
  soil.conductivity = hardly * soil.water_unit_weight() * loading.omega * height * height / soil.modulus;
  ColumnErrors found = column_errors(soil, height, loading);
  found.error[1] = {0, 0};
  return found;
}

/// The largest error of the model over soils and stages.
Demand demand_on(std::size_t model, const SceneNumbers& scene) {
  Demand most;
  for (const SoilNumbers& soil : scene.soils) {
    if (!soil.wet) continue;
    for (const Stage& stage : scene.stages)
      for (const double k : {soil.soil.conductivity, soil.least_conductivity}) {
        const ColumnErrors found = errors_of(soil.soil, k, soil.drainage_length, scene.height, stage.loading);
        if (!most.material.empty() && found.worst(model) <= most.error) continue;
        most = {found.worst(model), soil.name, stage.name, found, soil.drainage_length};
      }
  }
  return most;
}

/// The fastest wave that limits the step of a choice [m/s].
double fastest_wave(std::size_t choice, const SceneNumbers& scene) {
  double fastest = 0;
  for (const SoilNumbers& soil : scene.soils) {
    if (soil.liquid) continue;
    const double own = soil.elasticity.constrained_modulus();
    const double modulus = choice == in_total_stress_undrained && soil.wet ? soil.undrained_modulus : own;
    const double density = choice >= u_p ? soil.dry_density : soil.density;
    fastest = std::max(fastest, std::sqrt(modulus / density));
  }
  return fastest;
}

std::optional<std::size_t> choice_of(const Case& definition, const Judgement& judgement) {
  if (definition.physics == "two_phase") {
    if (judgement.scene.water.formulation == Formulation::explicit_) return std::nullopt;
    return judgement.scene.water.formulation == Formulation::u_p ? u_p : v_w_p;
  }
  if (definition.physics != "total_stress") return std::nullopt;
  const bool drained = judgement.choices[in_total_stress_drained].demand.error <
                       judgement.choices[in_total_stress_undrained].demand.error;
  return drained ? in_total_stress_drained : in_total_stress_undrained;
}

/// Loads that go to and fro build up pressure in soil with friction. The column, which is elastic, knows nothing of it.
std::string trouble_with_cycles(const SceneNumbers& scene) {
  const bool cyclic = std::ranges::any_of(scene.stages, [](const Stage& stage) { return stage.loading.duration == 0; });
  for (const SoilNumbers& soil : scene.soils)
    if (cyclic && soil.wet && soil.strength == Strength::frictional)
      return fmt::format("loads that go to and fro build up pressure in '{}', and total_stress does not know it",
                         soil.name);
  return "";
}

void find_troubles(Judgement& judgement, const Case& definition) {
  auto& choices = judgement.choices;
  choices[u_p].trouble = choices[v_w_p].trouble = trouble_with_water(definition);
  if (definition.physics == "total_stress") {
    // Total stresses are what the case makes of them: drained ones, or undrained ones.
    const std::size_t other =
        *judgement.own == in_total_stress_drained ? in_total_stress_undrained : in_total_stress_drained;
    choices[other].trouble = "the case has one stiffness and strength";
    choices[in_total_stress_undrained].trouble += trouble_with_cycles(judgement.scene);
    return;
  }
  choices[in_total_stress_drained].trouble = trouble_with_drained(definition, judgement.scene);
  choices[in_total_stress_undrained].trouble = trouble_with_undrained(definition, judgement.scene);
  for (const SoilNumbers& soil : judgement.scene.soils) {
    if (!soil.wet) continue;
    if (soil.soil.conductivity > coarsest_u_p) choices[u_p].trouble = "the soil is too coarse";
    if (soil.soil.conductivity != soil.least_conductivity)
      choices[v_w_p].trouble =
          fmt::format("the permeability of '{}' differs between axes, which u-p alone knows", soil.name);
  }
}

void take(Judgement& judgement) {
  auto& choices = judgement.choices;
  judgement.simplest = 0;
  while (judgement.simplest + 1 < choices.size() && !judgement.adequate(judgement.simplest)) ++judgement.simplest;
  std::optional<std::size_t> best;
  for (std::size_t c = 0; c < choices.size(); ++c)
    if (judgement.adequate(c) && choices[c].trouble.empty() && (!best || choices[c].cost() < choices[*best].cost()))
      best = c;
  judgement.taken = best.value_or(judgement.own.value_or(v_w_p));
}

}  // namespace

Judgement judge(const Case& definition) {
  Judgement judgement;
  judgement.scene = numbers_of(definition);
  const SceneNumbers& scene = judgement.scene;
  const std::pair<const char*, std::size_t> names[] = {
      {"drained total stress", 0}, {"undrained total stress", 1}, {"u-p", 3}, {"v-w-p", 4}};
  for (std::size_t c = 0; c < judgement.choices.size(); ++c) {
    Choice& choice = judgement.choices[c];
    choice.name = names[c].first;
    choice.model = names[c].second;
    choice.demand = demand_on(choice.model, scene);
    choice.seconds = documented[c];
    choice.steps = fastest_wave(c, scene);
  }
  if (scene.any_liquid())  // nothing but two_phase knows it
    for (const std::size_t c : {in_total_stress_drained, in_total_stress_undrained})
      judgement.choices[c].demand.error = std::max(judgement.choices[c].demand.error, 1.0);
  const double still = demand_on(2, scene).error;
  judgement.inertia_matters = still >= scene.asked.tolerance;
  judgement.own = choice_of(definition, judgement);
  find_troubles(judgement, definition);
  take(judgement);
  return judgement;
}

Case with_choice(const Case& definition, const SceneNumbers& scene, std::size_t choice) {
  if (choice < u_p) return in_total_stress(definition, scene, choice == in_total_stress_drained);
  return with_pore_water(definition, scene, choice == u_p ? "u-p" : "v-w-p");
}

void measure(Judgement& judgement, const Case& definition, const StepCost& own) {
  const SceneNumbers& scene = judgement.scene;
  const std::size_t here = judgement.own.value_or(v_w_p);
  // The explicit formulation is limited by the sound of the water.
  const bool sound = !judgement.own && definition.physics == "two_phase";
  const double wave = fastest_wave(sound ? in_total_stress_undrained : here, scene);
  double total_stress = 0;  // seconds of a step, once tried
  for (std::size_t c = 0; c < judgement.choices.size(); ++c) {
    Choice& choice = judgement.choices[c];
    const double own_wave = fastest_wave(c, scene);
    choice.dt = wave > 0 && own_wave > 0 ? own.dt * wave / own_wave : own.dt;
    if (definition.scheme.fixed_time_step && choice.dt > own.dt) choice.dt = own.dt;
    choice.steps = std::ceil(definition.end_time / choice.dt);
    choice.seconds = own.seconds * documented[c] / documented[here];
    const bool same = c == here || (c < u_p && here < u_p);
    if (same) choice.seconds = sound ? choice.seconds : own.seconds;
    if (same && !sound) continue;
    if (c < u_p && total_stress > 0) {
      choice.seconds = total_stress;
      continue;
    }
    try {
      const Case other = from_nothing(with_choice(definition, scene, c));
      const auto simulation = Simulation::create(other);
      choice.seconds = try_steps(other, *simulation, 0.1).seconds;
      if (c < u_p) total_stress = choice.seconds;
    } catch (const std::runtime_error&) {
      // It cannot be computed in that way; the ratio above stands.
    }
  }
}

std::string error_key(const std::string& model) {
  std::string key = "error_of_" + model;
  std::ranges::replace(key, ' ', '_');
  std::ranges::replace(key, '-', '_');
  return key;
}

Node record(const Judgement& judgement) {
  const Choice& taken = judgement.choices[judgement.taken];
  // What decides is where the model just simpler than full fails, if the full one is taken.
  const Demand& demand = taken.model == 4 ? judgement.choices[u_p].demand : taken.demand;
  Node map = Node::map();
  const auto number = [&](const char* key, double value) { map.set(key, value::from_quantity(value, unit::none)); };
  map.set("model", Node::text(taken.name));
  number("tolerance", judgement.scene.asked.tolerance);
  for (const Choice& choice : judgement.choices) {
    number(error_key(choice.name).c_str(), choice.demand.error);
  }
  if (demand.material.empty()) return map;
  map.set("material", Node::text(demand.material));
  map.set("loading", Node::text(demand.stage));
  number("drainage_length_m", demand.drainage_length);
  number("pi_1", demand.column.groups.pi_1());
  number("pi_2", demand.column.groups.pi_2());
  number("pi_3", demand.column.groups.pi_3());
  if (demand.column.time_factor > 0) number("time_factor", demand.column.time_factor);
  return map;
}

}  // namespace sluice::advice
