/// A physics for manufactured solutions: neo-Hookean material under a body force that is given at every place and time.
/// It measures mappings and transfers and is made of the same stages as the others, stresses updated last. Materials of
/// the case give nothing but their name.
#pragma once

#include <Eigen/Dense>
#include <limits>

#include "core/simulation/energy.h"
#include "core/simulation/guard.h"
#include "core/simulation/physics_module.h"
#include "core/simulation/velocity_filter.h"
#include "physics/exact/manufactured.h"

namespace sluice {

template <int Dim, class Solution>
class ManufacturedPhysics final : public PhysicsModule<Dim> {
 public:
  using Matrix = Eigen::Matrix<double, Dim, Dim>;
  explicit ManufacturedPhysics(const Solution& solution) : solution_(solution), material_(solution.material()) {}

  void declare(Particles& particles) override {
    deformation_ = particles.columns.declare(
        {"deformation_gradient", "1", Dim * Dim, Role::state, "Deformation gradient, row by row.", false});
    force_ = particles.columns.declare({"body_force", "N", Dim, Role::derived, "Body force.", false});
  }
  double density(int) const override { return material_.density; }
  void initialise(Scene<Dim>& scene) override {
    Columns& columns = scene.particles.columns;
    for_all(scene, [&](std::size_t p, const Vector<Dim>& X) {
      const auto u = solution_.displacement(X, 0), v = solution_.velocity(X, 0);
      const Matrix f = Matrix::Identity() + slopes(X, [&](const auto& at) { return solution_.displacement(at, 0); });
      const Matrix rate = slopes(X, [&](const auto& at) { return solution_.velocity(at, 0); }) * f.inverse();
      for (int a = 0; a < Dim; ++a) {
        columns.data(scene.particles.position, a)[p] += u[static_cast<std::size_t>(a)];
        columns.data(scene.particles.velocity, a)[p] = v[static_cast<std::size_t>(a)];
      }
      for (int c = 0; c < Dim * Dim; ++c) {
        columns.data(deformation_, c)[p] = f(c / Dim, c % Dim);
        if (scene.transfer.affine) columns.data(scene.affine, c)[p] = rate(c / Dim, c % Dim);
      }
      columns.data(scene.particles.volume)[p] *= f.determinant();
      set_stress(scene, p, f);
    });
  }

  std::vector<TimeStepLimit> hard_limits(const Scene<Dim>&) const override {
    return {{std::numeric_limits<double>::infinity(), "none"}};
  }
  std::vector<TimeStepLimit> time_step_limits(const Scene<Dim>& scene) const override { return hard_limits(scene); }

  void step(Scene<Dim>& scene, double dt) override {
    activate_blocks(scene);
    set_body_force(scene);
    scatter(scene, ScatterWhat::momentum);
    for_each_block(scene, workspaces_, [&](std::size_t b, const auto& block, Workspace<Dim>&) {
      ScatterInput<Dim> in = scene.scatter_input(block);
      for (int a = 0; a < Dim; ++a) in.body_force[a] = scene.particles.columns.data(force_, a);
      scene.shape->scatter(ScatterWhat::force, in, 0, nullptr, scene.nodes.force_tile(b));
    });
    advance_nodes(scene, scene.kick(dt), true, true);
    Sweep<Dim> sweep(scene.blocks);
    filter_.add(sweep, scene);
    sweep.run();
    gather(scene, dt);
  }

  void store(Archive&) const override {}
  void restore(const Archive&) override {}
  std::vector<std::pair<std::string, double>> energies(const Scene<Dim>& scene) const override {
    return {{"kinetic", kinetic_energy(scene)}};
  }
  std::vector<std::pair<std::string, Node>> resolved_sections() const override { return {}; }

 private:
  /// The gradient of a vector field by central differences: errors of 1e-10 of it.
  template <class Field>
  static Matrix slopes(const Vector<Dim>& X, const Field& field) {
    constexpr double step = 1e-6;
    Matrix gradient;
    for (int b = 0; b < Dim; ++b) {
      Vector<Dim> above = X, below = X;
      above[static_cast<std::size_t>(b)] += step;
      below[static_cast<std::size_t>(b)] -= step;
      const auto up = field(above), down = field(below);
      for (std::size_t a = 0; a < Dim; ++a) gradient(static_cast<int>(a), b) = (up[a] - down[a]) / (2 * step);
    }
    return gradient;
  }

  template <class Body>
  static void for_all(Scene<Dim>& scene, const Body& body) {
    parallel_for(scene.particles.size(), [&](std::size_t p) {
      Vector<Dim> X;
      for (int a = 0; a < Dim; ++a) X[a] = scene.particles.columns.data(scene.particles.initial_position, a)[p];
      body(p, X);
    });
  }

  void set_body_force(Scene<Dim>& scene) {
    for_all(scene, [&](std::size_t p, const Vector<Dim>& X) {
      const auto b = solution_.body_force(X, scene.time);
      const double mass = scene.particles.columns.data(scene.particles.mass)[p];
      for (int a = 0; a < Dim; ++a) scene.particles.columns.data(force_, a)[p] = mass * b[a];
    });
  }

  void gather(Scene<Dim>& scene, double dt) {
    const MotionUpdate<Dim> update = motion_update(scene, dt, scene.particles.position, scene.domain);
    std::vector<MotionReport> reports(scene.blocks.particle_blocks().size());
    for_each_block(scene, workspaces_, [&](std::size_t b, const ParticleBlock<Dim>& block, Workspace<Dim>& work) {
      scene.nodes.load_motion(scene.blocks, b, work.motion_tile.data());
      MotionUpdate<Dim> own = update;
      own.strain = &work.strain;
      reports[b] = scene.shape->gather_motion(scene.view(block), work.motion_tile.data(), own);
      for (std::uint32_t p = block.begin; p < block.end; ++p) deform(scene, p, work.strain, p - block.begin);
    });
    scene.motion = {};
    for (const MotionReport& r : reports) {
      scene.motion.largest_travel = std::max(scene.motion.largest_travel, r.largest_travel);
      scene.motion.finite = scene.motion.finite && r.finite;
      scene.motion.inside = scene.motion.inside && r.inside;
    }
    scene.travelled += scene.motion.largest_travel;
    if (!scene.motion.finite) throw_first_bad_particle(scene);
  }

  /// sigma = [mu (F F^T - I) + lambda ln J I] / J
  void set_stress(Scene<Dim>& scene, std::size_t p, const Matrix& f) {
    Columns& columns = scene.particles.columns;
    const double j = f.determinant(), pressure = material_.lambda * std::log(j) / j;
    const Matrix s = material_.shear / j * (f * f.transpose() - Matrix::Identity());
    for (int a = 0; a < Dim; ++a) columns.data(scene.particles.stress, a)[p] = s(a, a) + pressure;
    for (int k = 0; k < spin_components<Dim>; ++k)
      columns.data(scene.particles.stress, 3 + k)[p] = s(pairs[k][0], pairs[k][1]);
  }

  /// F <- (I + dt grad v) F
  void deform(Scene<Dim>& scene, std::uint32_t p, const StrainIncrements<Dim>& increment, std::uint32_t at) {
    Columns& columns = scene.particles.columns;
    Matrix step = Matrix::Zero(), f;
    for (int a = 0; a < Dim; ++a) step(a, a) = increment.strain[a][at];
    for (int k = 0; k < spin_components<Dim>; ++k) {
      const int a = pairs[k][0], b = pairs[k][1];
      const double spin = (Dim == 2 ? -1 : 1) * increment.rotation[k][at];  // w_ab
      step(a, b) = increment.strain[3 + k][at] + spin;
      step(b, a) = increment.strain[3 + k][at] - spin;
    }
    for (int c = 0; c < Dim * Dim; ++c) f(c / Dim, c % Dim) = columns.data(deformation_, c)[p];
    const double old_j = f.determinant();
    // Of second order, and a rotation keeps the volume.
    f = ((Matrix::Identity() - step / 2).inverse() * (Matrix::Identity() + step / 2) * f).eval();
    for (int c = 0; c < Dim * Dim; ++c) columns.data(deformation_, c)[p] = f(c / Dim, c % Dim);
    columns.data(scene.particles.volume)[p] *= f.determinant() / old_j;
    set_stress(scene, p, f);
  }

  static constexpr int pairs[3][2] = {{0, 1}, {1, 2}, {0, 2}};  // of shear components

  Solution solution_;
  exact::NeoHookean material_;
  ColumnId deformation_, force_;
  VelocityFilter<Dim> filter_;
  std::vector<Workspace<Dim>> workspaces_;
};

template <int Dim, class Solution>
auto manufactured(const Solution& solution) {
  return [solution](const Case&) { return std::make_unique<ManufacturedPhysics<Dim, Solution>>(solution); };
}

}  // namespace sluice
