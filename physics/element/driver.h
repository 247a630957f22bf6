/// Driver: a material point alone on a path of given strain and stress, with the update of the program.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "physics/element/element_case.h"
#include "physics/element/newton.h"

namespace sluice::element {

/// A point and where it stands on its path.
struct PointState {
  Tensor strain{}, stress{};  ///< stress: the effective one [Pa]
  double pore_pressure = 0;   ///< in excess of that of the start [Pa]
  double time = 0;            ///< [s]
  std::vector<double> state;  ///< of the material, component by component
};

double pressure(const Tensor& stress);      ///< -tr / 3 [Pa]
double mises_stress(const Tensor& stress);  ///< (3/2 s:s)^(1/2) [Pa]

/// Material::update for one point: changes stress and state, and neither strain nor time.
void update_point(const Material& material, const Tensor& strain_increment, double dt, PointState& point);

/// The point at the start of the path. The material gets it once with no strain, so that what it remembers of the
/// initial stress is set. Throws CaseError where the initial stress is not admissible.
PointState initial_point(const ElementCase& definition, const Material& material);

/// lambda + 2 G of the material at a stress [Pa].
double stiffness_at(const Material& material, const Tensor& stress);

/// The unknowns of a stage in a vector: strains whose stress is given, times 1, and the pore pressure of an undrained
/// stage over `modulus`; and the same for rates.
class Unknowns {
 public:
  Unknowns(const Stage& stage, double modulus);
  Eigen::Index size() const { return static_cast<Eigen::Index>(stressed_.size()) + (stage_.undrained ? 1 : 0); }
  /// Strain of the stage over `dt` with the unknowns filled in.
  Tensor strain(const Vector& x, double dt) const;
  /// The pore pressure's part [Pa]; 0 if drained.
  double pore_pressure(const Vector& x) const { return stage_.undrained ? modulus_ * x[size() - 1] : 0; }
  /// Residuals over `scale` [Pa]: `miss(k)` of each given stress [Pa], then modulus times the change of volume.
  Vector residual(const std::function<double(std::size_t)>& miss, const Tensor& strain, double scale) const;
  const std::vector<std::size_t>& stressed() const { return stressed_; }

 private:
  const Stage& stage_;
  double modulus_;
  std::vector<std::size_t> stressed_;
};

/// Total stresses that a stage gives, along straight lines from those of its first point.
class Targets {
 public:
  Targets(const Stage& stage, const PointState& start);
  double at(std::size_t k, double share) const { return begin_[k] + share * (end_[k] - begin_[k]); }
  double rate(std::size_t k) const { return (end_[k] - begin_[k]) / duration_; }

 private:
  Tensor begin_{}, end_{};
  double duration_;
};

/// Rows of a path: the first point, then those after each `every` increments and at the end of each stage.
struct Row {
  std::size_t stage = 0;
  PointState point;
};

/// Goes along all stages with the update of the program; calls `record` for each row, beginning with the start. Throws
/// PhysicsError where no strain leads to the given stress.
void drive(const ElementCase& definition, const Material& material, const std::function<void(const Row&)>& record);

/// The shares of a stage at which rows are recorded, the last being 1.
std::vector<double> row_shares(const Stage& stage, int every);

}  // namespace sluice::element
