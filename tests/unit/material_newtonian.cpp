/// A weakly compressible liquid: Newton's viscosity, pressure from volume, tension.
#include "tests/unit/material_paths.h"

namespace sluice {
namespace {

const std::string oil = "model: newtonian, density: 900 kg/m3, bulk_modulus: 1 MPa, viscosity: 2 Pa s";

TEST(Newtonian, IsNoLiquidOfThePhysics) {
  const auto material = material_of(oil);
  EXPECT_FALSE(material->liquid());  // its pressure is its own
  EXPECT_EQ(material->density(), 900);
  EXPECT_EQ(material->viscosity(), 2);
  EXPECT_EQ(material->elasticity().constrained_modulus(), 1e6);
  EXPECT_TRUE(material->columns().empty());
  const std::array<double, 4> stress{-2e3, -1e3, -3e3, 500};  // the pressure counts: (2 kPa)^2 / 2K
  EXPECT_NEAR(material->stored_energy(stress), 2, 1e-12);
}

// 2 mu dev(eps) / dt, whatever the deviator was; the mean stress grows by K tr(eps). Round-off of 1e5 Pa.
template <int Dim>
void expect_newton() {
  const auto material = material_of(oil);
  PathPoints<Dim> points = random_points<Dim>(*material, 100, 3);
  const PathPoints<Dim> before = points;
  points.update(*material);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Matrix3d strain = as_matrix<Dim>(points.strain_of(i)), one = Eigen::Matrix3d::Identity();
    const Eigen::Matrix3d expected =
        (before.mean(i) + 1e6 * strain.trace()) * one + 2 * 2.0 / points.dt * (strain - strain.trace() / 3 * one);
    EXPECT_LT((as_matrix<Dim>(points.stress_of(i)) - expected).norm(), 1e-9);
  }
}
TEST(Newtonian, HasTheStressOfNewton) {
  expect_newton<2>();
  expect_newton<3>();
}

// Before the first step (dt = 0) there is no rate, but the pressure stands.
TEST(Newtonian, KeepsItsPressureBeforeTheFirstStep) {
  const auto material = material_of(oil);
  PathPoints<2> point(*material, 1);
  point.dt = 0;
  point.set_stress(0, {-2e3, -1e3, -3e3, 500});
  point.update(*material);
  EXPECT_EQ(point.stress_of(0), (std::array<double, 4>{-2e3, -2e3, -2e3, 0}));
}

TEST(Newtonian, TearsWhereToldTo) {
  const auto tearing = material_of(oil + ", tension_cutoff: 0 Pa"), holding = material_of(oil);
  for (const auto* material : {tearing.get(), holding.get()}) {
    PathPoints<2> point(*material, 1);
    point.go(*material, {0.01, 0.01, 0, 0}, 1);
    EXPECT_NEAR(point.mean(0), material == tearing.get() ? 0 : 2e4, 1e-9);
  }
}

// Viscous work is 2 mu dev(rate) : dev(rate), never negative.
TEST(Newtonian, Dissipates) {
  const auto material = material_of(oil);
  PathPoints<3> points = random_points<3>(*material, 500, 4);
  points.update(*material);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Matrix3d strain = as_matrix<3>(points.strain_of(i));
    const Eigen::Matrix3d viscous = as_matrix<3>(points.stress_of(i)) - points.mean(i) * Eigen::Matrix3d::Identity();
    EXPECT_GE((viscous.array() * strain.array()).sum(), 0);
  }
}

TEST(Newtonian, IsTheSameInAnyBatchAndDimension) {
  const auto material = material_of(oil + ", tension_cutoff: 1 kPa");
  expect_any_batch_gives_the_same_bits<2>(*material);
  expect_any_batch_gives_the_same_bits<3>(*material);
  expect_plane_strain_equals_three_dimensions(*material, 1e-8);
}

TEST(Newtonian, SaysWhatIsWrong) {
  expect_complaint("model: newtonian, viscosity: 1 Pa s", {"m.yaml:1:", "bulk_modulus", "missing"});
  expect_complaint("model: newtonian, bulk_modulus: 1 MPa, viscosity: -1 Pa s", {"viscosity", "at least 0"});
  expect_complaint(oil + ", tension_cutoff: -1 Pa", {"tension_cutoff", "at least 0"});
  expect_complaint("model: newtonian, bulk_modulus: 0 Pa, viscosity: 1 Pa s", {"bulk_modulus", "above 0"});
}

}  // namespace
}  // namespace sluice
