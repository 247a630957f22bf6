/// A weakly compressible liquid with viscosity. Equations NF.x: docs/materials/newtonian.md.
#include <limits>
#include <optional>

#include "core/case/schema.h"
#include "physics/materials/elastic_trial.h"
#include "physics/materials/viscous.h"

namespace sluice {

template <int Dim>
SLUICE_MULTITARGET void update_newtonian(const MaterialBatch<Dim>& batch, double bulk_modulus, double viscosity,
                                         double cutoff) {
  const auto update = [&](const Chunk<Dim, 0>& chunk) SLUICE_INLINE_LAMBDA {
    alignas(64) double stress[symmetric_components<Dim>][chunk_lanes], mean[chunk_lanes];
    viscous_stress<Dim>(chunk, viscosity, batch.dt, stress);
    compress<Dim>(chunk, bulk_modulus, cutoff, mean);
    add_mean<Dim>(mean, stress);
    store_stress<Dim>(stress, chunk);
  };
  for_each_chunk<Dim, 0>(batch, update);
}

namespace {

struct Parameters {
  double density = 0, bulk_modulus = 0, viscosity = 0;
  std::optional<double> tension_cutoff;
};

class Newtonian final : public Material {
 public:
  explicit Newtonian(const Parameters& p)
      : p_(p), cutoff_(p.tension_cutoff.value_or(std::numeric_limits<double>::infinity())) {}

  double density() const override { return p_.density; }
  Strength strength() const override { return Strength::constant; }
  double viscosity() const override { return p_.viscosity; }
  IsotropicElasticity elasticity() const override { return {.lambda = p_.bulk_modulus, .shear = 0}; }
  double stored_energy(std::span<const double> stress) const override {
    const double mean = (stress[0] + stress[1] + stress[2]) / 3;
    return mean * mean / (2 * p_.bulk_modulus);
  }
  void update(const MaterialBatch<2>& batch) const override {
    update_newtonian<2>(batch, p_.bulk_modulus, p_.viscosity, cutoff_);
  }
  void update(const MaterialBatch<3>& batch) const override {
    update_newtonian<3>(batch, p_.bulk_modulus, p_.viscosity, cutoff_);
  }

 private:
  Parameters p_;
  double cutoff_;
};

const auto schema =
    Schema<Parameters>("material newtonian")
        .quantity("density", &Parameters::density, unit::density, above(0), "Initial mass per volume.", 1000.0)
        .quantity("bulk_modulus", &Parameters::bulk_modulus, unit::stress, above(0),
                  "Bulk modulus; some hundred times density x speed^2 keeps changes of volume below one per cent.")
        .quantity("viscosity", &Parameters::viscosity, unit::viscosity, at_least(0), "Dynamic viscosity.")
        .quantity("tension_cutoff", &Parameters::tension_cutoff, unit::stress, at_least(0),
                  "Limit of the mean stress; 0 for a liquid that tears.");

const bool registered = material_registry().add(
    "newtonian", {"Weakly compressible liquid with viscosity, explicit in time.", [] { return schema.docs(); }},
    [](const Node& section) { return std::make_unique<Newtonian>(schema.read(section, {"model"})); });

}  // namespace
}  // namespace sluice
