/// Bingham: flow at a constant rate, relaxation, the limits without viscosity and without yield stress.
#include <numbers>

#include "tests/unit/material_paths.h"

namespace sluice {
namespace {

const std::string elastic = "model: bingham, density: 1500 kg/m3, bulk_modulus: 2 MPa, shear_modulus: 1 MPa, ";
const std::string mud = elastic + "yield_stress: 500 Pa, viscosity: 20 Pa s";

// Steady simple shear at the rate 30 / s: tau = tau_y + mu rate, whatever the step; Deborah times are 20 us. Round-off.
TEST(Bingham, FlowsWithYieldStressAndViscosity) {
  const auto material = material_of(mud);
  for (const double dt : {1e-5, 1e-3, 0.1}) {
    PathPoints<2> point(*material, 1);
    point.dt = dt;
    point.strain[3][0] = 0.5 * 30 * dt;
    for (int n = 0; n < 200; ++n) point.update(*material);
    EXPECT_NEAR(point.stress[3][0], 500 + 20 * 30, 1e-9) << dt;
  }
}

// Held after a jump to twice the yield stress, the excess decays as exp(-G t / mu). The implicit step is of first order
// and never overshoots: errors halve with the step.
TEST(Bingham, RelaxesToTheYieldStress) {
  const auto material = material_of(mud);
  std::vector<double> errors;
  for (const int steps : {50, 100, 200}) {
    PathPoints<2> point(*material, 1);
    point.dt = 20e-6 / steps;  // up to the relaxation time mu / G
    point.set_stress(0, {0, 0, 0, 1000});
    for (int n = 0; n < steps; ++n) point.update(*material);
    errors.push_back(point.stress[3][0] - (500 + 500 * std::exp(-1)));
  }
  EXPECT_GT(errors[0], 0);
  EXPECT_LT(errors[0], 0.01 * 500);
  EXPECT_NEAR(errors[0] / errors[1], 2, 0.03);
  EXPECT_NEAR(errors[1] / errors[2], 2, 0.03);
  PathPoints<2> long_step(*material, 1);
  long_step.dt = 1;
  long_step.set_stress(0, {0, 0, 0, 1000});
  long_step.update(*material);
  EXPECT_NEAR(long_step.stress[3][0], 500, 0.02);
}

// Without viscosity it is von Mises's perfect plasticity, 1e-13 of stresses of 1e5 Pa.
template <int Dim>
void expect_von_mises() {
  const double shear = 1e6, bulk = 2e6, young = 9 * bulk * shear / (3 * bulk + shear);
  const auto mises = material_of(fmt::format(
      "model: von_mises, density: 1500 kg/m3, youngs_modulus: {:.17g} Pa, poisson_ratio: {:.17g}, strength: 500 Pa",
      young, young / (2 * shear) - 1));
  const auto material = material_of(elastic + "yield_stress: 500 Pa, viscosity: 0 Pa s");
  PathPoints<Dim> a = random_points<Dim>(*material, 300, 3), b = random_points<Dim>(*mises, 300, 3);
  a.update(*material);
  b.update(*mises);
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (int k = 0; k < symmetric_components<Dim>; ++k) ASSERT_NEAR(a.stress[k][i], b.stress[k][i], 1e-8);
    ASSERT_NEAR(a.state[0][i], b.state[0][i], 1e-13);
  }
}
TEST(Bingham, IsVonMisesWithoutViscosity) {
  expect_von_mises<2>();
  expect_von_mises<3>();
}

// Below the yield stress it is elastic, and before the first step nothing flows.
TEST(Bingham, RestsBelowTheYieldStress) {
  const auto material = material_of(mud);
  PathPoints<2> point(*material, 1);
  point.go(*material, {0, 0, 0, 1e-4}, 10);
  EXPECT_NEAR(point.stress[3][0], 200, 1e-10);
  EXPECT_EQ(point.state[0][0], 0);
  point.dt = 0;
  point.set_stress(0, {0, 0, 0, 1000});
  point.strain[3][0] = 0;
  point.update(*material);
  EXPECT_EQ(point.stress[3][0], 1000);
}

TEST(Bingham, TearsWhereToldTo) {
  const auto material = material_of(mud + ", tension_cutoff: 1 kPa");
  PathPoints<2> point(*material, 1);
  point.go(*material, {0.01, 0.01, 0, 0}, 1);
  EXPECT_NEAR(point.mean(0), 1e3, 1e-9);
}

TEST(Bingham, DissipatesAndIsTheSameInAnyBatchAndDimension) {
  const auto material = material_of(mud);
  expect_dissipation<2>(*material, 20);
  expect_dissipation<3>(*material, 20);
  expect_any_batch_gives_the_same_bits<2>(*material);
  expect_any_batch_gives_the_same_bits<3>(*material);
  expect_plane_strain_equals_three_dimensions(*material, 1e-7);
}

TEST(Bingham, SaysWhatIsWrong) {
  expect_complaint(elastic + "yield_stress: -5 Pa, viscosity: 1 Pa s", {"yield_stress", "at least 0"});
  expect_complaint(elastic + "yield_stres: 5 Pa, viscosity: 1 Pa s", {"yield_stres", "yield_stress"});
  expect_complaint("model: bingham, density: 1 kg/m3, bulk_modulus: 1 MPa, yield_stress: 1 Pa, viscosity: 1 Pa s",
                   {"shear_modulus", "missing"});
}

}  // namespace
}  // namespace sluice
