/// Von Mises with undrained strength: closed forms of shear and compression, sensitivity, overburden, what is refused.
#include <numbers>

#include "tests/unit/material_paths.h"

namespace sluice {
namespace {

constexpr double root3 = std::numbers::sqrt3;
constexpr double shear_modulus = 2e6 / 2.6;
const std::string clay = "model: von_mises, density: 1800 kg/m3, youngs_modulus: 2 MPa, ";
const std::string plain = clay + "strength: 10 kPa";
const std::string sensitive = plain + ", softening: {sensitivity: 4, strain: 0.2";
const std::string tied = clay + "strength_ratio: 0.25, minimum_strength: 2 kPa";

// Simple shear gives the strength; triaxial compression and extension, from a hydrostatic stress and without change of
// volume, give q = 3^(1/2) su, in one step or in many: radial. Round-off of 1e6 Pa.
TEST(VonMises, ReachesItsStrengthOnEveryPath) {
  const auto material = material_of(plain);
  for (const int steps : {1, 7, 1000}) {
    PathPoints<2> shear(*material, 1);
    shear.go(*material, {0, 0, 0, 0.1}, steps);
    EXPECT_NEAR(shear.stress[3][0], 10e3, 1e-9);
    EXPECT_NEAR(shear.state[0][0], 2 / root3 * (0.1 - 10e3 / (2 * shear_modulus)), 1e-13);
    for (const double sign : {1.0, -1.0}) {
      PathPoints<3> triaxial(*material, 1);
      triaxial.set_stress(0, {-1e5, -1e5, -1e5, 0, 0, 0});
      triaxial.go(*material, {0.05 * sign, 0.05 * sign, -0.1 * sign, 0, 0, 0}, steps);
      EXPECT_NEAR(triaxial.stress[2][0] - triaxial.stress[0][0], -sign * root3 * 10e3, 1e-8);
      EXPECT_NEAR(triaxial.mean(0), -1e5, 1e-8);
    }
  }
}

// With the strength at the end of the step, simple shear lies on its closed form however long the steps are: on the way
// down tau = (su - a gamma) / (1 - a / G), a = (su - sr) / (3^(1/2) eps_r). Round-off, which the slope magnifies.
TEST(VonMises, SoftensExactlyInAnyStep) {
  const auto material = material_of(sensitive + "}");
  const double a = 7.5e3 / (root3 * 0.2);
  for (const double gamma : {0.05, 0.2, 0.3, 0.5})
    for (const int steps : {1, 10, 1000}) {
      PathPoints<2> point(*material, 1);
      point.go(*material, {0, 0, 0, gamma / 2}, steps);
      EXPECT_NEAR(point.stress[3][0], std::max(2.5e3, (10e3 - a * gamma) / (1 - a / shear_modulus)), 1e-7) << gamma;
    }
}

// Where the strength falls more steeply than elasticity unloads, 3 G, it falls to the residual at once.
TEST(VonMises, SnapsToTheResidualIfTheSlopeIsTooSteep) {
  const auto material = material_of(plain + ", softening: {sensitivity: 4, strain: 0.001}");
  PathPoints<2> point(*material, 1);
  point.go(*material, {0, 0, 0, 0.0066}, 1);  // tau = 10.15 kPa if elastic
  EXPECT_NEAR(point.stress[3][0], 2.5e3, 1e-9);
}

// Over the width of a cell the work of softening is the same in every cell (SO.3); without a reference width it is not.
TEST(VonMises, DissipationOfABandDoesNotDependOnTheCell) {
  const auto excess = [](const std::string& keys, double cell) {
    const auto material = material_of(keys);
    material->set_cell_size(cell);
    PathPoints<2> point(*material, 1);
    point.strain[3][0] = 5e-5 / cell;
    double work = 0, before = 0;
    for (int n = 0; n < 10000; ++n) {
      point.update(*material);
      const double tau = point.stress[3][0];
      work += (0.5 * (tau + before) - 2.5e3) * (2 * point.strain[3][0] - (tau - before) / shear_modulus);
      before = tau;
    }
    EXPECT_NEAR(before, 2.5e3, 1e-9);
    return work * cell;
  };
  const double expected = 0.5 * 7.5e3 * root3 * 0.2;  // [N/m]; steps of 1e-4 make an error of their square, 1e-4
  for (const double cell : {2.0, 1.0, 0.1}) {
    EXPECT_NEAR(excess(sensitive + ", reference_width: 1 m}", cell), expected, 1e-3 * expected) << cell;
    EXPECT_NEAR(excess(sensitive + "}", cell), cell * expected, 1e-3 * expected) << cell;
  }
}

// The overburden of the first update counts, whatever comes after it; there is a least strength.
TEST(VonMises, StrengthFollowsTheInitialOverburden) {
  const auto material = material_of(tied);
  PathPoints<2> plane(*material, 3);
  plane.set_stress(0, {-20e3, -40e3, -20e3, 0});
  plane.set_stress(1, {-20e3, -4e3, -20e3, 0});
  plane.set_stress(2, {5e3, 5e3, 5e3, 0});
  plane.update(*material);  // without strain
  EXPECT_EQ(plane.state[1][0], 40e3);
  for (std::size_t i = 0; i < 3; ++i) {
    plane.set_stress(i, {-1e6, -1e6, -1e6, 0});
    plane.strain[3][i] = 0.1;
  }
  plane.update(*material);
  EXPECT_NEAR(plane.stress[3][0], 10e3, 1e-9);
  EXPECT_NEAR(plane.stress[3][1], 2e3, 1e-9);
  EXPECT_NEAR(plane.stress[3][2], 2e3, 1e-9);
  EXPECT_EQ(plane.state[1][0], 40e3);

  PathPoints<3> solid(*material, 1);  // the last axis is the vertical one
  solid.set_stress(0, {-20e3, -20e3, -40e3, 0, 0, 0});
  solid.strain[3][0] = 0.5;
  solid.update(*material);
  EXPECT_NEAR(solid.mises(0), root3 * 10e3, 1e-9);
}

// The residual strength at a time, as after liquefaction: a quarter of the initial overburden, then a sixteenth.
TEST(VonMises, FallsInTimeWithoutStrain) {
  const auto material = material_of(tied + ", softening: {sensitivity: 4, start: 5 s, ramp: 2 s}");
  PathPoints<2> point(*material, 1);
  point.set_stress(0, {-40e3, -40e3, -40e3, 0});
  for (const auto& [time, expected] : std::vector<std::pair<double, double>>{{0, 10e3}, {6, 6.25e3}, {7, 2.5e3}}) {
    point.time = time;
    point.go(*material, {0, 0, 0, 0.1}, 1);
    EXPECT_NEAR(point.stress[3][0], expected, 1e-9) << time;
  }
}

template <int Dim>
void expect_admissible_and_idempotent(const std::string& keys) {
  const auto material = material_of(keys);
  PathPoints<Dim> points = random_points<Dim>(*material, 2000, 3);
  points.update(*material);
  for (auto& column : points.strain) std::fill(column.begin(), column.end(), 0.0);
  const PathPoints<Dim> once = points;
  points.update(*material);
  int yielded = 0;
  for (std::size_t i = 0; i < once.size(); ++i) {
    yielded += once.state[0][i] > 0;
    ASSERT_LE(once.mises(i), root3 * 10e3 * (1 + 1e-13));
    for (int k = 0; k < symmetric_components<Dim>; ++k)
      ASSERT_NEAR(points.stress[k][i], once.stress[k][i], 1e-13 * (1e4 + std::abs(once.mean(i))));
  }
  EXPECT_GT(yielded, 500);
  EXPECT_LT(yielded, 1980);
}
// A second update without strain changes nothing, also while it softens: the return is to the strength at its end.
TEST(VonMises, AdmissibleAndIdempotent) {
  for (const std::string& keys : {plain, sensitive + "}"}) {
    expect_admissible_and_idempotent<2>(keys);
    expect_admissible_and_idempotent<3>(keys);
  }
}

TEST(VonMises, IsTheSameInAnyBatchAndDimension) {
  for (const std::string& keys : {plain, sensitive + ", start: 0 s, ramp: 1 s}"}) {
    const auto material = material_of(keys);
    expect_any_batch_gives_the_same_bits<2>(*material);
    expect_any_batch_gives_the_same_bits<3>(*material);
    expect_plane_strain_equals_three_dimensions(*material, 1e-7);  // 1e-13 of trial stresses of 1e6 Pa
  }
  const auto material = material_of(tied);  // the axes that count as vertical differ in 2-D and 3-D
  expect_any_batch_gives_the_same_bits<2>(*material);
  expect_any_batch_gives_the_same_bits<3>(*material);
}

TEST(VonMises, Dissipates) {
  const auto material = material_of(sensitive + "}");
  expect_dissipation<2>(*material, 20);
  expect_dissipation<3>(*material, 20);
}

TEST(VonMises, SaysWhatIsWrong) {
  expect_complaint(clay + "poisson_ratio: 0.3", {"m.yaml:1:1", "none of `strength` and `strength_ratio` is given"});
  expect_complaint(plain + ", strength_ratio: 0.2", {"both of `strength` and `strength_ratio` are given"});
  expect_complaint(clay + "strength_ratio: 0.2", {"strength_ratio", "needs `minimum_strength`"});
  expect_complaint(plain + ", minimum_strength: 1 kPa", {"minimum_strength", "`strength_ratio` only"});
  expect_complaint(clay + "strength: 0 kPa", {"strength", "above 0"});
  expect_complaint(clay + "strenght: 1 kPa", {"strenght", "strength"});
  expect_complaint(plain + ", softening: {strain: 0.1}", {"sensitivity", "softening"});
  expect_complaint(plain + ", softening: {strain: 0.1, sensitivity: 1}", {"sensitivity", "above 1"});
  expect_complaint(plain + ", softening: {sensitivity: 2}", {"neither", "`strain`"});
  expect_complaint(plain + ", tension_cutoff: 1 kPa", {"unknown key 'tension_cutoff'"});
  try {
    material_of(sensitive + ", reference_width: 1 m}")->set_cell_size(100);
    ADD_FAILURE() << "accepted";
  } catch (const CaseError& error) {
    // 3 G eps_r w / (3^(1/2) 7.5 kPa) = 35.5 m
    EXPECT_NE(std::string(error.what()).find("in cells of 100 m"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("smaller than 35.5 m"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace sluice
