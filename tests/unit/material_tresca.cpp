/// Tresca with undrained strength: it is Mohr-Coulomb without friction; what it has beyond that.
#include "tests/unit/material_paths.h"

namespace sluice {
namespace {

const std::string elastic = "density: 1800 kg/m3, youngs_modulus: 2 MPa, ";
const std::string plain = "model: tresca, " + elastic + "strength: 10 kPa";
const std::string tied = "model: tresca, " + elastic + "strength_ratio: 0.25, minimum_strength: 2 kPa";

/// Both materials give the same on random points, to 1e-12 of the trial stresses of 1e6 Pa.
template <int Dim>
void expect_alike(const Material& a, const Material& b, double time) {
  PathPoints<Dim> first = random_points<Dim>(a, 500, 2), second = random_points<Dim>(b, 500, 2);
  first.time = second.time = time;
  for (int n = 0; n < 4; ++n) {
    first.update(a);
    second.update(b);
  }
  for (std::size_t i = 0; i < first.size(); ++i) {
    for (int k = 0; k < symmetric_components<Dim>; ++k) ASSERT_NEAR(first.stress[k][i], second.stress[k][i], 1e-6);
    ASSERT_NEAR(first.state[0][i], second.state[0][i], 1e-12);
  }
}

TEST(Tresca, IsMohrCoulombWithoutFriction) {
  const std::string mohr = "model: mohr_coulomb, " + elastic + "friction_angle: 0 deg, cohesion: 10 kPa";
  const std::vector<std::pair<std::string, std::string>> pairs = {
      {"", ""},
      {", tension_cutoff: 1 kPa", ", tension_cutoff: 1 kPa"},
      {", softening: {sensitivity: 4, strain: 0.2, start: 2 s, ramp: 4 s}",
       ", softening: {cohesion: 2.5 kPa, strain: 0.2, start: 2 s, ramp: 4 s}"}};
  for (const auto& [own, its] : pairs) {
    const auto a = material_of(plain + own), b = material_of(mohr + its);
    for (const double time : {0.0, 3.0}) {
      expect_alike<2>(*a, *b, time);
      expect_alike<3>(*a, *b, time);
    }
  }
}

// Simple shear gives su, triaxial compression q = 2 su: where von Mises, fitted to shear, has 3^(1/2) su.
TEST(Tresca, ReachesItsStrength) {
  const auto material = material_of(plain);
  PathPoints<2> shear(*material, 1);
  shear.go(*material, {0, 0, 0, 0.1}, 10);
  EXPECT_NEAR(shear.stress[3][0], 10e3, 1e-9);
  PathPoints<3> triaxial(*material, 1);
  triaxial.go(*material, {0.05, 0.05, -0.1, 0, 0, 0}, 10);
  EXPECT_NEAR(triaxial.stress[0][0] - triaxial.stress[2][0], 20e3, 1e-8);
}

// The overburden of the first update counts, of the vertical axis, which is the last one.
TEST(Tresca, StrengthFollowsTheInitialOverburden) {
  const auto material = material_of(tied);
  PathPoints<2> plane(*material, 2);
  plane.set_stress(0, {-20e3, -40e3, -20e3, 0});
  plane.set_stress(1, {-20e3, -1e3, -20e3, 0});
  plane.strain[3][0] = plane.strain[3][1] = 0.5;
  for (int n = 0; n < 3; ++n) plane.update(*material);
  for (const auto& [i, strength] : {std::pair{0, 10e3}, std::pair{1, 2e3}}) {
    const auto s = plane.stress_of(static_cast<std::size_t>(i));
    EXPECT_NEAR(std::hypot(0.5 * (s[0] - s[1]), s[3]), strength, 1e-8);
  }
  EXPECT_EQ(plane.state[1][0], 40e3);
  PathPoints<3> solid(*material, 1);
  solid.set_stress(0, {-20e3, -20e3, -40e3, 0, 0, 0});
  solid.strain[3][0] = 0.5;
  solid.update(*material);
  EXPECT_EQ(solid.state[1][0], 40e3);
}

TEST(Tresca, IsTheSameInAnyBatch) {
  for (const std::string& keys : {plain, tied + ", softening: {sensitivity: 4, strain: 0.1}"}) {
    const auto material = material_of(keys);
    expect_any_batch_gives_the_same_bits<2>(*material);
    expect_any_batch_gives_the_same_bits<3>(*material);
  }
}

TEST(Tresca, SaysWhatIsWrong) {
  expect_complaint("model: tresca, " + elastic + "poisson_ratio: 0.3", {"m.yaml:1:1", "none of `strength`"});
  expect_complaint(plain + ", tension_cutoff: -1 kPa", {"tension_cutoff", "-1 kPa"});
  expect_complaint(plain + ", softening: {strain: 0.1, sensitivity: 0.5}", {"sensitivity", "above 1"});
}

}  // namespace
}  // namespace sluice
