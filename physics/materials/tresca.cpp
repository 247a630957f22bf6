/// Tresca: undrained clay whose largest shear stress is its strength: Mohr-Coulomb without friction. Equations TR.x:
/// docs/materials/tresca.md.
#include <numbers>

#include "physics/materials/mohr_coulomb_batch.h"
#include "physics/materials/undrained_strength.h"

namespace sluice {

namespace mohr_coulomb {

/// Undrained strength as the return map of Mohr-Coulomb wants it.
template <bool Tied>
struct Undrained {
  static constexpr int states = UndrainedStrength<Tied>::states;
  IsotropicElasticity elasticity;
  UndrainedStrength<Tied> undrained;
  double cutoff;

  double tension_cutoff() const { return cutoff; }
  template <int Dim>
  SLUICE_ALWAYS_INLINE MohrCoulombStrength strength(const Chunk<Dim, states>& chunk, int lane) const {
    return {0, 2 * undrained.template present<Dim>(chunk, lane), 0};
  }
  template <int Dim>
  SLUICE_ALWAYS_INLINE MohrCoulombReturn at(const Chunk<Dim, states>& chunk, int lane) const {
    return MohrCoulombReturn(elasticity, strength<Dim>(chunk, lane), cutoff);
  }
};

}  // namespace mohr_coulomb

template <bool Cutoff, int Dim, bool Tied>
SLUICE_MULTITARGET void update_tresca(const MaterialBatch<Dim>& batch, const IsotropicElasticity& elasticity,
                                      const UndrainedStrength<Tied>& strength, double cutoff) {
  const double strain_factor = std::numbers::sqrt2 / (6 * elasticity.shear);  // (MC.17)
  mohr_coulomb::update<Cutoff>(batch, elasticity, mohr_coulomb::Undrained<Tied>{elasticity, strength, cutoff},
                               strain_factor);
}

namespace {

class Tresca final : public UndrainedMaterial {
 public:
  using UndrainedMaterial::UndrainedMaterial;
  void update(const MaterialBatch<2>& batch) const override { update_any(batch); }
  void update(const MaterialBatch<3>& batch) const override { update_any(batch); }

 private:
  template <int Dim>
  void update_any(const MaterialBatch<Dim>& batch) const {
    with_strength(batch, [&](const auto& strength) {
      if (keys_.tension_cutoff)
        update_tresca<true>(batch, elasticity_, strength, *keys_.tension_cutoff);
      else
        update_tresca<false>(batch, elasticity_, strength, std::numeric_limits<double>::infinity());
    });
  }
};

const auto schema = undrained_schema("tresca").quantity("tension_cutoff", &UndrainedKeys::tension_cutoff, unit::stress,
                                                        at_least(0), "Limit of the largest principal stress.");

const bool registered = material_registry().add(
    "tresca",
    {"Linear elasticity with undrained strength after Tresca, constant or a share of the overburden, with sensitivity "
     "and tension cut-off.",
     [] { return schema.docs(); }},
    [](const Node& section) { return std::make_unique<Tresca>(schema.read(section, {"model"}), section); });

}  // namespace
}  // namespace sluice
