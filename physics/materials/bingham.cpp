/// Bingham: mud, paste or debris that rests below a yield stress and flows with a viscosity above it. Equations BH.x:
/// docs/materials/bingham.md.
#include <limits>
#include <numbers>
#include <optional>

#include "core/case/schema.h"
#include "physics/materials/deviator.h"
#include "physics/materials/elastic_trial.h"
#include "physics/materials/viscous.h"

namespace sluice {

/// `cutoff` may be infinite.
struct BinghamParameters {
  double shear_modulus, bulk_modulus, yield_stress, viscosity, cutoff;
};

/// The implicit step of the excess over the yield stress, in closed form (BH.4).
template <int Dim>
SLUICE_MULTITARGET void update_bingham(const MaterialBatch<Dim>& batch, const BinghamParameters& p) {
  const double stiffness = p.shear_modulus * batch.dt;
  const double kept = batch.dt > 0 ? p.viscosity / (p.viscosity + stiffness) : 1;  // of the excess
  const double strain_factor = 1 / (std::numbers::sqrt3 * p.shear_modulus);
  const auto update = [&](const Chunk<Dim, 1>& chunk) SLUICE_INLINE_LAMBDA {
    alignas(64) double stress[symmetric_components<Dim>][chunk_lanes];
    alignas(64) double pressure[chunk_lanes], mean[chunk_lanes], root[chunk_lanes], keep[chunk_lanes];
    compress<Dim>(chunk, p.bulk_modulus, p.cutoff, pressure);
    elastic_trial<Dim>(chunk, {.lambda = 0, .shear = p.shear_modulus}, stress);
    split<Dim>(stress, mean, root);
    double* const strain = chunk.state[0];
    SLUICE_LANE_LOOP
    for (int i = 0; i < chunk_lanes; ++i) {
      const double excess = root[i] - p.yield_stress;
      const bool flows = excess > 0;
      const double lost = flows ? (1 - kept) * excess : 0;
      keep[i] = flows ? (root[i] - lost) / root[i] : 1;
      strain[i] += strain_factor * lost;
    }
    join<Dim>(stress, keep, pressure);
    store_stress<Dim>(stress, chunk);
  };
  for_each_chunk<Dim, 1>(batch, update);
}

namespace {

struct Parameters {
  double density = 0, bulk_modulus = 0, shear_modulus = 0, yield_stress = 0, viscosity = 0;
  std::optional<double> tension_cutoff;
};

class Bingham final : public Material {
 public:
  explicit Bingham(const Parameters& p)
      : density_(p.density),
        elasticity_{.lambda = p.bulk_modulus - 2 * p.shear_modulus / 3, .shear = p.shear_modulus},
        law_{p.shear_modulus, p.bulk_modulus, p.yield_stress, p.viscosity,
             p.tension_cutoff.value_or(std::numeric_limits<double>::infinity())} {}

  double density() const override { return density_; }
  std::vector<ColumnSpec> columns() const override { return {equivalent_plastic_strain()}; }
  IsotropicElasticity elasticity() const override { return elasticity_; }
  bool linear_elasticity() const override { return true; }
  Strength strength() const override { return Strength::constant; }
  double stored_energy(std::span<const double> stress) const override { return elasticity_.energy(stress); }
  void update(const MaterialBatch<2>& batch) const override { update_bingham<2>(batch, law_); }
  void update(const MaterialBatch<3>& batch) const override { update_bingham<3>(batch, law_); }

 private:
  double density_;
  IsotropicElasticity elasticity_;
  BinghamParameters law_;
};

const auto schema = Schema<Parameters>("material bingham")
                        .quantity("density", &Parameters::density, unit::density, above(0), "Initial mass per volume.")
                        .quantity("bulk_modulus", &Parameters::bulk_modulus, unit::stress, above(0), "Bulk modulus.")
                        .quantity("shear_modulus", &Parameters::shear_modulus, unit::stress, above(0),
                                  "Shear modulus below the yield stress: large against it.")
                        .quantity("yield_stress", &Parameters::yield_stress, unit::stress, at_least(0),
                                  "Shear stress up to which nothing flows.")
                        .quantity("viscosity", &Parameters::viscosity, unit::viscosity, at_least(0),
                                  "Dynamic viscosity of the flow above it.")
                        .quantity("tension_cutoff", &Parameters::tension_cutoff, unit::stress, at_least(0),
                                  "Limit of the mean stress; 0 for a material that tears.");

const bool registered = material_registry().add(
    "bingham",
    {"Elastic below a yield stress, viscous flow above it; implicit, so that viscosity does not limit the step.",
     [] { return schema.docs(); }},
    [](const Node& section) { return std::make_unique<Bingham>(schema.read(section, {"model"})); });

}  // namespace
}  // namespace sluice
