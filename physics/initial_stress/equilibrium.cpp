#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "physics/initial_stress/elastic_equilibrium.h"
#include "physics/initial_stress/initial_stress.h"
#include "physics/statics/elastic_operator.h"
#include "physics/statics/stress_trial.h"
#include "solvers/nonlinear_solver.h"
#include "solvers/sparse_cholesky.h"

namespace sluice {

namespace {

/// Over which strains come [s]: so long that no stress comes of their rate. A power of two, so that displacements lose
/// no digits as velocities.
const double geological = std::ldexp(1.0, 40);

/// The smallest increment that is tried, as a share of the loads.
constexpr double smallest_increment = 1.0 / 32;

/// Loads in increments, each from the state of the one before: eqs. (32e) and (32f).
template <int Dim>
class Equilibrium {
 public:
  Equilibrium(const InitialStress& initial, Scene<Dim>& scene, const StressUpdate<Dim>& stress,
              const SkeletonLoads<Dim>& loads)
      : initial_(initial),
        scene_(scene),
        unknowns_(scene),
        elastic_(scene, stress.materials(), loads, unknowns_),
        trial_(scene, stress, unknowns_, Kinematics::small) {
    cholesky_.factorize(elastic_.matrix());
    elastic_displacement_ = cholesky_.solve(elastic_.force());
    // The materials see the elastic stress first: those that remember a stress remember this one.
    set_elastic_stress(scene, stress.materials(), unknowns_, elastic_displacement_);
    trial_.keep();
    base_ = elastic_displacement_;
    largest_force_ = elastic_.force().size() == 0 ? 0 : elastic_.force().template lpNorm<Eigen::Infinity>();
  }

  void solve() {
    if (largest_force_ == 0) return;
    double carried = 0, increment = 1.0 / initial_.increments;
    Eigen::VectorXd u = Eigen::VectorXd::Zero(unknowns_.count());
    while (carried < 1) {
      const double share = carried + increment > 1 - 1e-9 ? 1 : carried + increment;
      Eigen::VectorXd next = u + (share - carried) * elastic_displacement_;
      const NonlinearReport report = balance(share, next);
      if (report.converged) {
        commit(next);
        u = next;
        carried = share;
        continue;
      }
      increment = 0.5 * (share - carried);
      if (increment < smallest_increment) refuse(carried, report, next);
    }
  }

 private:
  /// Internal forces and springs less `share` of the forces from outside.
  bool residual(double share, std::span<const double> u, std::span<double> f) {
    const auto count = static_cast<Eigen::Index>(u.size());
    const Eigen::Map<const Eigen::VectorXd> now(u.data(), count);
    Eigen::Map<Eigen::VectorXd> out(f.data(), count);
    difference_ = now - base_;
    if (!trial_.apply({difference_.data(), u.size()}, geological, f)) return false;
    out += elastic_.spring().cwiseProduct(now) - share * elastic_.force();
    return true;
  }

  NonlinearReport balance(double share, Eigen::VectorXd& u) {
    const NonlinearProblem problem{
        [&](std::span<const double> at, std::span<double> f) { return residual(share, at, f); },
        [&](std::span<const double> r, std::span<double> x) { cholesky_.solve(r, x); }};
    NonlinearOptions options;
    options.tolerance = initial_.tolerance;
    options.scale = largest_force_;
    options.step = elastic_displacement_.norm() / std::sqrt(static_cast<double>(u.size()));
    return solve_nonlinear(problem, {u.data(), static_cast<std::size_t>(u.size())}, options);
  }

  /// The particles take the state at u, from which the next increment starts.
  void commit(const Eigen::VectorXd& u) {
    Eigen::VectorXd f(u.size());
    difference_ = u - base_;
    const auto size = static_cast<std::size_t>(u.size());
    trial_.apply({difference_.data(), size}, geological, {f.data(), size});
    trial_.keep();
    base_ = u;
  }

  [[noreturn]] void refuse(double carried, const NonlinearReport& report, const Eigen::VectorXd& u) {
    Eigen::VectorXd f(u.size());
    const auto size = static_cast<std::size_t>(u.size());
    Eigen::Index worst = 0;
    if (residual(1, {u.data(), size}, {f.data(), size})) f.cwiseAbs().maxCoeff(&worst);
    throw CaseError(
        initial_.place,
        fmt::format("initial_stress: no equilibrium was found: the materials carry {:.3g} % of weight and loads; with "
                    "more, forces stay out of balance by {:.2g} of the largest on a node (allowed: {:.2g}), most near "
                    "{}. If the strength does not suffice, the body would move at once: raise the strength, or start "
                    "from `method: elastic_equilibrium` to compute how it fails. If a surface without cohesion is in "
                    "the way, give it a little, or raise `tolerance`",
                    100 * carried, report.residual, initial_.tolerance,
                    place_of(scene_, unknowns_, static_cast<int>(worst))));
  }

  const InitialStress& initial_;
  Scene<Dim>& scene_;
  Unknowns<Dim> unknowns_;
  ElasticOperator<Dim> elastic_;
  StressTrial<Dim> trial_;
  SparseCholesky cholesky_;
  Eigen::VectorXd elastic_displacement_, base_, difference_;  // base_: of the kept state
  double largest_force_ = 0;                                  // [N]
};

template <int Dim>
void refuse_liquids(const InitialStress& initial, const Scene<Dim>& scene, const Materials<Dim>& materials) {
  for (const std::int32_t m : scene.particles.material)
    if (materials[static_cast<std::size_t>(m)].liquid())
      throw CaseError(
          initial.place,
          fmt::format("initial_stress: `method: equilibrium` knows no bodies of water, and '{}' is one; take "
                      "`method: elastic_equilibrium`",
                      scene.particles.material_names[static_cast<std::size_t>(m)]));
}

}  // namespace

template <int Dim>
void equilibrium(const InitialStress& initial, Scene<Dim>& scene, const StressUpdate<Dim>& stress,
                 const SkeletonLoads<Dim>& loads) {
  refuse_liquids(initial, scene, stress.materials());
  activate_blocks(scene);
  Equilibrium<Dim>(initial, scene, stress, loads).solve();
}

template void equilibrium<2>(const InitialStress&, Scene<2>&, const StressUpdate<2>&, const SkeletonLoads<2>&);
template void equilibrium<3>(const InitialStress&, Scene<3>&, const StressUpdate<3>&, const SkeletonLoads<3>&);

}  // namespace sluice
