#include "physics/materials/material.h"

namespace sluice {

IsotropicElasticity IsotropicElasticity::from_young(double youngs_modulus, double poisson_ratio) {
  return {.lambda = youngs_modulus * poisson_ratio / ((1 + poisson_ratio) * (1 - 2 * poisson_ratio)),
          .shear = youngs_modulus / (2 * (1 + poisson_ratio))};
}

double IsotropicElasticity::energy(std::span<const double> stress) const {
  const double mean = (stress[0] + stress[1] + stress[2]) / 3;
  double deviator = 0;  // s:s
  for (std::size_t k = 0; k < 3; ++k) deviator += (stress[k] - mean) * (stress[k] - mean);
  for (std::size_t k = 3; k < stress.size(); ++k) deviator += 2 * stress[k] * stress[k];
  const double bulk = lambda + 2 * shear / 3;
  return deviator / (4 * shear) + mean * mean / (2 * bulk);  // (LE.3)
}

ColumnSpec equivalent_plastic_strain() {
  return {.name = "equivalent_plastic_strain",
          .unit = "1",
          .sentence = "Accumulated equivalent plastic deviatoric strain, sum of sqrt(2/3 de_p:de_p)."};
}

Registry<MaterialFactory>& material_registry() {
  static Registry<MaterialFactory> registry("material", "materials");
  return registry;
}

std::unique_ptr<Material> make_material(const Node& section) {
  if (const Node* const model = section.find("model")) {
    return material_registry().find(model->scalar, model->place)(section);
  }
  std::string message = "missing key `model`; allowed:";
  for (const std::string& name : material_registry().names()) message += " " + name;
  std::vector<std::string> keys;
  for (const auto& [key, place] : section.keys) keys.push_back(key);
  const std::string near = nearest_word("model", keys);
  if (!near.empty()) message += "; did you mean `model` by `" + near + "`?";
  throw CaseError(section.place, message);
}

}  // namespace sluice
