/// ImplicitStep: a step whose displacements are those at whose end forces balance, without inertia or with that of
/// Newmark's average acceleration. docs/theory.md, eqs. (29a)-(29e).
#pragma once

#include <vector>

#include "core/case/case.h"
#include "physics/statics/elastic_operator.h"
#include "physics/statics/stress_trial.h"
#include "solvers/nonlinear_solver.h"

namespace sluice {

template <int Dim>
class ImplicitStep {
 public:
  /// Throws CaseError if the case has what implicit steps cannot do.
  explicit ImplicitStep(const Case& definition);
  /// False in an explicit run.
  bool active() const { return kind_ != Kind::none; }
  /// What share of the step the loads are taken at.
  double load_time() const { return kind_ == Kind::newmark ? 0.5 : 1; }

  void declare(Columns& particles);
  /// Solves, moves the particles and sets Scene::motion. The blocks are active; `loads` are those of the time
  /// `load_time`. Throws PhysicsError if no solution was found.
  void advance(Scene<Dim>& scene, const StressUpdate<Dim>& stress, const SkeletonLoads<Dim>& loads, double dt);

  /// Evaluations of the forces in the last step.
  int evaluations() const { return evaluations_; }

 private:
  enum class Kind { none, statics, newmark };
  struct Forces;  // of one step

  static Kind kind_of(const Case& definition);
  void solve(Scene<Dim>& scene, Forces& forces, Eigen::VectorXd& u);
  void move_statically(Scene<Dim>& scene, double dt);
  void move_with_inertia(Scene<Dim>& scene, Forces& forces, const Eigen::VectorXd& u);
  /// The nodes' motion to the particles.
  void gather(Scene<Dim>& scene, const MotionUpdate<Dim>& update);

  Kind kind_;
  ColumnId spare_velocity_;  // with inertia: of the motion that only moves
  std::vector<Workspace<Dim>> workspaces_;
  int evaluations_ = 0;
};

extern template class ImplicitStep<2>;
extern template class ImplicitStep<3>;

}  // namespace sluice
