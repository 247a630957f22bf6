/// Modified Cam clay: clay that hardens as it is compressed and flows at constant volume at the critical state.
/// Equations CC.x: docs/materials/modified_cam_clay.md. Here compression is positive: p = -tr(sigma) / 3.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/case/schema.h"
#include "physics/materials/material.h"

namespace sluice {
namespace {

struct Parameters {
  double density = 0, critical_stress_ratio = 0, lambda = 0, kappa = 0, initial_void_ratio = 0, poisson_ratio = 0;
  double minimum_pressure = 0, reference_pressure = 0;
  std::optional<double> shear_modulus, overconsolidation_ratio, preconsolidation_pressure;
};

/// What a step finds at a point.
struct Answer {
  double pressure = 0, mises = 0, preconsolidation = 0;  ///< [Pa]
  double multiplier = 0;                                 ///< [1/Pa]
  double volumetric = 0;                                 ///< plastic compression of the step
};

class CamClay {
 public:
  explicit CamClay(const Parameters& p)
      : squared_ratio_(p.critical_stress_ratio * p.critical_stress_ratio),
        kappa_(p.kappa / (1 + p.initial_void_ratio)),
        hardening_((p.lambda - p.kappa) / (1 + p.initial_void_ratio)),
        least_(p.minimum_pressure),
        shear_over_bulk_(3 * (1 - 2 * p.poisson_ratio) / (2 * (1 + p.poisson_ratio))),
        shear_(p.shear_modulus) {}

  double least() const { return least_; }
  double hardening() const { return hardening_; }
  double bulk(double pressure) const { return std::max(pressure, least_) / kappa_; }
  double shear(double pressure) const { return shear_ ? *shear_ : shear_over_bulk_ * bulk(pressure); }
  /// p_c of the ellipse through a stress (CC.3).
  double ellipse(double pressure, double mises) const {
    const double p = std::max(pressure, least_);
    return p + mises * mises / (squared_ratio_ * p);
  }
  /// The yield function [Pa2].
  double yield(double pressure, double mises, double preconsolidation) const {
    return mises * mises / squared_ratio_ + pressure * (pressure - preconsolidation);
  }
  /// Elastic energy [J/m3], up to a constant (CC.9).
  double energy(double pressure, double mises) const {
    const double volume =
        pressure > least_ ? kappa_ * (pressure - 0.5 * least_) : 0.5 * kappa_ * pressure * pressure / least_;
    return volume + mises * mises / (6 * shear(pressure));
  }

  /// The pressure after an elastic compression: exponential above the least pressure, linear below (CC.2).
  double compressed(double pressure, double strain) const {
    double coordinate = pressure >= least_ ? kappa_ * std::log(pressure / least_) : kappa_ * (pressure / least_ - 1);
    coordinate += strain;
    return least_ * (coordinate >= 0 ? std::exp(coordinate / kappa_) : 1 + coordinate / kappa_);
  }
  double hardened(double preconsolidation, double plastic) const {
    return std::max(least_, preconsolidation * std::exp(plastic / hardening_));
  }

  /// The step from pressure `p` and preconsolidation pressure `pc`, with the total compression `strain`, the Mises
  /// stress `trial` of the elastic deviator, and the shear modulus `shear`. Backward Euler (CC.5) to (CC.8).
  Answer step(double p, double pc, double strain, double trial, double shear) const {
    const double elastic = compressed(p, strain);
    if (!(yield(elastic, trial, pc) > 0)) return {elastic, trial, pc, 0, 0};
    Answer answer;
    if (!newton(p, pc, strain, trial, shear, answer)) bisect(p, pc, strain, trial, shear, answer);
    return answer;
  }

 private:
  /// Residuals of (CC.7), (CC.8) for the unknowns in `a`, whose other members are set.
  struct Residual {
    double flow, yield;  ///< 1, Pa2
  };
  Residual residual(double p, double pc, double strain, double trial, double shear, Answer& a) const {
    a.pressure = compressed(p, strain - a.volumetric);
    a.preconsolidation = hardened(pc, a.volumetric);
    a.mises = trial / (1 + 6 * shear * a.multiplier / squared_ratio_);
    return {a.volumetric - a.multiplier * (2 * a.pressure - a.preconsolidation),
            yield(a.pressure, a.mises, a.preconsolidation)};
  }

  /// Newton's method for both unknowns; false if it does not converge to a positive multiplier.
  bool newton(double p, double pc, double strain, double trial, double shear, Answer& a) const {
    const double stress2 = pc * pc + trial * trial;
    for (int iteration = 0; iteration < 25; ++iteration) {
      const Residual r = residual(p, pc, strain, trial, shear, a);
      if (std::abs(r.flow) < 1e-15 && std::abs(r.yield) < 1e-14 * stress2) return a.multiplier >= 0;
      const double slope = 2 * a.pressure - a.preconsolidation, stiffness = bulk(a.pressure);
      const double hardens = a.preconsolidation > least_ ? a.preconsolidation / hardening_ : 0;
      const double flow_a = 1 + a.multiplier * (2 * stiffness + hardens), flow_g = -slope;
      const double yield_a = -slope * stiffness - a.pressure * hardens;
      const double yield_g = -12 * shear * a.mises * a.mises /
                             (squared_ratio_ * squared_ratio_ * (1 + 6 * shear * a.multiplier / squared_ratio_));
      const double determinant = flow_a * yield_g - flow_g * yield_a;
      const double da = -(r.flow * yield_g - flow_g * r.yield) / determinant;
      const double dg = -(flow_a * r.yield - yield_a * r.flow) / determinant;
      if (!std::isfinite(da) || !std::isfinite(dg)) return false;
      const double share = std::min(1.0, 2 * kappa_ / std::abs(da));  // not farther than exponentials like
      const bool settled = std::abs(da) < 1e-15 && std::abs(dg) * stress2 < 1e-14 * pc && iteration > 2;
      a.volumetric += share * da;
      a.multiplier += share * dg;
      if (settled) {
        residual(p, pc, strain, trial, shear, a);
        return a.multiplier >= 0;
      }
    }
    return false;
  }

  /// The plastic compression that belongs to a multiplier: the flow residual grows with it.
  void follow(double p, double pc, double strain, double trial, double shear, Answer& a) const {
    double low = -1e-3, high = 1e-3;
    const auto flow = [&](double volumetric) {
      a.volumetric = volumetric;
      return residual(p, pc, strain, trial, shear, a).flow;
    };
    while (flow(low) > 0) low *= 2;
    while (flow(high) < 0) high *= 2;
    for (int n = 0; n < 80; ++n) {
      const double middle = 0.5 * (low + high);
      (flow(middle) > 0 ? high : low) = middle;
    }
    flow(0.5 * (low + high));
  }

  /// The least multiplier that ends on the surface, between brackets: rare, and sure.
  void bisect(double p, double pc, double strain, double trial, double shear, Answer& a) const {
    const auto excess = [&](double multiplier) {
      a.multiplier = multiplier;
      follow(p, pc, strain, trial, shear, a);
      return yield(a.pressure, a.mises, a.preconsolidation);
    };
    double low = 0, high = 1e-9 / pc;
    while (excess(high) > 0) low = high, high *= 2;
    for (int n = 0; n < 80; ++n) {
      const double middle = 0.5 * (low + high);
      (excess(middle) > 0 ? low : high) = middle;
    }
    excess(0.5 * (low + high));
  }

  double squared_ratio_;      ///< M^2
  double kappa_, hardening_;  ///< kappa and lambda - kappa, over 1 + e_0
  double least_;              ///< [Pa]
  double shear_over_bulk_;
  std::optional<double> shear_;  ///< [Pa]
};

class ModifiedCamClay final : public Material {
 public:
  explicit ModifiedCamClay(const Parameters& p) : p_(p), law_(p) {}

  double density() const override { return p_.density; }
  std::vector<ColumnSpec> columns() const override {
    return {equivalent_plastic_strain(),
            {.name = "preconsolidation_pressure",
             .unit = "Pa",
             .sentence = "Size p_c of the yield ellipse on the axis of mean pressure; 0 until the first step."}};
  }
  IsotropicElasticity elasticity() const override {
    const double bulk = law_.bulk(p_.reference_pressure), shear = law_.shear(p_.reference_pressure);
    return {.lambda = bulk - 2 * shear / 3, .shear = shear};
  }
  double constrained_modulus(std::span<const double* const> stress, std::size_t size) const override {
    double largest = 0;
    for (std::size_t i = 0; i < size; ++i) largest = std::max(largest, -stress[0][i] - stress[1][i] - stress[2][i]);
    return law_.bulk(largest / 3) + 4 * law_.shear(largest / 3) / 3;
  }
  double stored_energy(std::span<const double> stress) const override {
    const double mean = (stress[0] + stress[1] + stress[2]) / 3;
    double squares = 0;
    for (std::size_t k = 0; k < stress.size(); ++k)
      squares += k < 3 ? (stress[k] - mean) * (stress[k] - mean) : 2 * stress[k] * stress[k];
    return law_.energy(-mean, std::sqrt(1.5 * squares));
  }
  void update(const MaterialBatch<2>& batch) const override { update_points(batch); }
  void update(const MaterialBatch<3>& batch) const override { update_points(batch); }

 private:
  template <int Dim>
  void update_points(const MaterialBatch<Dim>& batch) const {
    for (std::size_t i = 0; i < batch.size; ++i) update_point(batch, i);
  }

  /// p_c of a point that comes for the first time: the given one, or the ratio times the ellipse through its stress.
  double initial_preconsolidation(double pressure, double mises) const {
    const double through = law_.ellipse(pressure, mises);
    return p_.overconsolidation_ratio ? *p_.overconsolidation_ratio * through
                                      : std::max(*p_.preconsolidation_pressure, through);
  }

  template <int Dim>
  void update_point(const MaterialBatch<Dim>& batch, std::size_t i) const {
    constexpr int components = symmetric_components<Dim>;
    double s[components], e[components];
    for (int k = 0; k < components; ++k) s[k] = batch.stress[k][i], e[k] = batch.strain_increment[k][i];
    const double mean = (s[0] + s[1] + s[2]) / 3, volume = e[0] + e[1] + e[2];
    const double shear = law_.shear(-mean);
    double before = 0, squares = 0;
    for (int k = 0; k < components; ++k) {
      const double weight = k < 3 ? 1 : 2;
      if (k < 3) s[k] -= mean;
      before += weight * s[k] * s[k];
      s[k] += 2 * shear * (e[k] - (k < 3 ? volume / 3 : 0));
      squares += weight * s[k] * s[k];
    }
    const double trial = std::sqrt(1.5 * squares);
    if (!(std::abs(mean) + std::abs(volume) + trial < 1e300)) {  // left for the guard of the time loop to find
      for (int k = 0; k < components; ++k) batch.stress[k][i] = s[k] + mean + volume;
      return;
    }
    double& preconsolidation = batch.state[1][i];
    if (preconsolidation == 0) preconsolidation = initial_preconsolidation(-mean, std::sqrt(1.5 * before));

    const Answer a = law_.step(-mean, preconsolidation, -volume, trial, shear);
    const double keep = trial > 0 ? a.mises / trial : 1;
    for (int k = 0; k < components; ++k) batch.stress[k][i] = keep * s[k] - (k < 3 ? a.pressure : 0);
    preconsolidation = a.preconsolidation;
    batch.state[0][i] += (trial - a.mises) / (3 * shear);
  }

  Parameters p_;
  CamClay law_;
};

const auto schema =
    Schema<Parameters>("material modified_cam_clay")
        .quantity("density", &Parameters::density, unit::density, above(0), "Initial mass per volume.")
        .quantity("critical_stress_ratio", &Parameters::critical_stress_ratio, unit::none, above(0),
                  "M = q / p at the critical state; 6 sin(phi) / (3 - sin(phi)) in triaxial compression.")
        .quantity("lambda", &Parameters::lambda, unit::none, above(0),
                  "Slope of the line of first compression in void ratio over ln p.")
        .quantity("kappa", &Parameters::kappa, unit::none, above(0), "Slope of unloading; below lambda.")
        .quantity("initial_void_ratio", &Parameters::initial_void_ratio, unit::none, above(0), "Void ratio e_0.")
        .quantity("poisson_ratio", &Parameters::poisson_ratio, unit::none, within(-1, 0.5),
                  "Poisson's ratio; the shear modulus then follows the pressure. Not with shear_modulus.", 0.3)
        .quantity("shear_modulus", &Parameters::shear_modulus, unit::stress, above(0), "Constant shear modulus.",
                  {"from poisson_ratio"})
        .quantity("overconsolidation_ratio", &Parameters::overconsolidation_ratio, unit::none, at_least(1),
                  "Size of the yield ellipse over that of the ellipse through the stress that a point has when it "
                  "becomes this material.",
                  {"from preconsolidation_pressure"})
        .quantity("preconsolidation_pressure", &Parameters::preconsolidation_pressure, unit::stress, above(0),
                  "Initial size of the yield ellipse, enlarged where the initial stress lies outside.",
                  {"from overconsolidation_ratio"})
        .quantity("minimum_pressure", &Parameters::minimum_pressure, unit::stress, above(0),
                  "Pressure below which the stiffness falls no further, and least size of the ellipse.", 1e3)
        .quantity("reference_pressure", &Parameters::reference_pressure, unit::stress, above(0),
                  "Pressure whose stiffness `initial_stress: elastic_equilibrium` uses.", 100e3);

std::unique_ptr<Material> make(const Node& section) {
  const Parameters p = schema.read(section, {"model"});
  if (p.kappa >= p.lambda)
    throw CaseError(section.find("kappa")->place,
                    fmt::format("kappa is {:g}; it must be below lambda, {:g}", p.kappa, p.lambda));
  if (p.overconsolidation_ratio.has_value() == p.preconsolidation_pressure.has_value())
    throw CaseError(section.place,
                    fmt::format("{} of `overconsolidation_ratio` and `preconsolidation_pressure` {} given; one of them "
                                "must be",
                                p.overconsolidation_ratio ? "both" : "none", p.overconsolidation_ratio ? "are" : "is"));
  if (p.shear_modulus && section.find("poisson_ratio") != nullptr)
    throw CaseError(section.find("poisson_ratio")->place,
                    "poisson_ratio and shear_modulus are both given; one of them decides the shear modulus");
  return std::make_unique<ModifiedCamClay>(p);
}

const bool registered = material_registry().add(
    "modified_cam_clay",
    {"Modified Cam clay: hardening clay with a critical state, stiffness that follows the pressure.",
     [] { return schema.docs(); }},
    make);

}  // namespace
}  // namespace sluice
