#include "physics/advice/conversion.h"

#include <fmt/format.h>

#include <algorithm>

namespace sluice::advice {

namespace {

const Node& section_of(const Case& definition, const std::string& name) {
  return std::ranges::find(definition.materials, name, [](const auto& m) -> const std::string& { return m.first; })
      ->second;
}

bool weighs(const Case& definition) {
  return std::ranges::any_of(definition.gravity, [](double g) { return g != 0; });
}

bool starts_with_pressure(const SceneNumbers& scene) {
  return scene.water.initial.method != InitialPressure::Method::none;
}

/// What neither model in total stresses can do.
std::string trouble_with_total_stress(const SceneNumbers& scene) {
  if (scene.any_liquid()) return "there is free water";
  if (!scene.water.table.empty()) return "the water table leaves a part of the soil dry";
  return "";
}

void set_quantity(Node& section, const std::string& key, double number, const Unit& unit) {
  section.set(key, value::from_quantity(number, unit));
}

/// With the stiffness of the water that cannot leave: the shear modulus stays.
void stiffen(Node& section, const SoilNumbers& soil) {
  IsotropicElasticity undrained = soil.elasticity;
  undrained.lambda += soil.soil.water_bulk_modulus / soil.soil.porosity;
  set_quantity(section, "youngs_modulus", undrained.youngs_modulus(), unit::stress);
  set_quantity(section, "poisson_ratio", undrained.poisson_ratio(), unit::none);
}

}  // namespace

std::string trouble_with_drained(const Case& definition, const SceneNumbers& scene) {
  const std::string trouble = trouble_with_total_stress(scene);
  if (!trouble.empty() || !scene.any_wet()) return trouble;
  bool driven = starts_with_pressure(scene) || !scene.water.ponds.empty() || weighs(definition);
  for (const auto& [name, face] : scene.water.faces)
    driven = driven || face.head || face.flux ||
             (face.pressure && std::ranges::any_of(face.pressure->value, [](double p) { return p != 0; }));
  return driven ? "its water has a pressure even where nothing loads it, which total_stress does not know" : "";
}

std::string trouble_with_undrained(const Case& definition, const SceneNumbers& scene) {
  const std::string trouble = trouble_with_total_stress(scene);
  if (!trouble.empty()) return trouble;
  for (const SoilNumbers& soil : scene.soils) {
    if (!soil.wet || soil.has_undrained) continue;
    if (soil.strength == Strength::frictional)
      return fmt::format("the strength of '{}' follows the effective stress; total_stress needs an undrained one",
                         soil.name);
    if (section_of(definition, soil.name).find("youngs_modulus") == nullptr)
      return fmt::format("the stiffness of '{}' in total stresses is not known", soil.name);
    if (!scene.water.bulk_modulus) return "water has no bulk_modulus, and total_stress needs one";
  }
  for (const auto& [name, face] : scene.water.faces)
    if (face.flux) return fmt::format("water is pumped through the face {}", name);
  const Node* const method = definition.initial_stress.find("method");
  if (starts_with_pressure(scene) && (method == nullptr || method->scalar == "none"))
    return "it starts with a pore pressure that nothing balances but the loads";
  return "";
}

std::string trouble_with_water(const Case& definition) {
  for (const auto& [name, face] : definition.faces)
    if (face.absorbing) return "its faces absorb the waves of soil without pore water";
  if (definition.scheme.integration != "explicit") return "two_phase takes explicit steps";
  return "";
}

Case in_total_stress(const Case& definition, const SceneNumbers& scene, bool drained) {
  Case converted = definition;
  converted.physics = "total_stress";
  for (auto& [name, section] : converted.materials) {
    const Node undrained = section.find(undrained_key) ? *section.find(undrained_key) : Node{};
    const auto soil = std::ranges::find(scene.soils, name, &SoilNumbers::name);
    section.erase("water");
    section.erase(undrained_key);
    if (soil == scene.soils.end() || !soil->wet) continue;
    if (!drained && undrained) {
      section = undrained;
      continue;
    }
    set_quantity(section, "density", soil->density, unit::density);
    if (!drained) stiffen(section, *soil);
  }
  if (const Node* const ponds = definition.water.find("ponds")) {
    if (!converted.surface_loads) converted.surface_loads = Node::list();
    for (Node load : ponds->items) {
      set_quantity(load, "density", scene.water.density, unit::density);
      converted.surface_loads.items.push_back(load);
    }
  }
  converted.water = {};
  converted.source.erase("water");
  return converted;
}

Case with_pore_water(const Case& definition, const SceneNumbers& scene, const std::string& formulation) {
  Case converted = definition;
  converted.physics = "two_phase";
  if (!converted.water) converted.water = Node::map();
  converted.water.set("formulation", Node::text(formulation));
  for (auto& [name, section] : converted.materials) {
    section.erase(undrained_key);
    const auto soil = std::ranges::find(scene.soils, name, &SoilNumbers::name);
    if (soil == scene.soils.end() || !soil->wet || section.find("water")) continue;
    Node pores = Node::map();
    set_quantity(pores, "porosity", soil->soil.porosity, unit::none);
    set_quantity(pores, "permeability", soil->soil.conductivity, unit::velocity);
    section.set("water", pores);
    set_quantity(section, "density", soil->dry_density, unit::density);
  }
  return converted;
}

Case from_nothing(Case definition) {
  definition.initial_stress = {};
  if (definition.water) definition.water.erase("initial");
  return definition;
}

}  // namespace sluice::advice
