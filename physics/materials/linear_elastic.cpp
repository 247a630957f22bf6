#include "physics/materials/linear_elastic.h"

#include "core/case/schema.h"
#include "physics/materials/elastic_trial.h"

namespace sluice {

// A template with external linkage: GCC dispatches clones only of functions that the linker can see.
template <int Dim>
SLUICE_MULTITARGET void update_linear_elastic(const MaterialBatch<Dim>& batch, const IsotropicElasticity& elasticity) {
  const auto update = [&](const Chunk<Dim, 0>& chunk) SLUICE_INLINE_LAMBDA {
    alignas(64) double stress[symmetric_components<Dim>][chunk_lanes];
    elastic_trial<Dim>(chunk, elasticity, stress);
    store_stress<Dim>(stress, chunk);
  };
  for_each_chunk<Dim, 0>(batch, update);
}

void LinearElastic::update(const MaterialBatch<2>& batch) const { update_linear_elastic<2>(batch, elasticity_); }
void LinearElastic::update(const MaterialBatch<3>& batch) const { update_linear_elastic<3>(batch, elasticity_); }

namespace {

struct Parameters {
  double density = 0;
  double youngs_modulus = 0;
  double poisson_ratio = 0;
};

const auto schema =
    Schema<Parameters>("material linear_elastic")
        .quantity("density", &Parameters::density, unit::density, above(0), "Initial mass per volume.")
        .quantity("youngs_modulus", &Parameters::youngs_modulus, unit::stress, above(0), "Young's modulus.")
        .quantity("poisson_ratio", &Parameters::poisson_ratio, unit::none, within(-1, 0.5), "Poisson's ratio.", 0.3);

std::unique_ptr<Material> make(const Node& section) {
  const Parameters p = schema.read(section, {"model"});
  return std::make_unique<LinearElastic>(p.density, IsotropicElasticity::from_young(p.youngs_modulus, p.poisson_ratio));
}

const bool registered = material_registry().add(
    "linear_elastic", {"Isotropic linear elasticity in rate form.", [] { return schema.docs(); }}, make);

}  // namespace
}  // namespace sluice
