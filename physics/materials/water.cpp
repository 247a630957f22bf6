/// Water, or another liquid: nothing but viscosity. Its pressure is the physics module's. docs/materials/water.md.
#include "core/case/schema.h"
#include "physics/materials/elastic_trial.h"
#include "physics/materials/viscous.h"

namespace sluice {

template <int Dim>
SLUICE_MULTITARGET void update_water(const MaterialBatch<Dim>& batch, double viscosity) {
  const auto update = [&](const Chunk<Dim, 0>& chunk) SLUICE_INLINE_LAMBDA {
    alignas(64) double stress[symmetric_components<Dim>][chunk_lanes];
    viscous_stress<Dim>(chunk, viscosity, batch.dt, stress);
    store_stress<Dim>(stress, chunk);
  };
  for_each_chunk<Dim, 0>(batch, update);
}

namespace {

class Water final : public Material {
 public:
  Water(double density, double viscosity) : density_(density), viscosity_(viscosity) {}

  double density() const override { return density_; }
  bool liquid() const override { return true; }
  Strength strength() const override { return Strength::constant; }
  double viscosity() const override { return viscosity_; }
  IsotropicElasticity elasticity() const override { return {}; }
  double stored_energy(std::span<const double>) const override { return 0; }
  void update(const MaterialBatch<2>& batch) const override { update_water<2>(batch, viscosity_); }
  void update(const MaterialBatch<3>& batch) const override { update_water<3>(batch, viscosity_); }

 private:
  double density_, viscosity_;
};

struct Parameters {
  double density = 0, viscosity = 0;
};

const auto schema =
    Schema<Parameters>("material water")
        .quantity("density", &Parameters::density, unit::density, above(0), "Mass per volume.", 1000.0)
        .quantity("viscosity", &Parameters::viscosity, unit::viscosity, at_least(0), "Dynamic viscosity.", 1e-3);

std::unique_ptr<Material> make(const Node& section) {
  const Parameters p = schema.read(section, {"model"});
  return std::make_unique<Water>(p.density, p.viscosity);
}

const bool registered = material_registry().add(
    "water",
    {"Water on its own, of constant volume, with viscosity; needs `physics: two_phase`, which solves its pressure.",
     [] { return schema.docs(); }},
    make);

}  // namespace
}  // namespace sluice
