/// Modified Cam clay against the closed forms of its element tests. Sources: Wood (1990), Soil Behaviour and Critical
/// State Soil Mechanics, chapters 5 and 6; Potts & Zdravkovic (1999), ch. 7.
#include <limits>
#include <numbers>

#include "tests/unit/material_paths.h"

namespace sluice {
namespace {

constexpr double ratio = 0.9, lambda = 0.2 / 2, kappa = 0.04 / 2;  // lambda and kappa over 1 + e_0 = 2
constexpr double spacing = 1 - kappa / lambda;
const std::string keys =
    "model: modified_cam_clay, density: 1500 kg/m3, critical_stress_ratio: 0.9, lambda: 0.2, kappa: 0.04, "
    "initial_void_ratio: 1, ";
const std::string clay = keys + "preconsolidation_pressure: 100 kPa";

PathPoints<3> at_pressure(const Material& material, double pressure) {
  PathPoints<3> point(material, 1);
  point.set_stress(0, {-pressure, -pressure, -pressure, 0, 0, 0});
  return point;
}

// Isotropic compression of a normally consolidated clay: p = p_0 exp(eps / (lambda / (1 + e_0))), unloading the same
// with kappa; first kappa, then lambda where it begins overconsolidated. The backward Euler step is exact here: 1e-11.
TEST(ModifiedCamClay, IsotropicCompressionFollowsItsLines) {
  const auto material = material_of(clay);
  for (const int steps : {1, 10, 100}) {
    PathPoints<3> point = at_pressure(*material, 50e3);
    const double elastic = kappa * std::numbers::ln2, plastic = 0.05;
    const double each = -(elastic + plastic) / 3;
    point.go(*material, {each, each, each, 0, 0, 0}, steps);
    const double highest = 100e3 * std::exp(plastic / lambda);
    EXPECT_NEAR(-point.mean(0), highest, 1e-11 * highest) << steps;
    EXPECT_NEAR(point.state[1][0], highest, 1e-11 * highest);
    EXPECT_NEAR(point.state[0][0], 0, 1e-15);
    point.go(*material, {0.01, 0.01, 0.01, 0, 0, 0}, steps);
    EXPECT_NEAR(-point.mean(0), highest * std::exp(-0.03 / kappa), 1e-11 * highest);
    EXPECT_NEAR(point.state[1][0], highest, 1e-11 * highest);
  }
}

/// One-dimensional compression: no strain but along the last axis.
void compress(const Material& material, PathPoints<3>& point, double strain, int steps) {
  point.go(material, {0, 0, -strain, 0, 0, 0}, steps);
}

// Oedometer: the stress ratio settles, and then p and the vertical stress grow with the slope lambda. On that line
// eta (1 + nu)(1 - Lambda) / (3 (1 - 2 nu)) + 3 eta Lambda / (M^2 - eta^2) = 1 (Potts & Zdravkovic, sec. 7.9.2). 1e-4:
// a step of 1e-4 strain is 1e-3 of lambda, and the error of backward Euler in the ratio is a part of that.
TEST(ModifiedCamClay, OedometerFollowsTheLambdaLineAtItsK0) {
  const auto material = material_of(clay);  // nu = 0.3
  PathPoints<3> point = at_pressure(*material, 100e3);
  compress(*material, point, 0.3, 3000);
  const auto before = point.stress_of(0);
  compress(*material, point, 0.01, 100);
  const double growth = std::log(point.stress[2][0] / before[2]);
  EXPECT_NEAR(growth * lambda, 0.01, 1e-4 * 0.01);
  const double eta = point.mises(0) / -point.mean(0);
  EXPECT_NEAR(eta * 1.3 * (1 - spacing) / (3 * 0.4) + 3 * eta * spacing / (ratio * ratio - eta * eta), 1, 2e-3);
  EXPECT_GT(point.stress[0][0] / point.stress[2][0], 0.5);  // K0 of this clay is 0.69
}

// Undrained triaxial compression and extension at constant volume end at q = M p with p = p_0 (R/2)^Lambda, for
// overconsolidation ratios on the wet and on the dry side: backward Euler has errors of first order, 1e-3 at 2000
// steps. On the way, the normally consolidated clay lies on p_0 / p = ((M^2 + eta^2) / M^2)^Lambda.
TEST(ModifiedCamClay, UndrainedStrength) {
  const auto material = material_of(clay);
  for (const double over : {1.0, 1.5, 2.0, 4.0, 10.0})
    for (const double sign : {1.0, -1.0}) {
      const double start = 100e3 / over, end = start * std::pow(over / 2, spacing);
      PathPoints<3> point = at_pressure(*material, start);
      point.go(*material, {0.2 * sign, 0.2 * sign, -0.4 * sign, 0, 0, 0}, 4000);
      EXPECT_NEAR(-point.mean(0), end, 1e-3 * end) << over;
      EXPECT_NEAR(point.mises(0), ratio * end, 1e-3 * end) << over;
      EXPECT_EQ(point.stress[0][0] > point.stress[2][0], sign > 0);
      EXPECT_NEAR(point.state[1][0], 2 * end, 2e-3 * end);  // the top of the ellipse
    }
  PathPoints<3> path = at_pressure(*material, 100e3);
  for (int n = 0; n < 10; ++n) {
    path.go(*material, {1e-3, 1e-3, -2e-3, 0, 0, 0}, 500);
    const double pressure = -path.mean(0), eta = path.mises(0) / pressure;
    EXPECT_NEAR(pressure, 100e3 * std::pow(ratio * ratio / (ratio * ratio + eta * eta), spacing), 1e-3 * 1e5) << eta;
  }
}

/// One step of drained triaxial compression: the strain of the sides is found so that their stress stays.
void drained_step(const Material& material, PathPoints<3>& point, double axial) {
  const double held = point.stress[0][0];
  const auto side_stress = [&](double sides, PathPoints<3>& copy) {
    copy.go(material, {sides, sides, -axial, 0, 0, 0}, 1);
    return copy.stress[0][0] - held;
  };
  double a = 0, b = 0.5 * axial;
  PathPoints<3> first = point, last = point;
  double fa = side_stress(a, first), fb = side_stress(b, last);
  for (int n = 0; n < 30 && std::abs(fb) > 1e-9 * std::abs(held); ++n) {
    const double next = b - fb * (b - a) / (fb - fa);
    a = b, fa = fb, b = next;
    last = point;
    fb = side_stress(b, last);
  }
  point = last;
}

// Drained triaxial compression at constant cell pressure ends at q = 3 M p_0 / (3 - M), p = 3 p_0 / (3 - M). From the
// normally consolidated state the volume falls by lambda ln(p / p_0) + (lambda - kappa) ln 2, whatever the path: 1e-4
// of it, the way still to go after 200 % strain. The heavily overconsolidated clay has a peak above, and dilates.
TEST(ModifiedCamClay, DrainedTriaxialReachesTheCriticalState) {
  for (const std::string shear : {"", ", shear_modulus: 3 MPa"}) {
    const auto material = material_of(clay + shear);
    const double p = 100e3 * 3 / (3 - ratio);
    PathPoints<3> point = at_pressure(*material, 100e3);
    double volume = 0;
    for (int n = 0; n < 4000; ++n) {
      drained_step(*material, point, 5e-4);
      volume -= point.strain[0][0] + point.strain[1][0] + point.strain[2][0];
    }
    EXPECT_NEAR(point.mises(0), ratio * p, 1e-4 * p);
    EXPECT_NEAR(-point.mean(0), p, 1e-4 * p);
    const double expected = lambda * std::log(p / 100e3) + (lambda - kappa) * std::numbers::ln2;
    EXPECT_NEAR(volume, expected, 1e-3 * expected);
  }
  const auto material = material_of(clay);
  PathPoints<3> point = at_pressure(*material, 10e3);
  double peak = 0, volume = 0;
  for (int n = 0; n < 6000; ++n) {
    drained_step(*material, point, 2e-4);
    peak = std::max(peak, point.mises(0));
    volume -= point.strain[0][0] + point.strain[1][0] + point.strain[2][0];
  }
  const double p = 10e3 * 3 / (3 - ratio);
  EXPECT_GT(peak, 1.3 * ratio * p);
  EXPECT_LT(volume, -0.02);
  EXPECT_NEAR(point.mises(0), ratio * p, 0.01 * p);
}

// Backward Euler is of first order: along a path that is elastic, hardens and turns, errors against 6400 steps halve
// with the step; and 1e4 steps agree with 2e4 to 1e-4.
TEST(ModifiedCamClay, ConvergesWithFirstOrder) {
  const auto material = material_of(clay);
  const auto end = [&](int steps) {
    PathPoints<3> point = at_pressure(*material, 60e3);
    point.go(*material, {0.01, -0.005, -0.03, 0.01, 0.005, 0}, steps);
    point.go(*material, {-0.01, 0.0, -0.01, 0.02, 0, 0.01}, steps);
    return as_matrix<3>(point.stress_of(0));
  };
  const Eigen::Matrix3d exact = 2 * end(12800) - end(6400);  // extrapolated
  std::vector<double> errors;
  for (const int steps : {50, 100, 200}) errors.push_back((end(steps) - exact).norm());
  EXPECT_LT(errors[0], 0.02 * exact.norm());
  EXPECT_NEAR(errors[0] / errors[1], 2, 0.2);
  EXPECT_NEAR(errors[1] / errors[2], 2, 0.2);
}

/// The residual of the surface, over its size; negative inside.
double surface(double pressure, double mises, double size) {
  return (mises * mises / (ratio * ratio) + pressure * (pressure - size)) / (size * size);
}

template <int Dim>
PathPoints<Dim> clay_points(const Material& material, unsigned seed) {
  PathPoints<Dim> points = random_points<Dim>(material, 500, seed);
  for (int k = 0; k < 3; ++k)
    for (double& s : points.stress[k]) s -= 15e3;
  return points;
}

// On the surface or within, to 1e-10 of its size, however large the step; a second update without strain changes
// nothing; the plastic work of a step, p dv_p + q ds_p, is not negative.
template <int Dim>
void expect_admissible(const std::string& more) {
  const auto material = material_of(keys + more);
  PathPoints<Dim> points = clay_points<Dim>(*material, 7);
  auto strain = points.strain;
  for (auto& column : points.strain) std::fill(column.begin(), column.end(), 0.0);
  points.update(*material);  // sets p_c
  points.strain = strain;
  const PathPoints<Dim> before = points;
  points.update(*material);
  int yielded = 0, dry = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double size = points.state[1][i], pressure = -points.mean(i);
    ASSERT_LE(surface(pressure, points.mises(i), size), 1e-10) << i;
    const double plastic_shear = points.state[0][i] - before.state[0][i];
    if (plastic_shear == 0) continue;
    ++yielded;
    dry += size < before.state[1][i];
    ASSERT_NEAR(surface(pressure, points.mises(i), size), 0, 1e-10) << i;
    if (size > 1001) {  // above the least size, whose hardening is cut off
      const double volume = (lambda - kappa) * std::log(size / before.state[1][i]);
      ASSERT_GE(pressure * volume + points.mises(i) * plastic_shear, -1e-9 * size) << i;
    }
  }
  EXPECT_GT(yielded, 100);
  EXPECT_GT(dry, 20);
  for (auto& column : points.strain) std::fill(column.begin(), column.end(), 0.0);
  const PathPoints<Dim> once = points;
  points.update(*material);
  for (std::size_t i = 0; i < points.size(); ++i)
    ASSERT_LT((as_matrix<Dim>(points.stress_of(i)) - as_matrix<Dim>(once.stress_of(i))).norm(),
              1e-9 * (once.state[1][i] + std::abs(once.mean(i))))
        << i;
}
TEST(ModifiedCamClay, AdmissibleIdempotentAndDissipative) {
  for (const std::string more :
       {"overconsolidation_ratio: 1", "overconsolidation_ratio: 3", "overconsolidation_ratio: 2, shear_modulus: 1 MPa",
        "preconsolidation_pressure: 20 kPa, poisson_ratio: 0.1"}) {
    SCOPED_TRACE(more);
    expect_admissible<2>(more);
    expect_admissible<3>(more);
  }
}

// With a constant shear modulus elasticity stores what goes in: a closed path within the ellipse does no work, and the
// stored energy is the work done. 1e-4 of it, the midpoint rule over 400 steps.
TEST(ModifiedCamClay, StoresElasticWorkWithConstantShearModulus) {
  const auto material = material_of(keys + "preconsolidation_pressure: 1 MPa, shear_modulus: 5 MPa");
  PathPoints<3> point = at_pressure(*material, 200e3);
  const auto energy = [&] { return material->stored_energy(point.stress_of(0)); };
  const double start = energy();
  double work = 0;
  for (const PathPoints<3>::Tensor& leg :
       {PathPoints<3>::Tensor{-0.01, -0.005, 0, 0.005, 0, 0}, PathPoints<3>::Tensor{0, 0, -0.01, 0, 0.01, 0}}) {
    for (int n = 0; n < 400; ++n) {
      const Eigen::Matrix3d before = as_matrix<3>(point.stress_of(0));
      PathPoints<3>::Tensor step = leg;
      for (double& value : step) value /= 400;
      point.go(*material, step, 1);
      work += (0.5 * (before + as_matrix<3>(point.stress_of(0))).array() * as_matrix<3>(step).array()).sum();
    }
    EXPECT_NEAR(energy() - start, work, 1e-4 * work);
  }
  EXPECT_EQ(point.state[0][0], 0);
}

// p_c at the start: the ratio times the ellipse through the stress, or the given one unless the stress lies outside.
TEST(ModifiedCamClay, RemembersItsConsolidation) {
  const PathPoints<2>::Tensor stress = {-40e3, -70e3, -40e3, 0};  // p = 50 kPa, q = 30 kPa
  const double through = 50e3 + 30e3 * 30e3 / (0.81 * 50e3);
  for (const auto& [more, expected] :
       std::vector<std::pair<std::string, double>>{{"overconsolidation_ratio: 1.5", 1.5 * through},
                                                   {"preconsolidation_pressure: 300 kPa", 300e3},
                                                   {"preconsolidation_pressure: 10 kPa", through}}) {
    const auto material = material_of(keys + more);
    PathPoints<2> point(*material, 1);
    point.set_stress(0, stress);
    point.update(*material);
    EXPECT_NEAR(point.state[1][0], expected, 1e-9 * expected);
    for (int k = 0; k < 4; ++k) EXPECT_NEAR(point.stress[k][0], stress[k], 1e-7);
  }
}

// The stiffness of waves is that of the most compressed point: (1 + e_0) p / kappa and 4/3 of the shear modulus.
TEST(ModifiedCamClay, StiffnessFollowsThePressure) {
  const auto material = material_of(clay);
  PathPoints<2> points(*material, 2);
  points.set_stress(0, {-30e3, -30e3, -30e3, 0});
  points.set_stress(1, {-90e3, -90e3, -90e3, 0});
  std::array<const double*, 4> columns;
  for (int k = 0; k < 4; ++k) columns[k] = points.stress[k].data();
  const double bulk = 90e3 / kappa, shear = bulk * 3 * 0.4 / (2 * 1.3);
  EXPECT_NEAR(material->constrained_modulus(columns, 2), bulk + 4 * shear / 3, 1e-6);
  EXPECT_NEAR(material->elasticity().constrained_modulus(), (bulk + 4 * shear / 3) / 0.9, 1e-6);  // at 100 kPa
}

// Far beyond: opening, huge compression, no stress; finite, and NaN stays for the guard.
TEST(ModifiedCamClay, FiniteAtTheLimits) {
  const auto material = material_of(keys + "overconsolidation_ratio: 1");
  for (const double strain : {0.5, 0.05, -0.05, -0.3}) {
    PathPoints<2> point(*material, 1);
    point.go(*material, {strain, strain, 0, 0.3}, 1);
    EXPECT_TRUE(as_matrix<2>(point.stress_of(0)).allFinite()) << strain;
    EXPECT_GE(-point.mean(0), -1e-6);
    EXPECT_GE(point.state[1][0], 1e3);
  }
  PathPoints<2> point(*material, 1);
  point.strain[0][0] = std::numeric_limits<double>::quiet_NaN();
  point.update(*material);
  EXPECT_TRUE(std::isnan(point.stress[0][0]));
}

TEST(ModifiedCamClay, IsTheSameInAnyBatchAndDimension) {
  const auto material = material_of(keys + "overconsolidation_ratio: 1.2");
  expect_any_batch_gives_the_same_bits<2>(*material);
  expect_any_batch_gives_the_same_bits<3>(*material);
  expect_plane_strain_equals_three_dimensions(*material, 1e-3);  // of stresses up to 1e7 Pa
}

TEST(ModifiedCamClay, SaysWhatIsWrong) {
  expect_complaint(keys + "minimum_pressure: 1 kPa", {"m.yaml:1:1", "none of `overconsolidation_ratio` and"});
  expect_complaint(clay + ", overconsolidation_ratio: 2", {"both of `overconsolidation_ratio` and"});
  expect_complaint(keys + "overconsolidation_ratio: 0.9", {"overconsolidation_ratio", "at least 1"});
  expect_complaint(clay + ", poisson_ratio: 0.2, shear_modulus: 1 MPa", {"poisson_ratio and shear_modulus"});
  expect_complaint(
      "model: modified_cam_clay, density: 1500 kg/m3, critical_stress_ratio: 0.9, lambda: 0.04, kappa: 0.2, "
      "initial_void_ratio: 1, overconsolidation_ratio: 1",
      {"m.yaml:1:", "kappa is 0.2", "below lambda, 0.04"});
  expect_complaint(keys + "overconsolidation_ratio: 1, critical_state_ratio: 1",
                   {"critical_state_ratio", "critical_stress_ratio"});
}

}  // namespace
}  // namespace sluice
