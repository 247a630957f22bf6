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

/// Largest force of a weak spring on a node that is taken for one, and not for what holds the body, over the largest
/// force on a node. Where nothing is loose it comes to 1e-8 times some powers of the number of cells.
constexpr double nothing_holds = 1e-5;

template <int Dim>
std::string no_equilibrium(const Scene<Dim>& scene, double dt) {
  return fmt::format("no equilibrium was found at the end of step {} at time {:g} s, {:.3g} s after the one before",
                     scene.step + 1, scene.time + dt, dt);
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
    if (face.absorbing)
      problems.add(place,
                   fmt::format("scheme.integration: {} knows no absorbing face, and `boundaries.{}` is one; take "
                               "`integration: explicit`, or a face at a distance",
                               word, name));
  if (word == "implicit_newmark" && definition.scheme.transfer == "xpic")
    problems.add(place,
                 "scheme.integration: implicit_newmark does not go with `transfer: xpic`; take flip, apic or tpic");
  if (word == "implicit_newmark" && definition.scheme.gravity_ramp > 0)
    problems.add(place, "scheme.gravity_ramp is for `integration: implicit_static` only");
  problems.throw_if_any();
}

}  // namespace

/// F(u) of one step, eqs. (29a), (29b), (29f) and (29g). Vectors are of all components of the nodes that particles
/// reach, or of those that are free, in their order.
template <int Dim>
struct ImplicitStep<Dim>::Forces {
  Unknowns<Dim> unknowns;
  ElasticOperator<Dim> elastic;
  StressTrial<Dim> trial;
  Eigen::SparseMatrix<double> ghost;  // the lower triangle
  SparseCholesky cholesky;
  double dt;
  double share;                     // of the forces that F has, over those of the step: 1, or 2 with inertia
  double inertia = 0;               // 4 / dt^2, or 0
  Eigen::VectorXd velocity;         // of the nodes before the step; zero without inertia
  Eigen::VectorXd outside;          // forces of loads and gravity [N]
  Eigen::VectorXd loads;            // those of loads alone, times `share`
  Eigen::VectorXd inside_at_start;  // of the stresses before the step
  Eigen::VectorXd inside;           // of those of the last trial
  SurfaceLaws<Dim> laws;
  std::vector<int> free;      // the components that are not given
  Eigen::VectorXd u, f;       // of all components
  Eigen::VectorXd elastic_u;  // of the free ones, where nothing yields: the guess
  double smallest_scale = 0;  // [N]

  Forces(Scene<Dim>& scene, const StressUpdate<Dim>& stress, const SkeletonLoads<Dim>& skeleton_loads, double step,
         bool with_inertia)
      : unknowns(scene, Fixed::none),
        elastic(scene, stress.materials(), skeleton_loads, unknowns,
                stress.f_bar() ? Dilation::of_cells : Dilation::at_points),
        trial(scene, stress, unknowns, Kinematics::large),
        ghost(ghost_penalty(scene, stress.materials(), unknowns, scene.scheme.ghost_penalty)),
        dt(step),
        share(with_inertia ? 2 : 1),
        inertia(with_inertia ? 4 / (dt * dt) : 0),
        velocity(Eigen::VectorXd::Zero(unknowns.count())),
        outside(elastic.force()),
        loads(share * (elastic.force() - elastic.weight())),
        laws(scene, unknowns, step, share) {
    if (with_inertia) {
      scatter(scene, ScatterWhat::momentum);
      velocity_from_momentum(scene, Moment::before);
      trial.get_velocity(span_of(velocity));
    }
    trial.keep();
    u = f = inside_at_start = inside = Eigen::VectorXd::Zero(unknowns.count());
    trial.apply(span_of(u), dt, span_of(inside_at_start));
    for (int i = 0; i < unknowns.count(); ++i)
      if (!laws.given(i)) free.push_back(i);
  }

  /// Factorizes the matrix of the free components, and finds the guess.
  void prepare(double tolerance) {
    const Eigen::SparseMatrix<double> all = elastic.matrix(inertia) + ghost;
    const Eigen::VectorXd diagonal = all.diagonal();
    std::vector<Eigen::Triplet<double>> stiffening, entries;
    laws.stiffen(diagonal, stiffening);
    std::vector<int> number(static_cast<std::size_t>(unknowns.count()), -1);
    for (std::size_t k = 0; k < free.size(); ++k) number[static_cast<std::size_t>(free[k])] = static_cast<int>(k);
    const auto add = [&](Eigen::Index row, Eigen::Index column, double value) {
      const int r = number[static_cast<std::size_t>(row)], c = number[static_cast<std::size_t>(column)];
      if (r >= 0 && c >= 0) entries.emplace_back(r, c, value);
    };
    for (Eigen::Index column = 0; column < all.outerSize(); ++column)
      for (Eigen::SparseMatrix<double>::InnerIterator entry(all, column); entry; ++entry)
        add(entry.row(), entry.col(), entry.value());
    for (const auto& entry : stiffening) add(entry.row(), entry.col(), entry.value());
    const auto size = static_cast<Eigen::Index>(free.size());
    Eigen::SparseMatrix<double> matrix(size, size);
    matrix.setFromTriplets(entries.begin(), entries.end());
    elastic_u = Eigen::VectorXd::Zero(size);
    take(elastic_u);
    f = share_of_start() + all.selfadjointView<Eigen::Lower>() * u;
    laws.impose(span_of(u), loads, span_of(f));
    if (size > 0) {
      cholesky.factorize(matrix);
      elastic_u = -cholesky.solve(of_free(f));
    }
    take(elastic_u);
    // What round-off leaves of forces must be out of the way of the tolerance.
    smallest_scale = 1e-13 / tolerance * diagonal.maxCoeff() * u.cwiseAbs().maxCoeff();
    inside = inside_at_start + all.selfadjointView<Eigen::Lower>() * u;
  }

  /// What all free components are with these values, and given ones with theirs.
  void take(const Eigen::Ref<const Eigen::VectorXd>& values) {
    for (int i = 0; i < unknowns.count(); ++i) u[i] = laws.given(i) ? laws.displacement(i) : 0;
    for (std::size_t k = 0; k < free.size(); ++k) u[free[k]] = values[static_cast<Eigen::Index>(k)];
  }
  Eigen::VectorXd of_free(const Eigen::VectorXd& all) const {
    Eigen::VectorXd some(static_cast<Eigen::Index>(free.size()));
    for (std::size_t k = 0; k < free.size(); ++k) some[static_cast<Eigen::Index>(k)] = all[free[k]];
    return some;
  }

  /// Forces out of balance without displacements, but for those of stresses that change.
  Eigen::VectorXd share_of_start() const {
    Eigen::VectorXd start = inside_at_start - share * outside;
    if (inertia > 0) start += inside_at_start - inertia * dt * elastic.mass().cwiseProduct(velocity);
    return start;
  }

  /// The size of the forces of the step [N], with those of the last trial.
  double scale() const {
    double largest = std::max(outside.cwiseAbs().maxCoeff(), inside_at_start.cwiseAbs().maxCoeff());
    largest = share * std::max(largest, inside.cwiseAbs().maxCoeff());
    if (inertia > 0)
      largest = std::max(largest, (inertia * dt * elastic.mass().cwiseProduct(velocity)).cwiseAbs().maxCoeff());
    return std::max(largest, smallest_scale);
  }

  /// The largest force of the weak springs on a node [N], at the last trial.
  double held_by_springs() const {
    if (inertia > 0 || free.empty()) return 0;
    return of_free(elastic.spring()).cwiseProduct(of_free(u) - elastic_u).cwiseAbs().maxCoeff();
  }

  bool residual(std::span<const double> free_u, std::span<double> free_f) {
    take(Eigen::Map<const Eigen::VectorXd>(free_u.data(), static_cast<Eigen::Index>(free_u.size())));
    if (!trial.apply(span_of(u), dt, span_of(inside))) return false;
    f = inside - share * outside + ghost.template selfadjointView<Eigen::Lower>() * u;
    if (inertia > 0)  // which holds what nothing else holds
      f += inside_at_start + inertia * elastic.mass().cwiseProduct(u - dt * velocity);
    else
      for (std::size_t k = 0; k < free.size(); ++k)
        f[free[k]] += elastic.spring()[free[k]] * (u[free[k]] - elastic_u[static_cast<Eigen::Index>(k)]);
    laws.impose(span_of(u), loads, span_of(f));
    for (std::size_t k = 0; k < free.size(); ++k) free_f[k] = f[free[k]];
    return true;
  }
};

template <int Dim>
ImplicitStep<Dim>::ImplicitStep(const Case& definition) : kind_(kind_of(definition)) {
  if (!active()) return;
  check(definition);
  const auto names = face_names(Dim);
  for (std::size_t f = 0; f < names.size(); ++f)
    if (const auto face = definition.faces.find(names[f]);
        face != definition.faces.end() && face->second.normal != FaceCase::Normal::free)
      face_force_.push_back({f, names[f], {}});
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
  // Velocities are those of the ends of steps, and not of their middles as in explicit ones.
  scene.faces.begin_step(scene.time, scene.time + dt);
  scene.obstacles.begin_step(scene.time, scene.time, scene.time + dt);
  Forces forces(scene, stress, loads, dt, kind_ == Kind::newmark);
  if (forces.unknowns.count() == 0) return;  // nothing is left on the grid
  if (scene.time + dt < scene.scheme.gravity_ramp)
    forces.outside -= (1 - (scene.time + dt) / scene.scheme.gravity_ramp) * forces.elastic.weight();
  solve(scene, forces);
  note_forces(scene, forces.laws.forces());
  if (kind_ == Kind::newmark)
    move_with_inertia(scene, forces);
  else
    move_statically(scene, dt);
}

template <int Dim>
void ImplicitStep<Dim>::solve(Scene<Dim>& scene, Forces& forces) {
  forces.prepare(scene.scheme.tolerance);
  evaluations_ = 0;
  Eigen::VectorXd u = forces.elastic_u, f(u.size());
  const NonlinearProblem problem{
      [&](std::span<const double> at, std::span<double> out) { return forces.residual(at, out); },
      [&](std::span<const double> r, std::span<double> x) { forces.cholesky.solve(r, x); }};
  NonlinearOptions options;
  options.tolerance = scene.scheme.tolerance;
  options.step = 1e-3 * scene.grid.smallest_cell();
  // Forces of stresses count as they come out, and not as they would be if nothing yielded.
  double residual = 0, scale = forces.scale();
  if (scale == 0) forces.residual(span_of(u), span_of(f));
  while (scale > 0) {
    options.scale = scale;
    const NonlinearReport report = solve_nonlinear(problem, span_of(u), options);
    evaluations_ += report.evaluations;
    if (!report.converged) refuse(scene, forces, u, report.residual);
    residual = report.residual * options.scale;
    forces.residual(span_of(u), span_of(f));  // leaves stresses and nodes at the solution
    scale = forces.scale();
    if (residual <= options.tolerance * scale) break;
  }
  if (forces.held_by_springs() > nothing_holds * scale) refuse_loose(scene, forces);
}

template <int Dim>
void ImplicitStep<Dim>::refuse(const Scene<Dim>& scene, Forces& forces, Eigen::VectorXd& u, double residual) {
  Eigen::VectorXd f(u.size());
  Eigen::Index worst = 0;
  const bool defined = forces.residual(span_of(u), span_of(f));
  if (defined) f.cwiseAbs().maxCoeff(&worst);
  forces.trial.restore();
  const std::string step = no_equilibrium(scene, forces.dt);
  if (!defined)
    throw StepNotSolved(step +
                        ": a material point would be turned inside out, or its stress is not finite; what moves "
                        "a face or an obstacle, or loads, come too fast for `time_step`");
  throw StepNotSolved(fmt::format(
      "{}: forces stay out of balance by {:.2g} of the largest on a node (scheme.tolerance: {:.2g}), most near {}. The "
      "strength, or friction, may not carry the loads of that time: with inertia (`integration: explicit` or "
      "implicit_newmark) the failure can be computed. If they do, take a smaller `time_step`, or raise `tolerance`",
      step, residual, scene.scheme.tolerance,
      place_of(scene, forces.unknowns, forces.free[static_cast<std::size_t>(worst)])));
}

template <int Dim>
void ImplicitStep<Dim>::refuse_loose(const Scene<Dim>& scene, Forces& forces) {
  forces.trial.restore();
  throw StepNotSolved(fmt::format(
      "{}: nothing holds a body, or a part of it; it would move by {:.3g} m. Friction may not suffice: with "
      "inertia (`integration: explicit` or implicit_newmark) its motion can be computed",
      no_equilibrium(scene, forces.dt), forces.u.cwiseAbs().maxCoeff()));
}

template <int Dim>
void ImplicitStep<Dim>::note_forces(Scene<Dim>& scene, const std::vector<Vector<Dim>>& forces) {
  const auto obstacles = static_cast<std::ptrdiff_t>(scene.obstacles.count());
  scene.obstacles.set_forces({forces.begin(), forces.begin() + obstacles});
  for (FaceForce& face : face_force_) face.force = forces[static_cast<std::size_t>(obstacles) + face.face];
}

template <int Dim>
std::vector<std::pair<std::string, double>> ImplicitStep<Dim>::numbers() const {
  static const char* const axes[] = {"x", "y", "z"};
  std::vector<std::pair<std::string, double>> all = {{"evaluations", evaluations_}};
  for (const FaceForce& face : face_force_)
    for (int a = 0; a < Dim; ++a)
      all.emplace_back(fmt::format("face_{}_force_{}_N", face.name, axes[a]), face.force[a]);
  return all;
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
void ImplicitStep<Dim>::move_with_inertia(Scene<Dim>& scene, Forces& forces) {
  const double dt = forces.dt;
  Eigen::VectorXd after = 2 / dt * forces.u - forces.velocity;
  forces.laws.stop(span_of(after));  // the formula would let what a surface has stopped swing about its velocity
  Eigen::VectorXd change = after - forces.velocity;
  forces.trial.set_motion(span_of(after), 1, span_of(change));
  gather(scene, motion_update(scene, 0, scene.particles.position, {}));  // velocities alone
  const double fastest = scene.motion.largest_speed_squared;

  forces.trial.set_motion(span_of(forces.u), 1 / dt);
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
