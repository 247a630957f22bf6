/// Mohr-Coulomb: construction, 3-D principal values, and registration. Equations MC.x: docs/materials/mohr_coulomb.md.
#include "physics/materials/mohr_coulomb.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <cassert>
#include <cmath>
#include <numbers>
#include <optional>

#include "core/case/schema.h"
#include "physics/materials/mohr_coulomb_batch.h"

namespace sluice {

MohrCoulombStrength::MohrCoulombStrength(const MohrCoulombParameters& p)
    : sin_friction(std::sin(p.friction_angle)),
      strength(2 * p.cohesion * std::cos(p.friction_angle)),
      sin_dilation(std::sin(p.dilation_angle)) {}

MohrCoulombReturn::MohrCoulombReturn(const MohrCoulombParameters& p)
    : MohrCoulombReturn(p.elasticity, MohrCoulombStrength(p), p.tension_cutoff) {}

namespace mohr_coulomb {

void return_point(const MohrCoulombReturn& map, bool cutoff, double strain_factor, Solid& stress, int lane,
                  double& strain) {
  const double xy = stress[3][lane], yz = stress[4][lane], xz = stress[5][lane];
  Eigen::Matrix3d tensor;
  tensor << stress[0][lane], xy, xz, xy, stress[1][lane], yz, xz, yz, stress[2][lane];
  if (!tensor.allFinite()) return;  // left for the guard of the time loop to find
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal(tensor);
  const Eigen::Vector3d& ascending = principal.eigenvalues();
  const PrincipalStress trial = {ascending[2], ascending[1], ascending[0]};
  if (!(map.yield(trial) > 0) && !(trial.s1 > map.cutoff)) return;

  const PrincipalStress returned = cutoff ? admissible<true>(map, trial) : admissible<false>(map, trial);
  const Eigen::Matrix3d& axes = principal.eigenvectors();
  tensor = axes * Eigen::Vector3d(returned.s3, returned.s2, returned.s1).asDiagonal() * axes.transpose();
  stress[0][lane] = tensor(0, 0);
  stress[1][lane] = tensor(1, 1);
  stress[2][lane] = tensor(2, 2);
  stress[3][lane] = tensor(1, 0);
  stress[4][lane] = tensor(2, 1);
  stress[5][lane] = tensor(2, 0);
  strain += strain_factor * std::sqrt(squared_differences(trial, returned));
}

// A template with external linkage: GCC dispatches clones only of functions that the linker can see.
template <bool Cutoff, int Dim, class Strengths>
SLUICE_MULTITARGET void update_batch(const MaterialBatch<Dim>& batch, const IsotropicElasticity& elasticity,
                                     const Strengths& strengths, double strain_factor) {
  update<Cutoff>(batch, elasticity, strengths, strain_factor);
}

}  // namespace mohr_coulomb

MohrCoulomb::MohrCoulomb(double density, const MohrCoulombParameters& parameters, std::optional<Weakening> weakening)
    : density_(density),
      elasticity_(parameters.elasticity),
      peak_(parameters),
      tension_cutoff_(parameters.tension_cutoff),
      map_(parameters),
      weakening_(std::move(weakening)),
      strain_factor_(std::numbers::sqrt2 / (6 * parameters.elasticity.shear)) {
  assert(parameters.friction_angle > 0 || parameters.cohesion > 0);
  assert(parameters.dilation_angle <= parameters.friction_angle);
}

std::vector<ColumnSpec> MohrCoulomb::columns() const { return {equivalent_plastic_strain()}; }

void check_friction(double friction_angle, double cohesion, double dilation_angle, const std::string& what,
                    const Node& section) {
  const auto place = [&](const std::string& key) {
    const Node* const value = section.find(key);
    return value != nullptr ? value->place : section.place;
  };
  if (friction_angle == 0 && cohesion == 0) {
    throw CaseError(place("cohesion"),
                    what +
                        "cohesion and friction_angle are both 0, so the material has no strength at all; "
                        "one of them must be above 0");
  }
  if (dilation_angle > friction_angle) {
    constexpr double degrees = 180 / std::numbers::pi;
    throw CaseError(
        place("dilation_angle"),
        fmt::format("{}dilation_angle is {:g} deg; it must be at most the friction_angle, {:g} deg, or plastic "
                    "flow would produce energy",
                    what, dilation_angle * degrees, friction_angle * degrees));
  }
}

void MohrCoulomb::set_cell_size(double h) {
  if (weakening_) weakening_->law.set_cell_size(h);
}

template <int Dim>
void MohrCoulomb::update_either(const MaterialBatch<Dim>& batch) const {
  if (weakening_) {
    const MohrCoulombStrength& residual = weakening_->residual;
    const mohr_coulomb::Softened strengths{
        elasticity_,
        residual,
        MohrCoulombStrength(peak_.sin_friction - residual.sin_friction, peak_.strength - residual.strength,
                            peak_.sin_dilation - residual.sin_dilation),
        tension_cutoff_,
        weakening_->law,
        weakening_->law.left_at(batch.time)};
    // With a cut-off beyond the apex of the peak, that of the residual strength may still lie beneath it.
    if (std::isfinite(tension_cutoff_))
      mohr_coulomb::update_batch<true>(batch, elasticity_, strengths, strain_factor_);
    else
      mohr_coulomb::update_batch<false>(batch, elasticity_, strengths, strain_factor_);
  } else if (map_.has_cutoff()) {
    mohr_coulomb::update_batch<true>(batch, elasticity_, mohr_coulomb::Perfect{map_}, strain_factor_);
  } else {
    mohr_coulomb::update_batch<false>(batch, elasticity_, mohr_coulomb::Perfect{map_}, strain_factor_);
  }
}

void MohrCoulomb::update(const MaterialBatch<2>& batch) const { update_either(batch); }
void MohrCoulomb::update(const MaterialBatch<3>& batch) const { update_either(batch); }

namespace {

struct ResidualStrength : SofteningKeys {
  std::optional<double> friction_angle, cohesion, dilation_angle;
};

struct Parameters {
  double density = 0;
  double youngs_modulus = 0;
  double poisson_ratio = 0;
  double friction_angle = 0;
  double cohesion = 0;
  double dilation_angle = 0;
  std::optional<double> tension_cutoff;
  std::optional<ResidualStrength> softening;
};

const auto softening =
    softening_schema<ResidualStrength>("softening")
        .quantity("friction_angle", &ResidualStrength::friction_angle, unit::angle, from_below(0, right_angle),
                  "Residual friction angle, at most that of the peak.", {"that of the peak"})
        .quantity("cohesion", &ResidualStrength::cohesion, unit::stress, at_least(0),
                  "Residual cohesion, at most that of the peak.", {"that of the peak"})
        .quantity("dilation_angle", &ResidualStrength::dilation_angle, unit::angle, from_below(0, right_angle),
                  "Residual dilation angle, at most that of the peak and at most the residual friction angle.",
                  {"that of the peak"});

const auto schema =
    Schema<Parameters>("material mohr_coulomb")
        .quantity("density", &Parameters::density, unit::density, above(0), "Initial mass per volume.")
        .quantity("youngs_modulus", &Parameters::youngs_modulus, unit::stress, above(0), "Young's modulus.")
        .quantity("poisson_ratio", &Parameters::poisson_ratio, unit::none, within(-1, 0.5), "Poisson's ratio.", 0.3)
        .quantity("friction_angle", &Parameters::friction_angle, unit::angle, from_below(0, right_angle),
                  "Friction angle; 0 makes the model Tresca's.")
        .quantity("cohesion", &Parameters::cohesion, unit::stress, at_least(0), "Cohesion.")
        .quantity("dilation_angle", &Parameters::dilation_angle, unit::angle, from_below(0, right_angle),
                  "Dilation angle, at most the friction angle.", 0.0)
        .quantity("tension_cutoff", &Parameters::tension_cutoff, unit::stress, at_least(0),
                  "Limit of the largest principal stress.", {"the apex c cot(phi), if there is one"})
        .section("softening", &Parameters::softening, softening,
                 "How strengths fall from the peak, which the keys above give, to residual values.",
                 {"none: perfectly plastic"});

MohrCoulomb::Weakening weakening_of(const MohrCoulombParameters& peak, const ResidualStrength& keys,
                                    const Node& section) {
  check_softening(keys);
  MohrCoulombParameters residual = peak;
  bool falls = false;
  const auto take = [&](const char* key, const std::optional<double>& value, double& target, const Unit& unit) {
    if (!value) return;
    if (*value > target)
      throw CaseError(
          section.find(key)->place,
          fmt::format("softening: the residual {} is {}; it must be at most that of the peak, {}", key,
                      value::from_quantity(*value, unit).scalar, value::from_quantity(target, unit).scalar));
    falls = falls || *value < target;
    target = *value;
  };
  take("friction_angle", keys.friction_angle, residual.friction_angle, unit::angle);
  take("cohesion", keys.cohesion, residual.cohesion, unit::stress);
  take("dilation_angle", keys.dilation_angle, residual.dilation_angle, unit::angle);
  if (!falls)
    throw CaseError(keys.place,
                    "softening: nothing falls; give a residual `cohesion`, `friction_angle` or `dilation_angle` below "
                    "that of the peak");
  check_friction(residual.friction_angle, residual.cohesion, residual.dilation_angle, "softening: residual ", section);
  return {MohrCoulombStrength(residual), Softening(keys)};
}

std::unique_ptr<Material> make(const Node& section) {
  const Parameters p = schema.read(section, {"model"});
  MohrCoulombParameters parameters = {.elasticity = IsotropicElasticity::from_young(p.youngs_modulus, p.poisson_ratio),
                                      .friction_angle = p.friction_angle,
                                      .cohesion = p.cohesion,
                                      .dilation_angle = p.dilation_angle};
  if (p.tension_cutoff) parameters.tension_cutoff = *p.tension_cutoff;
  check_friction(p.friction_angle, p.cohesion, p.dilation_angle, "", section);
  std::optional<MohrCoulomb::Weakening> weakening;
  if (p.softening) weakening = weakening_of(parameters, *p.softening, *section.find("softening"));
  return std::make_unique<MohrCoulomb>(p.density, parameters, weakening);
}

const bool registered = material_registry().add(
    "mohr_coulomb",
    {"Linear elasticity with Mohr-Coulomb strength, perfect or softening, dilation and tension cut-off.",
     [] { return schema.docs(); }},
    make);

}  // namespace
}  // namespace sluice
