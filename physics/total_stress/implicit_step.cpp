#include "physics/total_stress/implicit_step.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/case/problems.h"
#include "core/simulation/guard.h"
#include "core/simulation/physics_module.h"
#include "physics/statics/ghost_penalty.h"
#include "solvers/sparse_cholesky.h"

namespace sluice {

namespace {

std::span<double> span_of(Eigen::VectorXd& v) { return {v.data(), static_cast<std::size_t>(v.size())}; }

/// What a face has that implicit steps do not know; null if nothing.
const char* unknown_in(const FaceCase& face) {
  if (face.absorbing) return "absorbing face";
  if (face.normal == FaceCase::Normal::contact) return "contact";
  if (face.normal != FaceCase::Normal::free && face.tangential == FaceCase::Tangential::friction) return "friction";
  return face.velocity.empty() ? nullptr : "moving face";
}

/// What implicit steps cannot do, or need.
void check(const Case& definition) {
  const Node* const scheme = definition.source.find("scheme");
  const Node* const key = scheme == nullptr ? nullptr : scheme->find("integration");
  const Place place = key == nullptr ? definition.source.place : key->place;
  const std::string& word = definition.scheme.integration;
  Problems problems;
  if (!definition.scheme.fixed_time_step)
    problems.add(place,
                 fmt::format("scheme.integration: {} needs `time_step`: nothing limits its steps, so none can be "
                             "computed; for example `time_step: 0.1 s`",
                             word));
  for (const auto& [name, face] : definition.faces)
    if (const char* const what = unknown_in(face))
      problems.add(place,
                   fmt::format("scheme.integration: {} knows no {}, and `boundaries.{}` has it; take free, roller "
                               "or fixed",
                               word, what, name));
  if (!definition.obstacles.empty())
    problems.add(definition.obstacles.front().place,
                 fmt::format("obstacles: `integration: {}` knows none; take `integration: explicit`", word));
  if (word == "implicit_newmark" && definition.scheme.transfer == "xpic")
    problems.add(place,
                 "scheme.integration: implicit_newmark does not go with `transfer: xpic`; take flip, apic or tpic");
  if (word == "implicit_newmark" && definition.scheme.gravity_ramp > 0)
    problems.add(place, "scheme.gravity_ramp is for `integration: implicit_static` only");
  problems.throw_if_any();
}

}  // namespace

/// F(u) of one step, eqs. (29a) and (29b).
template <int Dim>
struct ImplicitStep<Dim>::Forces {
  Unknowns<Dim> unknowns;
  ElasticOperator<Dim> elastic;
  StressTrial<Dim> trial;
  Eigen::SparseMatrix<double> ghost;  // the lower triangle
  SparseCholesky cholesky;
  double dt;
  Eigen::VectorXd outside;          // forces of loads and gravity [N]
  Eigen::VectorXd inside_at_start;  // of the stresses before the step
  Eigen::VectorXd velocity;         // of the nodes before the step; empty without inertia
  double inertia = 0;               // 4 / dt^2, or 0
  double scale = 0;                 // [N]

  Forces(Scene<Dim>& scene, const StressUpdate<Dim>& stress, const SkeletonLoads<Dim>& loads, double step,
         bool with_inertia)
      : unknowns(scene),
        elastic(scene, stress.materials(), loads, unknowns),
        trial(scene, stress, unknowns, Kinematics::large),
        ghost(ghost_penalty(scene, stress.materials(), unknowns, scene.scheme.ghost_penalty)),
        dt(step) {
    if (with_inertia) {
      scatter(scene, ScatterWhat::momentum);
      velocity_from_momentum(scene, Moment::before);
      velocity.resize(unknowns.count());
      trial.get_velocity(span_of(velocity));
      inertia = 4 / (dt * dt);
    }
    trial.keep();
    Eigen::VectorXd none = Eigen::VectorXd::Zero(unknowns.count());
    inside_at_start.resize(unknowns.count());
    trial.apply(span_of(none), dt, span_of(inside_at_start));
    outside = elastic.force();
  }

  void prepare() {
    cholesky.factorize(elastic.matrix(inertia) + ghost);
    const double share = inertia > 0 ? 2 : 1;
    scale = share * std::max(outside.cwiseAbs().maxCoeff(), inside_at_start.cwiseAbs().maxCoeff());
    if (inertia > 0)
      scale = std::max(scale, (inertia * dt * elastic.mass().cwiseProduct(velocity)).cwiseAbs().maxCoeff());
  }

  bool residual(std::span<const double> u, std::span<double> f) {
    const Eigen::Map<const Eigen::VectorXd> now(u.data(), static_cast<Eigen::Index>(u.size()));
    Eigen::Map<Eigen::VectorXd> out(f.data(), static_cast<Eigen::Index>(f.size()));
    if (!trial.apply(u, dt, f)) return false;
    out += ghost.template selfadjointView<Eigen::Lower>() * now;
    if (inertia > 0)  // which holds what nothing else holds
      out += inside_at_start - 2 * outside + inertia * elastic.mass().cwiseProduct(now - dt * velocity);
    else
      out += elastic.spring().cwiseProduct(now) - outside;
    return true;
  }
};

template <int Dim>
ImplicitStep<Dim>::ImplicitStep(const Case& definition) : kind_(kind_of(definition)) {
  if (active()) check(definition);
}

template <int Dim>
typename ImplicitStep<Dim>::Kind ImplicitStep<Dim>::kind_of(const Case& definition) {
  if (definition.scheme.integration == "implicit_static") return Kind::statics;
  return definition.scheme.integration == "implicit_newmark" ? Kind::newmark : Kind::none;
}

template <int Dim>
void ImplicitStep<Dim>::declare(Columns& particles) {
  if (kind_ == Kind::newmark)
    spare_velocity_ = particles.declare(
        {"spare_velocity", "m/s", Dim, Role::derived, "Mean velocity of the step, by which particles move.", false});
}

template <int Dim>
void ImplicitStep<Dim>::advance(Scene<Dim>& scene, const StressUpdate<Dim>& stress, const SkeletonLoads<Dim>& loads,
                                double dt) {
  Forces forces(scene, stress, loads, dt, kind_ == Kind::newmark);
  if (forces.unknowns.count() == 0) return;
  if (scene.time + dt < scene.scheme.gravity_ramp)
    forces.outside -= (1 - (scene.time + dt) / scene.scheme.gravity_ramp) * forces.elastic.weight();
  Eigen::VectorXd u = Eigen::VectorXd::Zero(forces.unknowns.count());
  if (kind_ == Kind::newmark) u = dt * forces.velocity;
  solve(scene, forces, u);
  if (kind_ == Kind::newmark)
    move_with_inertia(scene, forces, u);
  else
    move_statically(scene, dt);
}

template <int Dim>
void ImplicitStep<Dim>::solve(Scene<Dim>& scene, Forces& forces, Eigen::VectorXd& u) {
  forces.prepare();
  evaluations_ = 0;
  Eigen::VectorXd f(u.size());
  if (forces.scale > 0) {
    const NonlinearProblem problem{
        [&](std::span<const double> at, std::span<double> out) { return forces.residual(at, out); },
        [&](std::span<const double> r, std::span<double> x) { forces.cholesky.solve(r, x); }};
    NonlinearOptions options;
    options.tolerance = scene.scheme.tolerance;
    options.scale = forces.scale;
    options.step = 1e-3 * scene.grid.smallest_cell();
    const NonlinearReport report = solve_nonlinear(problem, span_of(u), options);
    evaluations_ = report.evaluations;
    if (!report.converged) {
      Eigen::Index worst = 0;
      if (forces.residual(span_of(u), span_of(f))) f.cwiseAbs().maxCoeff(&worst);
      throw PhysicsError(fmt::format(
          "no equilibrium was found at the end of step {} at time {:g} s: forces stay out of balance by {:.2g} of the "
          "largest on a node (scheme.tolerance: {:.2g}), most near {}. The strength may not carry the loads of that "
          "time: with inertia (`integration: explicit` or implicit_newmark) the failure can be computed. If it does, "
          "take a smaller `time_step`, or raise `tolerance`",
          scene.step + 1, scene.time + forces.dt, report.residual, scene.scheme.tolerance,
          place_of(scene, forces.unknowns, static_cast<int>(worst))));
    }
  }
  forces.trial.apply(span_of(u), forces.dt, span_of(f));  // leaves stresses and nodes at the solution
}

// ---- the motion of the particles, eqs. (29d) and (29e) ----

/// The nodes have the velocity u / dt.
template <int Dim>
void ImplicitStep<Dim>::move_statically(Scene<Dim>& scene, double dt) {
  MotionUpdate<Dim> update = motion_update(scene, dt, scene.particles.position, scene.domain);
  update.shares = {0, 0, 1};  // without inertia nothing is left of the velocity before
  gather(scene, update);
}

template <int Dim>
void ImplicitStep<Dim>::move_with_inertia(Scene<Dim>& scene, Forces& forces, const Eigen::VectorXd& u) {
  const double dt = forces.dt;
  Eigen::VectorXd after = 2 / dt * u - forces.velocity, change = after - forces.velocity;
  forces.trial.set_motion(span_of(after), 1, span_of(change));
  gather(scene, motion_update(scene, 0, scene.particles.position, {}));  // velocities alone
  const double fastest = scene.motion.largest_speed_squared;

  Eigen::VectorXd mean = u;
  forces.trial.set_motion(span_of(mean), 1 / dt);
  MotionUpdate<Dim> update = motion_update(scene, dt, scene.particles.position, scene.domain);
  for (int a = 0; a < Dim; ++a) update.velocity[a] = scene.particles.columns.data(spare_velocity_, a);
  update.affine = {};
  update.shares = {0, 0, 1};
  gather(scene, update);
  scene.motion.largest_speed_squared = fastest;
}

template <int Dim>
void ImplicitStep<Dim>::gather(Scene<Dim>& scene, const MotionUpdate<Dim>& update) {
  const auto timing = scene.clock.time(Stage::gather);
  std::vector<MotionReport> reports(scene.blocks.particle_blocks().size());
  for_each_block(scene, workspaces_, [&](std::size_t b, const ParticleBlock<Dim>& block, Workspace<Dim>& work) {
    scene.nodes.load_motion(scene.blocks, b, work.motion_tile.data());
    reports[b] = scene.shape->gather_motion(scene.view(block), work.motion_tile.data(), update);
  });
  scene.motion = {};
  for (const MotionReport& r : reports) {
    scene.motion.largest_speed_squared = std::max(scene.motion.largest_speed_squared, r.largest_speed_squared);
    scene.motion.largest_travel = std::max(scene.motion.largest_travel, r.largest_travel);
    scene.motion.finite = scene.motion.finite && r.finite;
    scene.motion.inside = scene.motion.inside && r.inside;
  }
  scene.travelled += scene.motion.largest_travel;
  if (!scene.motion.finite) throw_first_bad_particle(scene);
}

template class ImplicitStep<2>;
template class ImplicitStep<3>;

}  // namespace sluice
