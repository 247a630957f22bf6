/// Elasticity in logarithmic strain through Materials::update_stress, beside the rate form. Sources: Hencky (1928);
/// Xiao & Chen (2002), Acta Mechanica 157; Dienes (1979), Acta Mechanica 32, for the Jaumann rate in simple shear.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>
#include <string>

#include "core/case/case_tree.h"
#include "physics/materials/materials.h"
#include "tests/unit/material_paths.h"

namespace sluice {
namespace {

constexpr double shear = 1e6 / 2.6, lambda = 0.3e6 / (1.3 * 0.4), modulus = lambda + 2 * shear;
const std::string elastic = "model: linear_elastic, density: 1000 kg/m3, youngs_modulus: 1 MPa";

Case case_with(const std::string& material, const std::string& strain) {
  Case c;
  c.materials.emplace_back("soil", read_yaml_text("{" + material + "}", "soil.yaml"));
  c.scheme.strain = strain;
  c.grid.cell = {1, 1};
  return c;
}

/// One point, deformed by given increments of the deformation gradient.
template <int Dim>
class Specimen {
 public:
  Specimen(const std::string& material, const std::string& strain)
      : materials_(case_with(material, strain)), particles_(Dim) {
    materials_.declare(particles_.columns);
    particles_.resize(1);
    particles_.material_names = {"soil"};
    particles_.columns.data(particles_.mass)[0] = 2;
    particles_.columns.data(particles_.volume)[0] = 2e-3;
    GridGeometry<Dim> grid;
    grid.max.fill(8);
    grid.cell.fill(1);
    grid.cells.fill(8);
    blocks_.sort(particles_, grid, 1);
  }

  /// The increment of the displacement gradient whose midpoint form (24b) is `f`.
  void deform(const Eigen::Matrix3d& f) {
    const Eigen::Matrix3d one = Eigen::Matrix3d::Identity();
    const Eigen::Matrix3d gradient = 2 * (f - one) * (f + one).inverse();
    Eigen::Matrix3d e = 0.5 * (gradient + gradient.transpose()), w = 0.5 * (gradient - gradient.transpose());
    std::array<double, 6> strain = {e(0, 0), e(1, 1), e(2, 2), e(0, 1), e(1, 2), e(0, 2)};
    std::array<double, 3> spin = {w(0, 1), w(1, 2), w(0, 2)};
    if (Dim == 2) spin[0] = w(1, 0);
    StrainIncrements<Dim> increments;
    for (std::size_t c = 0; c < increments.strain.size(); ++c) increments.strain[c] = &strain[c];
    for (std::size_t c = 0; c < increments.rotation.size(); ++c) increments.rotation[c] = &spin[c];
    const auto report = materials_.update_stress(particles_, particles_.mass, blocks_, blocks_.particle_blocks()[0],
                                                 increments, 1e-3, 0.0);
    EXPECT_TRUE(report.sound);
  }
  /// From the identity to `f` in `steps` steps along F = exp(t log f): the same factor each time.
  void simple_shear(double gamma, int steps) {
    Eigen::Matrix3d f = Eigen::Matrix3d::Identity();
    f(0, 1) = gamma / steps;
    for (int n = 0; n < steps; ++n) deform(f);
  }

  Eigen::Matrix3d stress() const {
    std::array<double, symmetric_components<Dim>> s;
    for (std::size_t c = 0; c < s.size(); ++c)
      s[c] = particles_.columns.data(particles_.stress, static_cast<int>(c))[0];
    return as_matrix<Dim>(s);
  }
  void set_stress(const Eigen::Matrix3d& s) {
    const std::array<double, 6> all = {s(0, 0), s(1, 1), s(2, 2), s(0, 1), s(1, 2), s(0, 2)};
    for (int c = 0; c < symmetric_components<Dim>; ++c)
      particles_.columns.data(particles_.stress, c)[0] = all[static_cast<std::size_t>(c)];
  }
  double volume_ratio() const { return particles_.columns.data(particles_.volume)[0] / 2e-3; }
  double energy() const { return materials_.stored_energy(particles_) / 2e-3; }  ///< per initial volume

 private:
  Materials<Dim> materials_;
  Particles particles_;
  Blocks<Dim> blocks_;
};

Eigen::Matrix3d turn(double angle, const Eigen::Vector3d& axis) {
  return Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
}

/// Kirchhoff stress of simple shear: with h = asinh(gamma / 2), tau_xy = 4 G h / (4 + gamma^2)^(1/2) and
/// tau_xx = -tau_yy = 2 G h gamma / (4 + gamma^2)^(1/2).
Eigen::Matrix3d exact_shear(double gamma) {
  const double factor = 2 * shear * std::asinh(gamma / 2) / std::sqrt(4 + gamma * gamma);
  Eigen::Matrix3d tau = Eigen::Matrix3d::Zero();
  tau(0, 0) = factor * gamma, tau(1, 1) = -factor * gamma;
  tau(0, 1) = tau(1, 0) = 2 * factor;
  return tau;
}

// Exact in one step or a thousand: the step is a shear without error, and shears add up. 1e-10 of G, round-off of a
// thousand logarithms. The control: with the Jaumann rate it is G sin(gamma), negative at gamma = 4 (Dienes 1979); to
// half a step of 0.004, which a stress that is turned before it grows is behind.
template <int Dim>
void expect_exact_simple_shear() {
  for (const double gamma : {0.5, 4.0})
    for (const int steps : {1, 10, 1000}) {
      Specimen<Dim> specimen(elastic, "hencky");
      specimen.simple_shear(gamma, steps);
      EXPECT_LT((specimen.stress() - exact_shear(gamma)).norm(), 1e-10 * shear) << gamma << " " << steps;
      EXPECT_NEAR(specimen.volume_ratio(), 1, 1e-12);
    }
  Specimen<Dim> rate(elastic, "jaumann");
  rate.simple_shear(4, 1000);
  EXPECT_NEAR(rate.stress()(0, 1), shear * std::sin(4), 0.004 * shear);
  EXPECT_LT(rate.stress()(0, 1), 0);
}
TEST(Hencky, SimpleShearIsExactAndDoesNotOscillate) {
  expect_exact_simple_shear<2>();
  expect_exact_simple_shear<3>();
}

// Confined compression to half and extension to twice the length: J sigma_xx = M ln(stretch). Round-off; with (25) the
// volume follows exactly in one dimension.
TEST(Hencky, ConfinedStretchIsLogarithmic) {
  for (const double stretch : {0.5, 2.0})
    for (const int steps : {2, 100}) {
      Specimen<2> specimen(elastic, "hencky");
      Eigen::Matrix3d f = Eigen::Matrix3d::Identity();
      f(0, 0) = std::pow(stretch, 1.0 / steps);
      for (int n = 0; n < steps; ++n) specimen.deform(f);
      // (25) takes the logarithmic increment: its own error is the cube of it, over 12.
      const double miss = std::pow(std::abs(std::log(stretch)) / steps, 3) / 12 * steps;
      EXPECT_NEAR(specimen.volume_ratio(), stretch, 2 * miss * stretch + 1e-12);
      EXPECT_NEAR(specimen.stress()(0, 0) * specimen.volume_ratio(), modulus * std::log(stretch), 1e-10 * modulus);
      EXPECT_NEAR(specimen.stress()(1, 1) * specimen.volume_ratio(), lambda * std::log(stretch), 1e-10 * modulus);
    }
}

/// A closed loop of deformation gradients with shear, stretch and turn.
Eigen::Matrix3d loop(double t, bool flat) {
  const double a = 2 * std::numbers::pi * t;
  Eigen::Matrix3d f = Eigen::Matrix3d::Identity();
  f(0, 0) += 0.3 * std::sin(a), f(1, 1) += 0.2 * (1 - std::cos(a));
  f(0, 1) += 0.6 * std::sin(a), f(1, 0) += 0.4 * (1 - std::cos(2 * a));
  if (!flat) f(1, 2) += 0.3 * std::sin(2 * a), f(2, 2) += 0.2 * std::sin(a), f(2, 0) += 0.3 * (1 - std::cos(a));
  return f;
}

// Round a closed path nothing remains: no stress (1e-10 of G; the volume of (25) plays no part in it) and no energy. On
// the way the energy is half of the stress times the logarithmic strain of b = F F^T. The control: the rate form leaves
// stress behind, more than 1 % of G.
template <int Dim>
void expect_path_independence() {
  constexpr int steps = 400;
  const auto go = [](Specimen<Dim>& specimen, int from, int to) {
    for (int n = from; n < to; ++n)
      specimen.deform(loop((n + 1.0) / steps, Dim == 2) * loop(n * 1.0 / steps, Dim == 2).inverse());
  };
  Specimen<Dim> specimen(elastic, "hencky");
  go(specimen, 0, steps / 3);
  const Eigen::Matrix3d f = loop(steps / 3 * 1.0 / steps, Dim == 2);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal(f * f.transpose());
  const Eigen::Vector3d h = 0.5 * principal.eigenvalues().array().log();
  const double energy = 0.5 * lambda * h.sum() * h.sum() + shear * h.squaredNorm();
  EXPECT_NEAR(specimen.energy(), energy, 1e-9 * energy);
  go(specimen, steps / 3, steps);
  EXPECT_LT(specimen.stress().norm(), 1e-10 * shear);
  EXPECT_LT(specimen.energy(), 1e-15 * energy);
  Specimen<Dim> rate(elastic, "jaumann");
  go(rate, 0, steps);
  EXPECT_GT(rate.stress().norm(), 1e-2 * shear);
}
TEST(Hencky, ElasticityDependsOnTheDeformationAlone) {
  expect_path_independence<2>();
  expect_path_independence<3>();
}

// Turns, small and large, turn the stress without any error, and keep the volume: 1e-12 of the stress.
TEST(Hencky, RotationsTurnTheStress) {
  Eigen::Matrix3d stress;
  stress << 3e3, 5e2, -7e2, 5e2, -1e3, 1.1e3, -7e2, 1.1e3, 2e3;
  Specimen<3> solid(elastic, "hencky");
  solid.set_stress(stress);
  const Eigen::Matrix3d q = turn(0.7, {1, 2, -0.5}), small = turn(0.01, {0, -1, 2});
  solid.deform(q);
  Eigen::Matrix3d all = q;
  for (int n = 0; n < 100; ++n) solid.deform(small), all = small * all;
  EXPECT_LT((solid.stress() - all * stress * all.transpose()).norm(), 1e-10 * stress.norm());

  Specimen<2> plane(elastic, "hencky");
  stress(0, 2) = stress(2, 0) = stress(1, 2) = stress(2, 1) = 0;
  plane.set_stress(stress);
  const Eigen::Matrix3d about_z = turn(0.3, {0, 0, 1});
  plane.deform(about_z);
  EXPECT_LT((plane.stress() - about_z * stress * about_z.transpose()).norm(), 1e-10 * stress.norm());
  EXPECT_NEAR(plane.volume_ratio(), 1, 1e-12);
}

// Plasticity returns in the same way, of the Kirchhoff stress: von Mises's clay in large shear keeps q = 3^(1/2) su,
// and in plane flow its strength on the plane of shear comes to su as the elastic strain, su / G, is small: the turn
// of the axes by half of that, squared.
template <int Dim>
void expect_plastic_shear() {
  for (const std::string strain : {"hencky", "jaumann"}) {
    Specimen<Dim> specimen("model: von_mises, density: 1000 kg/m3, youngs_modulus: 1 MPa, strength: 2 kPa", strain);
    specimen.simple_shear(3, 3000);
    const Eigen::Matrix3d s = specimen.stress(), d = s - s.trace() / 3 * Eigen::Matrix3d::Identity();
    EXPECT_NEAR(std::sqrt(1.5) * d.norm(), std::numbers::sqrt3 * 2e3, 1e-6) << strain;
    EXPECT_NEAR(s(0, 1), 2e3, 2e3 * std::pow(2e3 / shear, 2)) << strain;
  }
}
TEST(Hencky, PlasticFlowKeepsItsStrength) {
  expect_plastic_shear<2>();
  expect_plastic_shear<3>();
}

// Mohr-Coulomb with dilation: elastic strains are small, so that both forms agree to their size, 1 %.
TEST(Hencky, AgreesWithTheRateFormAtSmallElasticStrain) {
  const std::string sand =
      "model: mohr_coulomb, density: 1000 kg/m3, youngs_modulus: 50 MPa, friction_angle: 30 deg, cohesion: 5 kPa, "
      "dilation_angle: 5 deg";
  std::array<Eigen::Matrix3d, 2> found;
  for (int form = 0; form < 2; ++form) {
    Specimen<2> specimen(sand, form == 0 ? "hencky" : "jaumann");
    specimen.set_stress(-50e3 * Eigen::Matrix3d::Identity());
    Eigen::Matrix3d f = Eigen::Matrix3d::Identity();
    f(0, 1) = 1e-4, f(1, 1) = 1 + 0.8e-5;
    for (int n = 0; n < 1000; ++n) specimen.deform(f);
    found[static_cast<std::size_t>(form)] = specimen.stress();
  }
  EXPECT_LT((found[0] - found[1]).norm(), 0.01 * found[1].norm());
}

TEST(Hencky, RefusesModelsWithoutLinearElasticity) {
  for (const std::string keys :
       {"model: newtonian, bulk_modulus: 1 MPa, viscosity: 1 Pa s",
        "model: modified_cam_clay, density: 1500 kg/m3, critical_stress_ratio: 1, lambda: 0.2, kappa: 0.04, "
        "initial_void_ratio: 1, overconsolidation_ratio: 1"}) {
    try {
      Specimen<2> specimen(keys, "hencky");
      ADD_FAILURE() << "accepted";
    } catch (const CaseError& error) {
      const std::string message = error.what();
      EXPECT_EQ(message.find("soil.yaml:1:9: material 'soil': `scheme.strain: hencky` needs a model with linear"), 0u)
          << message;
    }
  }
}

}  // namespace
}  // namespace sluice
