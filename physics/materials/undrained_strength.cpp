#include "physics/materials/undrained_strength.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace sluice {

Schema<UndrainedKeys> undrained_schema(const std::string& name) {
  using K = UndrainedKeys;
  const auto softening =
      softening_schema<SensitivityKeys>("softening")
          .quantity("sensitivity", &SensitivityKeys::sensitivity, unit::none, above(1), "Peak over residual strength.");
  return Schema<K>("material " + name)
      .quantity("density", &K::density, unit::density, above(0), "Initial mass per volume.")
      .quantity("youngs_modulus", &K::youngs_modulus, unit::stress, above(0), "Young's modulus.")
      .quantity("poisson_ratio", &K::poisson_ratio, unit::none, within(-1, 0.5), "Poisson's ratio.", 0.3)
      .quantity("strength", &K::strength, unit::stress, above(0), "Undrained strength in simple shear.",
                {"from strength_ratio"})
      .quantity("strength_ratio", &K::strength_ratio, unit::none, above(0),
                "Undrained strength over the vertical compression (effective with two_phase) that a point has when it "
                "becomes this material.",
                {"from strength"})
      .quantity("minimum_strength", &K::minimum_strength, unit::stress, above(0),
                "Least strength where it is a ratio; needed with it.", {"none"})
      .section("softening", &K::softening, softening,
               "How the strength falls from the peak, which the keys above give, to the residual value.",
               {"none: perfectly plastic"});
}

UndrainedMaterial::UndrainedMaterial(const UndrainedKeys& keys, const Node& section)
    : keys_(keys), elasticity_(IsotropicElasticity::from_young(keys.youngs_modulus, keys.poisson_ratio)) {
  if (keys.strength.has_value() == keys.strength_ratio.has_value())
    throw CaseError(section.place, fmt::format("{} of `strength` and `strength_ratio` {} given; one of them must be",
                                               keys.strength ? "both" : "none", keys.strength ? "are" : "is"));
  if (keys.strength_ratio && !keys.minimum_strength)
    throw CaseError(section.find("strength_ratio")->place,
                    "strength_ratio: needs `minimum_strength`, for at the surface there is no overburden and would be "
                    "no strength");
  if (keys.strength && keys.minimum_strength)
    throw CaseError(section.find("minimum_strength")->place, "minimum_strength: is for `strength_ratio` only");
  if (keys.softening) {
    check_softening(*keys.softening);
    residual_share_ = 1 / keys.softening->sensitivity;
    softening_ = Softening(*keys.softening);
  }
}

std::vector<ColumnSpec> UndrainedMaterial::columns() const {
  std::vector<ColumnSpec> all = {equivalent_plastic_strain()};
  if (tied())
    all.push_back({.name = "initial_vertical_stress",
                   .unit = "Pa",
                   .sentence = "Vertical compression when the point became a material whose strength is a share of it; "
                               "0 until its first step."});
  return all;
}

void UndrainedMaterial::set_cell_size(double h) {
  softening_.set_cell_size(h);
  if (!keys_.softening || !keys_.softening->reference_width || !keys_.strength) return;
  const double drop = std::numbers::sqrt3 * *keys_.strength * (1 - residual_share_);
  const double largest = 3 * elasticity_.shear / (drop * softening_.inverse_strain()) * h;
  if (largest > h) return;
  throw CaseError(
      keys_.softening->place,
      fmt::format("softening: in cells of {:g} m the strength would fall more steeply than elasticity "
                  "unloads; the cells must be smaller than {:.3g} m, or `strain` x `reference_width` larger",
                  h, largest));
}

template <int Dim>
void UndrainedMaterial::remember_overburden(const MaterialBatch<Dim>& batch) {
  const double* const vertical = batch.stress[Dim - 1];
  double* const overburden = batch.state[1];
  constexpr double least = std::numeric_limits<double>::min();  // not 0, which means that nothing is known yet
  for (std::size_t p = 0; p < batch.size; ++p)
    if (overburden[p] == 0) overburden[p] = -vertical[p] > least ? -vertical[p] : least;
}

template void UndrainedMaterial::remember_overburden<2>(const MaterialBatch<2>&);
template void UndrainedMaterial::remember_overburden<3>(const MaterialBatch<3>&);

}  // namespace sluice
