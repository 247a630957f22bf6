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

MohrCoulombReturn::MohrCoulombReturn(const MohrCoulombParameters& p) {
  const double lambda = p.elasticity.lambda, shear = p.elasticity.shear;
  const double sin_dilation = std::sin(p.dilation_angle);
  sin_friction = std::sin(p.friction_angle);
  const double up = 1 + sin_friction, down = 1 - sin_friction;
  strength = 2 * p.cohesion * std::cos(p.friction_angle);
  apex = sin_friction > 0 ? strength / (2 * sin_friction) : std::numeric_limits<double>::infinity();
  cutoff = p.tension_cutoff < apex ? p.tension_cutoff : std::numeric_limits<double>::infinity();
  cutoff_s3 = (up * cutoff - strength) / down;
  yield_slope = down / up;
  yield_intercept = strength / up;

  // What a unit multiplier takes from the principal stresses: D times the flow direction (MC.6).
  const double drop1 = 2 * lambda * sin_dilation + 2 * shear * (1 + sin_dilation);
  const double drop2 = 2 * lambda * sin_dilation;
  const double drop3 = 2 * lambda * sin_dilation - 2 * shear * (1 - sin_dilation);
  face_multiplier = 1 / (up * drop1 - down * drop3);
  face_s2 = drop2 * face_multiplier;
  face_s3 = drop3 * face_multiplier;
  const double lower_drop3 = 0.5 * (drop2 + drop3), upper_drop1 = 0.5 * (drop1 + drop2);
  lower_edge_s3 = lower_drop3 / (up * drop1 - down * lower_drop3);
  upper_edge_s3 = drop3 / (up * upper_drop1 - down * drop3);
  lower_gap = 2 * shear * (1 - sin_dilation);
  upper_gap = 2 * shear * (1 + sin_dilation);

  cutoff_plane = lambda / (lambda + 2 * shear);
  cutoff_edge = lambda / (2 * lambda + 2 * shear);
}

namespace mohr_coulomb {
namespace {

/// The admissible stress of the point in `lane`, in place, with its addition to `strain`.
template <bool Cutoff>
void return_solid(const MohrCoulombReturn& map, double strain_factor, Solid& stress, int lane, double& strain) {
  const double xy = stress[3][lane], yz = stress[4][lane], xz = stress[5][lane];
  Eigen::Matrix3d tensor;
  tensor << stress[0][lane], xy, xz, xy, stress[1][lane], yz, xz, yz, stress[2][lane];
  if (!tensor.allFinite()) return;  // left for the guard of the time loop to find
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal(tensor);
  const Eigen::Vector3d& ascending = principal.eigenvalues();
  const PrincipalStress trial = {ascending[2], ascending[1], ascending[0]};
  if (!(map.yield(trial) > 0) && !(trial.s1 > map.cutoff)) return;

  const PrincipalStress returned = admissible<Cutoff>(map, trial);
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

}  // namespace

// Templates with external linkage: GCC dispatches clones only of functions that the linker can see.
template <bool Cutoff>
SLUICE_MULTITARGET void update_batch(const MaterialBatch<2>& batch, const IsotropicElasticity& elasticity,
                                     const MohrCoulombReturn& map, double strain_factor) {
  update_plane<Cutoff>(batch, elasticity, map, strain_factor);
}

template <bool Cutoff>
SLUICE_MULTITARGET void update_batch(const MaterialBatch<3>& batch, const IsotropicElasticity& elasticity,
                                     const MohrCoulombReturn& map, double strain_factor) {
  const auto return_point = [&](Solid& stress, int lane, double& strain) SLUICE_INLINE_LAMBDA {
    return_solid<Cutoff>(map, strain_factor, stress, lane, strain);
  };
  update_solid(batch, elasticity, map, return_point);
}

}  // namespace mohr_coulomb

MohrCoulomb::MohrCoulomb(double density, const MohrCoulombParameters& parameters)
    : density_(density),
      elasticity_(parameters.elasticity),
      map_(parameters),
      strain_factor_(std::numbers::sqrt2 / (6 * parameters.elasticity.shear)) {
  assert(parameters.friction_angle > 0 || parameters.cohesion > 0);
  assert(parameters.dilation_angle <= parameters.friction_angle);
}

std::vector<ColumnSpec> MohrCoulomb::columns() const {
  return {{.name = "equivalent_plastic_strain",
           .unit = "1",
           .sentence = "Accumulated equivalent plastic deviatoric strain, sum of sqrt(2/3 de_p:de_p)."}};
}

void MohrCoulomb::update(const MaterialBatch<2>& batch) const {
  if (map_.has_cutoff()) {
    mohr_coulomb::update_batch<true>(batch, elasticity_, map_, strain_factor_);
  } else {
    mohr_coulomb::update_batch<false>(batch, elasticity_, map_, strain_factor_);
  }
}

void MohrCoulomb::update(const MaterialBatch<3>& batch) const {
  if (map_.has_cutoff()) {
    mohr_coulomb::update_batch<true>(batch, elasticity_, map_, strain_factor_);
  } else {
    mohr_coulomb::update_batch<false>(batch, elasticity_, map_, strain_factor_);
  }
}

namespace {

struct Parameters {
  double density = 0;
  double youngs_modulus = 0;
  double poisson_ratio = 0;
  double friction_angle = 0;
  double cohesion = 0;
  double dilation_angle = 0;
  std::optional<double> tension_cutoff;
};

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
                  "Limit of the largest principal stress.", {"the apex c cot(phi), if there is one"});

std::unique_ptr<Material> make(const Node& section) {
  const Parameters p = schema.read(section, {"model"});
  const auto place = [&](const std::string& key) {
    const Node* const value = section.find(key);
    return value != nullptr ? value->place : section.place;
  };
  if (p.friction_angle == 0 && p.cohesion == 0) {
    throw CaseError(place("cohesion"),
                    "cohesion and friction_angle are both 0, so the material has no strength at all; "
                    "one of them must be above 0");
  }
  if (p.dilation_angle > p.friction_angle) {
    constexpr double degrees = 180 / std::numbers::pi;
    throw CaseError(
        place("dilation_angle"),
        fmt::format("dilation_angle is {:g} deg; it must be at most the friction_angle, {:g} deg, or plastic "
                    "flow would produce energy",
                    p.dilation_angle * degrees, p.friction_angle * degrees));
  }
  MohrCoulombParameters parameters = {.elasticity = IsotropicElasticity::from_young(p.youngs_modulus, p.poisson_ratio),
                                      .friction_angle = p.friction_angle,
                                      .cohesion = p.cohesion,
                                      .dilation_angle = p.dilation_angle};
  if (p.tension_cutoff) parameters.tension_cutoff = *p.tension_cutoff;
  return std::make_unique<MohrCoulomb>(p.density, parameters);
}

const bool registered = material_registry().add(
    "mohr_coulomb",
    {"Linear elasticity with Mohr-Coulomb strength, perfect plasticity, dilation and tension cut-off.",
     [] { return schema.docs(); }},
    make);

}  // namespace
}  // namespace sluice
