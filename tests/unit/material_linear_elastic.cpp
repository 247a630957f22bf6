/// Linear elasticity, and what every batch of every material promises. Exact formulas: tolerances are round-off.
#include "physics/materials/linear_elastic.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/material_point.h"

namespace sluice {
namespace {

TEST(LinearElastic, ModuliOfYoungAndPoisson) {
  const double young = 2e6, nu = 0.3;
  const IsotropicElasticity e = IsotropicElasticity::from_young(young, nu);
  EXPECT_NEAR(e.shear, young / 2.6, 1e-9 * young);
  EXPECT_NEAR(e.lambda + 2 * e.shear / 3, young / (3 * 0.4), 1e-9 * young);  // the bulk modulus
  EXPECT_NEAR(e.constrained_modulus(), young * 0.7 / (1.3 * 0.4), 1e-9 * young);
}

// Uniaxial stress sigma = E eps with lateral strains -nu eps; shear tau = G gamma, gamma = 2 eps_xy.
TEST(LinearElastic, UniaxialStressAndPureShear) {
  const double young = 2e6, nu = 0.3, strain = 1e-3;
  const LinearElastic material(1800, IsotropicElasticity::from_young(young, nu));
  MaterialPoints<3> points(1);
  points.strain_increment[0][0] = strain;
  points.strain_increment[1][0] = points.strain_increment[2][0] = -nu * strain;
  points.strain_increment[4][0] = strain;
  material.update(points.batch());
  const auto s = points.stress_of(0);
  EXPECT_NEAR(s[0], young * strain, 1e-12 * young * strain);
  EXPECT_NEAR(s[1], 0, 1e-12 * young * strain);
  EXPECT_NEAR(s[2], 0, 1e-12 * young * strain);
  EXPECT_EQ(s[3], 0);
  EXPECT_NEAR(s[4], young / (2 * (1 + nu)) * 2 * strain, 1e-12 * young * strain);
  EXPECT_EQ(s[5], 0);
}

// Energy per volume is half of stress times strain, in both dimensions.
TEST(LinearElastic, StoredEnergyIsTheWork) {
  const LinearElastic material(1800, IsotropicElasticity::from_young(2e6, 0.25));
  MaterialPoints<3> solid(1);
  MaterialPoints<2> plane(1);
  const std::array<double, 6> strain = {1e-3, -4e-4, 2e-4, 5e-4, -3e-4, 7e-4};
  for (int k = 0; k < 6; ++k) solid.strain_increment[k][0] = strain[k];
  for (int k = 0; k < 4; ++k) plane.strain_increment[k][0] = strain[k];
  material.update(solid.batch());
  material.update(plane.batch());
  double solid_work = 0, plane_work = 0;
  for (int k = 0; k < 6; ++k) solid_work += (k < 3 ? 0.5 : 1) * strain[k] * solid.stress[k][0];
  for (int k = 0; k < 4; ++k) plane_work += (k < 3 ? 0.5 : 1) * strain[k] * plane.stress[k][0];
  EXPECT_NEAR(material.stored_energy(solid.stress_of(0)), solid_work, 1e-12 * solid_work);
  EXPECT_NEAR(material.stored_energy(plane.stress_of(0)), plane_work, 1e-12 * plane_work);
}

TEST(LinearElastic, StrainsAddUp) {
  const LinearElastic material(1800, IsotropicElasticity::from_young(2e6, 0.3));
  MaterialPoints<2> points = MaterialPoints<2>::random(50, 1);
  const MaterialPoints<2> before = points;
  material.update(points.batch());
  for (auto& column : points.strain_increment) {
    for (double& value : column) value = -value;
  }
  material.update(points.batch());
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (int k = 0; k < 4; ++k) EXPECT_NEAR(points.stress[k][i], before.stress[k][i], 1e-9);  // of 1e5: round-off
  }
}

// Bit for bit, wherever a point stands, and nothing beyond the batch is touched.
TEST(LinearElastic, AnyBatchGivesTheSameBits) {
  const LinearElastic material(1800, IsotropicElasticity::from_young(2e6, 0.3));
  MaterialPoints<3> whole = MaterialPoints<3>::random(100, 2), cut = whole;
  const MaterialPoints<3> before = whole;
  material.update(whole.batch());
  for (std::size_t first = 0, count = 1; first < 90; first += count, count = count % 40 + 3) {
    material.update(cut.batch(first, std::min<std::size_t>(count, 90 - first)));
  }
  for (std::size_t i = 0; i < 100; ++i) {
    EXPECT_EQ(cut.stress_of(i), i < 90 ? whole.stress_of(i) : before.stress_of(i)) << i;
  }
}

}  // namespace
}  // namespace sluice
