#include "physics/element/driver.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/simulation/physics_module.h"

namespace sluice::element {

double pressure(const Tensor& stress) { return -(stress[0] + stress[1] + stress[2]) / 3 + 0.0; }  // and no -0

double mises_stress(const Tensor& stress) {
  const double p = pressure(stress);
  double squares = 0;
  for (std::size_t k = 0; k < components; ++k)
    squares += k < 3 ? (stress[k] + p) * (stress[k] + p) : 2 * stress[k] * stress[k];
  return std::sqrt(1.5 * squares);
}

void update_point(const Material& material, const Tensor& strain_increment, double dt, PointState& point) {
  MaterialBatch<3> batch;
  batch.size = 1;
  batch.dt = dt;
  batch.time = point.time;
  std::vector<double*> state;
  for (double& value : point.state) state.push_back(&value);
  for (std::size_t k = 0; k < components; ++k) {
    batch.strain_increment[k] = &strain_increment[k];
    batch.stress[k] = &point.stress[k];
  }
  batch.state = state;
  material.update(batch);
}

double stiffness_at(const Material& material, const Tensor& stress) {
  std::array<const double*, components> columns;
  for (std::size_t k = 0; k < components; ++k) columns[k] = &stress[k];
  return material.constrained_modulus(columns, 1);
}

PointState initial_point(const ElementCase& definition, const Material& material) {
  PointState point;
  point.stress = definition.initial_stress;
  for (const ColumnSpec& spec : material.columns())
    point.state.insert(point.state.end(), static_cast<std::size_t>(spec.components), 0.0);
  update_point(material, {}, 0, point);
  double largest = 0, change = 0;
  for (std::size_t k = 0; k < components; ++k) {
    largest = std::max(largest, std::abs(definition.initial_stress[k]));
    change = std::max(change, std::abs(point.stress[k] - definition.initial_stress[k]));
  }
  if (change > 1e-8 * largest)
    throw CaseError(
        definition.initial_stress_place,
        fmt::format("the initial stress is more than the material bears; it would be returned to p = {:.4g} "
                    "Pa, q = {:.4g} Pa",
                    pressure(point.stress), mises_stress(point.stress)));
  return point;
}

// ---- mixed control ----

Unknowns::Unknowns(const Stage& stage, double modulus) : stage_(stage), modulus_(modulus) {
  for (std::size_t k = 0; k < components; ++k)
    if (stage.stress_given[k]) stressed_.push_back(k);
}

Tensor Unknowns::strain(const Vector& x, double dt) const {
  Tensor strain;
  for (std::size_t k = 0; k < components; ++k) strain[k] = stage_.strain_rate[k] * dt;
  for (std::size_t i = 0; i < stressed_.size(); ++i) strain[stressed_[i]] = x[static_cast<Eigen::Index>(i)];
  return strain;
}

Vector Unknowns::residual(const std::function<double(std::size_t)>& miss, const Tensor& strain, double scale) const {
  Vector r(size());
  for (std::size_t i = 0; i < stressed_.size(); ++i) r[static_cast<Eigen::Index>(i)] = miss(stressed_[i]) / scale;
  if (stage_.undrained) r[size() - 1] = modulus_ * (strain[0] + strain[1] + strain[2]) / scale;
  return r;
}

Targets::Targets(const Stage& stage, const PointState& start) : duration_(stage.duration) {
  for (std::size_t k = 0; k < components; ++k) {
    begin_[k] = start.stress[k] - (k < 3 ? start.pore_pressure : 0);
    end_[k] = stage.stress[k].value_or(begin_[k]);
  }
}

namespace {

double largest_of(const Tensor& t) {
  double largest = 0;
  for (const double value : t) largest = std::max(largest, std::abs(value));
  return largest;
}

/// A stage with the update of the program, increment by increment.
class StageDriver {
 public:
  StageDriver(const Stage& stage, const Material& material, const PointState& start)
      : stage_(stage),
        material_(material),
        targets_(stage, start),
        begin_(start.time),
        modulus_(stiffness_at(material, start.stress)),
        unknowns_(stage, modulus_),
        rate_(Vector::Zero(unknowns_.size())) {}

  /// From share `from` of the stage to `to`; halves the increment where that does not succeed at once.
  void advance(PointState& point, double from, double to, int halvings = 0) {
    if (step(point, from, to)) return;
    if (halvings == 12) refuse(point);
    const double middle = 0.5 * (from + to);
    advance(point, from, middle, halvings + 1);
    advance(point, middle, to, halvings + 1);
  }

 private:
  bool step(PointState& point, double from, double to) {
    const double dt = (to - from) * stage_.duration;
    PointState next;
    const auto residual = [&](const Vector& x) {
      next = point;
      const Tensor strain = unknowns_.strain(x, dt);
      update_point(material_, strain, dt, next);
      next.pore_pressure += unknowns_.pore_pressure(x);
      const double scale = std::max({largest_of(point.stress), modulus_ * largest_of(strain), 1e-9 * modulus_});
      return unknowns_.residual(
          [&](std::size_t k) { return next.stress[k] - (k < 3 ? next.pore_pressure : 0) - targets_.at(k, to); }, strain,
          scale);
    };
    Vector x = rate_ * dt;  // as in the increment before
    if (!solve(residual, x, dt)) {
      x.setZero();
      if (!solve(residual, x, dt)) return false;
    }
    residual(x);  // leaves `next` at the solution
    const Tensor strain = unknowns_.strain(x, dt);
    for (std::size_t k = 0; k < components; ++k) next.strain[k] += strain[k];
    if (!std::isfinite(pressure(next.stress) + mises_stress(next.stress))) return false;
    next.time = begin_ + to * stage_.duration;
    point = next;
    rate_ = x / dt;
    return true;
  }

  bool solve(const std::function<Vector(const Vector&)>& residual, Vector& x, double dt) const {
    const double size = std::max({x.lpNorm<Eigen::Infinity>(), largest_of(stage_.strain_rate) * dt, 1e-7});
    return newton(residual, x, {.perturbation = 1e-4 * size, .tolerance = 1e-11, .acceptable = 1e-8});
  }

  [[noreturn]] void refuse(const PointState& point) const {
    std::string strain;
    for (std::size_t k = 0; k < components; ++k)
      strain += fmt::format("{}{} {:.4g}", k == 0 ? "" : ", ", component_names()[k], point.strain[k]);
    throw PhysicsError(
        fmt::format("{}: no strain leads to the given stress at time {:g} s (p = {:.4g} Pa, q = {:.4g} Pa, strain {}); "
                    "the strength may be reached",
                    stage_.name, point.time, pressure(point.stress), mises_stress(point.stress), strain));
  }

  const Stage& stage_;
  const Material& material_;
  Targets targets_;
  double begin_;    ///< [s]
  double modulus_;  ///< [Pa]
  Unknowns unknowns_;
  Vector rate_;
};

}  // namespace

std::vector<double> row_shares(const Stage& stage, int every) {
  std::vector<double> shares;
  for (int i = 1; i <= stage.increments; ++i)
    if (i % every == 0 || i == stage.increments) shares.push_back(static_cast<double>(i) / stage.increments);
  return shares;
}

void drive(const ElementCase& definition, const Material& material, const std::function<void(const Row&)>& record) {
  Row row{0, initial_point(definition, material)};
  record(row);
  for (row.stage = 0; row.stage < definition.stages.size(); ++row.stage) {
    const Stage& stage = definition.stages[row.stage];
    StageDriver driver(stage, material, row.point);
    const double n = stage.increments;
    for (int i = 1; i <= stage.increments; ++i) {
      driver.advance(row.point, (i - 1) / n, i / n);
      if (i % definition.output.every == 0 || i == stage.increments) record(row);
    }
  }
}

}  // namespace sluice::element
