/// Scenes with water for the failure atlas, and what is asked of them.
#pragma once

#include <map>

#include "tests/verification/scene_fixture.h"

namespace sluice {

/// A case of two_phase from a grid, bodies and more sections, each a line or several; materials are `soil`, saturated,
/// `dry`, the same without water, and `sea`, water.
inline std::string water_scene(const std::string& grid, const std::string& bodies, const std::string& more) {
  return "schema: 1\nphysics: two_phase\nend_time: 1000 s\ngrid: " + grid +
         "\nmaterials:\n"
         "  soil: {model: linear_elastic, density: 1600 kg/m3, youngs_modulus: 1 MPa, poisson_ratio: 0.3,\n"
         "         water: {porosity: 0.4, permeability: 1e-4 m/s}}\n"
         "  dry: {model: linear_elastic, density: 1600 kg/m3, youngs_modulus: 1 MPa, poisson_ratio: 0.3}\n"
         "  sea: {model: water}\n"
         "bodies:\n" +
         bodies + "\n" + more + "\n";
}

inline std::unique_ptr<Simulation> simulate_text(const std::string& text) {
  return Simulation::create(parse_case(text, "scene.yaml"));
}

inline double step_number(const Simulation& simulation, const std::string& name) {
  for (const auto& [key, value] : simulation.step_numbers())
    if (key == name) return value;
  ADD_FAILURE() << "no number is called " << name;
  return NAN;
}

inline double total(const Simulation& simulation, const std::string& name) {
  for (const auto& [key, value] : simulation.totals())
    if (key == name) return value;
  ADD_FAILURE() << "no total is called " << name;
  return NAN;
}

}  // namespace sluice
