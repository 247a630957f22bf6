/// StressTrial on displacements that are linear in space, whose stresses and forces are known in closed form: a stretch
/// with shear, turned by a large angle.
#include "physics/statics/stress_trial.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <Eigen/Eigenvalues>

#include "core/particles/fill.h"

namespace sluice {
namespace {

constexpr double lambda = 6e6, shear = 4e6;  // [Pa]; E = 10.4 MPa, nu = 0.3

template <int Dim>
using Tensor = Eigen::Matrix<double, Dim, Dim>;

/// A body away from all faces.
Case definition_of(int dimension, const std::string& shape, const std::string& scheme) {
  const bool flat = dimension == 2;
  return parse_case(
      fmt::format(
          "schema: 1\nphysics: total_stress\nend_time: 1 s\ngrid: {}\nmaterials: {{soil: {{model: linear_elastic, "
          "density: 1000 kg/m3, youngs_modulus: 10.4 MPa, poisson_ratio: 0.3}}}}\nbodies: [{{material: soil, "
          "box: {}}}]\nscheme: {{shape: {}, {}}}\n",
          flat ? "{min: [0 m, 0 m], max: [8 m, 8 m], cell: 0.5 m}"
               : "{min: [0 m, 0 m, 0 m], max: [5 m, 5 m, 5 m], cell: 0.5 m}",
          flat ? "{min: [3 m, 3 m], max: [5 m, 6 m]}" : "{min: [2 m, 2 m, 2 m], max: [3 m, 3.5 m, 3 m]}", shape,
          scheme),
      "trial.yaml");
}

/// Gives nodes the displacement (F - 1) x and finds the stress of each particle, and sum f x^T over the nodes.
template <int Dim>
class LinearMotion {
 public:
  LinearMotion(const std::string& shape, const std::string& scheme, Kinematics kinematics, const Tensor<Dim>& f)
      : definition_(definition_of(Dim, shape, scheme)), scene_(definition_), stress_(definition_) {
    stress_.declare(scene_.particles.columns, scene_.particles.mass);
    fill_bodies<Dim>(
        definition_, scene_.grid, [](int) { return 1000.0; }, scene_.particles);
    scene_.initialise_domains();
    activate_blocks(scene_);
    for (const double v : scene_.particles.columns.values(scene_.particles.volume)) volume += v;
    apply(kinematics, f);
  }

  double volume = 0;  ///< at the start [m3]
  bool sound = false;
  Tensor<Dim> moment;     ///< sum f x^T [N m]
  Tensor<Dim> kirchhoff;  ///< of the first particle: sigma V / V_0 [Pa]
  double spread = 0;      ///< of it over the particles [Pa]

 private:
  void apply(Kinematics kinematics, const Tensor<Dim>& f) {
    Unknowns<Dim> unknowns(scene_);
    std::vector<Index<Dim>> nodes;
    for (std::size_t p = 0; p < scene_.particles.size(); ++p) {
      const Stencil<Dim> s = stencil_at(scene_, p);
      for (int i = 0; i < s.count; ++i)
        if (unknowns.find(s.node[static_cast<std::size_t>(i)])[0] < 0) {
          nodes.push_back(s.node[static_cast<std::size_t>(i)]);
          unknowns.of(nodes.back());
        }
    }
    const auto place = [&](const Index<Dim>& node) {
      Eigen::Matrix<double, Dim, 1> x;
      for (int a = 0; a < Dim; ++a) x[a] = scene_.shape->node_position(scene_.grid, a, node[a]);
      return x;
    };
    std::vector<double> u(static_cast<std::size_t>(unknowns.count())), force(u.size());
    for (const auto& node : nodes) {
      const Eigen::Matrix<double, Dim, 1> moved = (f - Tensor<Dim>::Identity()) * place(node);
      for (int a = 0; a < Dim; ++a)
        u[static_cast<std::size_t>(unknowns.of(node)[static_cast<std::size_t>(a)])] = moved[a];
    }
    StressTrial<Dim> trial(scene_, stress_, unknowns, kinematics);
    trial.keep();
    const double share = 1 / scene_.particles.columns.data(scene_.particles.volume)[0];
    sound = trial.apply(u, 0.5, force);
    moment.setZero();
    for (const auto& node : nodes)
      for (int a = 0; a < Dim; ++a)
        moment.row(a) += force[static_cast<std::size_t>(unknowns.of(node)[static_cast<std::size_t>(a)])] * place(node);
    kirchhoff = stress(0) * share;
    for (std::size_t p = 0; p < scene_.particles.size(); ++p)
      spread = std::max(spread, (stress(p) * share - kirchhoff).cwiseAbs().maxCoeff());
    trial.restore();
    for (const double s : scene_.particles.columns.values(scene_.particles.stress, 0)) EXPECT_EQ(s, 0);
  }

  /// sigma V of a particle.
  Tensor<Dim> stress(std::size_t p) const {
    const Columns& columns = scene_.particles.columns;
    const auto at = [&](int c) { return columns.data(scene_.particles.stress, c)[p]; };
    Tensor<Dim> t;
    if constexpr (Dim == 2)
      t << at(0), at(3), at(3), at(1);
    else
      t << at(0), at(3), at(5), at(3), at(1), at(4), at(5), at(4), at(2);
    return t * columns.data(scene_.particles.volume)[p];
  }

  Case definition_;
  Scene<Dim> scene_;
  StressUpdate<Dim> stress_;
};

/// A rotation by 0.7 about an axis that is none of the grid's, after a stretch with shear.
template <int Dim>
Tensor<Dim> deformation() {
  if constexpr (Dim == 2) {
    Tensor<2> stretch;
    stretch << 1.15, 0.08, 0.08, 0.93;
    return Eigen::Rotation2D<double>(0.7).toRotationMatrix() * stretch;
  } else {
    Tensor<3> stretch;
    stretch << 1.15, 0.08, -0.03, 0.08, 0.93, 0.05, -0.03, 0.05, 1.04;
    return Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, -0.5).normalized()).toRotationMatrix() * stretch;
  }
}

/// lambda tr(e) 1 + 2 G e.
template <int Dim>
Tensor<Dim> elastic(const Tensor<Dim>& e) {
  return lambda * e.trace() * Tensor<Dim>::Identity() + 2 * shear * e;
}

// tau = lambda tr(ln V) 1 + 2 G ln V with the left stretch V; the forces do on any linear motion the work of the stress
// V_0 tau F^-T. To round-off, 1e-9 of G.
template <int Dim>
void expect_large() {
  const Tensor<Dim> f = deformation<Dim>();
  const Eigen::SelfAdjointEigenSolver<Tensor<Dim>> left(f * f.transpose());
  const Tensor<Dim> logarithm = left.eigenvectors() *
                                left.eigenvalues().unaryExpr([](double x) { return 0.5 * std::log(x); }).asDiagonal() *
                                left.eigenvectors().transpose();
  const Tensor<Dim> tau = elastic<Dim>(logarithm);
  for (const char* shape : {"linear", "ugimp", "quadratic_bspline", "cubic_bspline"})
    for (const char* f_bar : {"false", "true"}) {
      const LinearMotion<Dim> motion(shape, fmt::format("strain: hencky, f_bar: {}", f_bar), Kinematics::large, f);
      EXPECT_TRUE(motion.sound);
      EXPECT_LT(motion.spread, 1e-9 * shear) << shape;
      EXPECT_LT((motion.kirchhoff - tau).cwiseAbs().maxCoeff(), 1e-9 * shear) << shape;
      const Tensor<Dim> exact = motion.volume * tau * f.inverse().transpose();
      EXPECT_LT((motion.moment - exact).cwiseAbs().maxCoeff(), 1e-9 * shear * motion.volume) << shape << "\n"
                                                                                             << motion.moment << "\n"
                                                                                             << exact;
    }
}
TEST(StressTrial, OfALargeStretchAndTurnIn2D) { expect_large<2>(); }
TEST(StressTrial, OfALargeStretchAndTurnIn3D) { expect_large<3>(); }

// Small kinematics: Hooke's law for the symmetric part, whatever the turn, and volumes that stay.
template <int Dim>
void expect_small() {
  const Tensor<Dim> f = deformation<Dim>(), l = f - Tensor<Dim>::Identity();
  const Tensor<Dim> sigma = elastic<Dim>(0.5 * (l + l.transpose()));
  const LinearMotion<Dim> motion("quadratic_bspline", "strain: jaumann", Kinematics::small, f);
  EXPECT_TRUE(motion.sound);
  EXPECT_LT((motion.kirchhoff - sigma).cwiseAbs().maxCoeff(), 1e-9 * shear);
  EXPECT_LT((motion.moment - motion.volume * sigma).cwiseAbs().maxCoeff(), 1e-9 * shear * motion.volume);
}
TEST(StressTrial, OfASmallStrain) {
  expect_small<2>();
  expect_small<3>();
}

// A motion that turns the body inside out is no motion.
TEST(StressTrial, RefusesAnInversion) {
  const Tensor<2> f = Eigen::Vector2d(-0.5, 1).asDiagonal();
  for (const char* strain : {"jaumann", "hencky"})
    EXPECT_FALSE(LinearMotion<2>("quadratic_bspline", fmt::format("strain: {}", strain), Kinematics::large, f).sound)
        << strain;
}

}  // namespace
}  // namespace sluice
