/// Drucker-Prager: friction and cohesion on a cone, with dilation and tension cut-off. Equations DP.x:
/// docs/materials/drucker_prager.md.
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "core/case/schema.h"
#include "physics/materials/deviator.h"
#include "physics/materials/elastic_trial.h"
#include "physics/materials/mohr_coulomb.h"

namespace sluice {

/// The constants of the return.
struct DruckerPragerReturn {
  double slope, intercept;  ///< root of J2 = intercept - slope * mean stress on the cone (DP.2)
  double dilation;          ///< slope of the plastic potential
  double shear, bulk;       ///< [Pa]
  double cutoff;            ///< of the mean stress: the given one or the apex, whichever is lower; may be infinite
  double root_at_cutoff;    ///< root of J2 where the cone meets the cut-off
};

/// Cone, cut-off and their edge, in closed form (DP.4) to (DP.6); the apex is a cut-off.
template <int Dim>
SLUICE_MULTITARGET void update_drucker_prager(const MaterialBatch<Dim>& batch, const IsotropicElasticity& elasticity,
                                              const DruckerPragerReturn& map) {
  const double inverse = 1 / (map.shear + map.bulk * map.slope * map.dilation);
  const double strain_factor = 1 / (std::numbers::sqrt3 * map.shear);
  const auto update = [&](const Chunk<Dim, 1>& chunk) SLUICE_INLINE_LAMBDA {
    alignas(64) double stress[symmetric_components<Dim>][chunk_lanes];
    alignas(64) double mean[chunk_lanes], root[chunk_lanes], keep[chunk_lanes];
    elastic_trial<Dim>(chunk, elasticity, stress);
    split<Dim>(stress, mean, root);
    double* const strain = chunk.state[0];
    SLUICE_LANE_LOOP
    for (int i = 0; i < chunk_lanes; ++i) {
      const double excess = root[i] + map.slope * mean[i] - map.intercept;
      const double multiplier = excess > 0 ? excess * inverse : 0;
      const double cone_mean = mean[i] - map.bulk * map.dilation * multiplier;
      const double cone_root = root[i] - map.shear * multiplier;
      const double edge_root = root[i] < map.root_at_cutoff ? root[i] : map.root_at_cutoff;
      const bool beyond = cone_mean > map.cutoff;
      const double new_root = beyond ? edge_root : cone_root;
      mean[i] = beyond ? map.cutoff : cone_mean;
      keep[i] = root[i] > new_root ? new_root / root[i] : 1;
      strain[i] += strain_factor * (root[i] > new_root ? root[i] - new_root : 0);
    }
    join<Dim>(stress, keep, mean);
    store_stress<Dim>(stress, chunk);
  };
  for_each_chunk<Dim, 1>(batch, update);
}

namespace {

enum class Matching { plane_strain, compression, extension, inscribed };

/// slope and intercept / c of the cone that stands for (phi, c), and the slope of the potential for psi (DP.7)-(DP.10).
struct Cone {
  double slope, intercept, dilation;
};

Cone cone_of(Matching matching, double friction, double dilation) {
  const double sine = std::sin(friction), cosine = std::cos(friction), flow = std::sin(dilation);
  const auto meridian = [](double sine_of, double over, double sign) {
    return over / (std::numbers::sqrt3 * (3 + sign * sine_of));
  };
  const auto inscribed = [](double sine_of, double over) { return over / std::sqrt(1 + sine_of * sine_of / 3); };
  switch (matching) {
    case Matching::compression:
      return {meridian(sine, 6 * sine, -1), meridian(sine, 6 * cosine, -1), meridian(flow, 6 * flow, -1)};
    case Matching::extension:
      return {meridian(sine, 6 * sine, 1), meridian(sine, 6 * cosine, 1), meridian(flow, 6 * flow, 1)};
    case Matching::inscribed:
      return {inscribed(sine, sine), inscribed(sine, cosine), inscribed(flow, flow)};
    case Matching::plane_strain:
      break;
  }
  const double potential = inscribed(flow, flow);
  const double share = std::sqrt(1 - potential * potential / 3) + sine * potential / 3;
  return {sine / share, cosine / share, potential};
}

struct Parameters {
  double density = 0, youngs_modulus = 0, poisson_ratio = 0;
  double friction_angle = 0, cohesion = 0, dilation_angle = 0;
  Matching matching = Matching::plane_strain;
  std::optional<double> tension_cutoff;
};

class DruckerPrager final : public Material {
 public:
  explicit DruckerPrager(const Parameters& p)
      : density_(p.density), elasticity_(IsotropicElasticity::from_young(p.youngs_modulus, p.poisson_ratio)) {
    const Cone cone = cone_of(p.matching, p.friction_angle, p.dilation_angle);
    const double intercept = cone.intercept * p.cohesion;
    const double infinity = std::numeric_limits<double>::infinity();
    const double apex = cone.slope > 0 ? intercept / cone.slope : infinity;
    const double cutoff = std::min(p.tension_cutoff.value_or(infinity), apex);
    // At the apex itself the root is 0, to the last bit.
    const double root = cutoff < apex ? intercept - cone.slope * cutoff : 0;
    map_ = {cone.slope, intercept, cone.dilation, elasticity_.shear, elasticity_.lambda + 2 * elasticity_.shear / 3,
            cutoff,     root};
  }

  double density() const override { return density_; }
  std::vector<ColumnSpec> columns() const override { return {equivalent_plastic_strain()}; }
  IsotropicElasticity elasticity() const override { return elasticity_; }
  bool linear_elasticity() const override { return true; }
  Strength strength() const override { return map_.slope > 0 ? Strength::frictional : Strength::constant; }
  double stored_energy(std::span<const double> stress) const override { return elasticity_.energy(stress); }
  void update(const MaterialBatch<2>& batch) const override { update_drucker_prager<2>(batch, elasticity_, map_); }
  void update(const MaterialBatch<3>& batch) const override { update_drucker_prager<3>(batch, elasticity_, map_); }

 private:
  double density_;
  IsotropicElasticity elasticity_;
  DruckerPragerReturn map_{};
};

const auto schema =
    Schema<Parameters>("material drucker_prager")
        .quantity("density", &Parameters::density, unit::density, above(0), "Initial mass per volume.")
        .quantity("youngs_modulus", &Parameters::youngs_modulus, unit::stress, above(0), "Young's modulus.")
        .quantity("poisson_ratio", &Parameters::poisson_ratio, unit::none, within(-1, 0.5), "Poisson's ratio.", 0.3)
        .quantity("friction_angle", &Parameters::friction_angle, unit::angle, from_below(0, right_angle),
                  "Friction angle of the Mohr-Coulomb strength that the cone stands for; 0 makes it von Mises's.")
        .quantity("cohesion", &Parameters::cohesion, unit::stress, at_least(0), "Cohesion of that strength.")
        .quantity("dilation_angle", &Parameters::dilation_angle, unit::angle, from_below(0, right_angle),
                  "Dilation angle of that strength, at most the friction angle.", 0.0)
        .choice("matching", &Parameters::matching,
                {{"plane_strain", Matching::plane_strain},
                 {"compression", Matching::compression},
                 {"extension", Matching::extension},
                 {"inscribed", Matching::inscribed}},
                "Where the cone has the strength of Mohr-Coulomb: in plane-strain flow with these angles; in triaxial "
                "compression; in triaxial extension; nowhere more than it, and touching it.",
                Matching::plane_strain)
        .quantity("tension_cutoff", &Parameters::tension_cutoff, unit::stress, at_least(0), "Limit of the mean stress.",
                  {"the apex of the cone, if there is one"});

std::unique_ptr<Material> make(const Node& section) {
  const Parameters p = schema.read(section, {"model"});
  check_friction(p.friction_angle, p.cohesion, p.dilation_angle, "", section);
  return std::make_unique<DruckerPrager>(p);
}

const bool registered = material_registry().add(
    "drucker_prager",
    {"Linear elasticity with a cone of friction and cohesion matched to Mohr-Coulomb, dilation and tension cut-off.",
     [] { return schema.docs(); }},
    make);

}  // namespace
}  // namespace sluice
