/// Von Mises: undrained clay with the same strength in all directions of shear. Equations VM.x:
/// docs/materials/von_mises.md.
#include <numbers>

#include "physics/materials/deviator.h"
#include "physics/materials/elastic_trial.h"
#include "physics/materials/undrained_strength.h"

namespace sluice {

/// Radial return to the strength at the end of the step, in closed form (VM.3).
template <bool Tied, int Dim>
SLUICE_MULTITARGET void update_von_mises(const MaterialBatch<Dim>& batch, const IsotropicElasticity& elasticity,
                                         const UndrainedStrength<Tied>& strength) {
  constexpr int states = UndrainedStrength<Tied>::states;
  constexpr double root3 = std::numbers::sqrt3;
  const double thrice_shear = 3 * elasticity.shear;
  const auto update = [&](const Chunk<Dim, states>& chunk) SLUICE_INLINE_LAMBDA {
    alignas(64) double stress[symmetric_components<Dim>][chunk_lanes];
    alignas(64) double mean[chunk_lanes], root_j2[chunk_lanes], keep[chunk_lanes];
    elastic_trial<Dim>(chunk, elasticity, stress);
    split<Dim>(stress, mean, root_j2);
    double* const strain = chunk.state[0];
    SLUICE_LANE_LOOP
    for (int i = 0; i < chunk_lanes; ++i) {
      const double q = root3 * root_j2[i];
      const double peak = root3 * strength.template peak<Dim>(chunk, i), drop = peak * (1 - strength.residual_share);
      const double residual = peak - drop, by_time = residual + strength.left_by_time * drop;
      const double slope = drop * strength.softening.inverse_strain();
      const double falling = peak - slope * strain[i];
      const double lower = falling < by_time ? falling : by_time;
      const double present = lower > residual ? lower : residual;

      // Plastic strain that leads to each branch of the strength; of a minimum of branches the largest counts, of a
      // maximum the least. Where the strength falls more steeply than elasticity unloads, it falls to the residual.
      const double to_residual = (q - residual) / thrice_shear, to_time = (q - by_time) / thrice_shear;
      const bool steep = slope >= thrice_shear;
      const double on_slope = (q - falling) / (steep ? thrice_shear : thrice_shear - slope);
      const double to_lower = on_slope > to_time ? on_slope : to_time;
      const double increment = steep | (to_residual < to_lower) ? to_residual : to_lower;

      const bool yields = q > present;
      keep[i] = yields ? 1 - thrice_shear * increment / q : 1;
      strain[i] += yields ? increment : 0;
    }
    join<Dim>(stress, keep, mean);
    store_stress<Dim>(stress, chunk);
  };
  for_each_chunk<Dim, states>(batch, update);
}

namespace {

class VonMises final : public UndrainedMaterial {
 public:
  using UndrainedMaterial::UndrainedMaterial;
  void update(const MaterialBatch<2>& batch) const override { update_any(batch); }
  void update(const MaterialBatch<3>& batch) const override { update_any(batch); }

 private:
  template <int Dim>
  void update_any(const MaterialBatch<Dim>& batch) const {
    with_strength(batch, [&](const auto& strength) { update_von_mises(batch, elasticity_, strength); });
  }
};

const auto schema = undrained_schema("von_mises");

const bool registered = material_registry().add(
    "von_mises",
    {"Linear elasticity with undrained strength after von Mises, constant or a share of the overburden, with "
     "sensitivity.",
     [] { return schema.docs(); }},
    [](const Node& section) { return std::make_unique<VonMises>(schema.read(section, {"model"}), section); });

}  // namespace
}  // namespace sluice
