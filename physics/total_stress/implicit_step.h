/// ImplicitStep: a step whose displacements are those at whose end forces balance, without inertia or with that of
/// Newmark's average acceleration. docs/theory.md, eqs. (29a)-(29h).
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/case/case.h"
#include "physics/statics/elastic_operator.h"
#include "physics/statics/stress_trial.h"
#include "physics/statics/surface_laws.h"
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
  /// `load_time`. Throws StepNotSolved if no solution was found.
  void advance(Scene<Dim>& scene, const StressUpdate<Dim>& stress, const SkeletonLoads<Dim>& loads, double dt);

  /// Of the last step: evaluations of the forces, and forces of the material on faces [N].
  std::vector<std::pair<std::string, double>> numbers() const;

 private:
  enum class Kind { none, statics, newmark };
  struct Forces;  // of one step

  static Kind kind_of(const Case& definition);
  struct FaceForce {
    std::size_t face;  // its number
    std::string name;
    Vector<Dim> force;  // [N]
  };

  void solve(Scene<Dim>& scene, Forces& forces);
  [[noreturn]] void refuse(const Scene<Dim>& scene, Forces& forces, Eigen::VectorXd& u, double residual);
  [[noreturn]] void refuse_loose(const Scene<Dim>& scene, Forces& forces);
  void note_forces(Scene<Dim>& scene, const std::vector<Vector<Dim>>& forces);
  void move_statically(Scene<Dim>& scene, double dt);
  void move_with_inertia(Scene<Dim>& scene, Forces& forces);
  /// The nodes' motion to the particles.
  void gather(Scene<Dim>& scene, const MotionUpdate<Dim>& update);

  Kind kind_;
  ColumnId spare_velocity_;  // with inertia: of the motion that only moves
  std::vector<Workspace<Dim>> workspaces_;
  int evaluations_ = 0;
  std::vector<FaceForce> face_force_;  // of the faces that hold something
};

extern template class ImplicitStep<2>;
extern template class ImplicitStep<3>;

}  // namespace sluice
