/// Mohr-Coulomb with strengths that fall: paths against closed forms, the regularisation, time, and what is refused.
#include <numbers>

#include "physics/materials/mohr_coulomb.h"
#include "tests/unit/material_paths.h"

namespace sluice {
namespace {

constexpr double shear_modulus = 2e6 / 2.6;
const std::string soil = "model: mohr_coulomb, density: 1800 kg/m3, youngs_modulus: 2 MPa, ";
const std::string sand = soil + "friction_angle: 35 deg, cohesion: 5 kPa, dilation_angle: 10 deg";
const std::string falling = ", softening: {friction_angle: 25 deg, cohesion: 1 kPa, dilation_angle: 0 deg, strain: 0.1";
const std::string clay = soil + "friction_angle: 0 deg, cohesion: 10 kPa, softening: {cohesion: 4 kPa, strain: 0.2";

/// Simple shear of clay: tau = c_p - (c_p - c_r) eps / eps_r and tau = G (gamma - 3^(1/2) eps), so that on the way down
/// tau = (c_p - a gamma) / (1 - a / G) with a = (c_p - c_r) / (3^(1/2) eps_r).
double softening_branch(double gamma, double strain) {
  const double a = 6e3 / (std::numbers::sqrt3 * strain);
  return std::max(4e3, (10e3 - a * gamma) / (1 - a / shear_modulus));
}

double shear_stress(const Material& material, double gamma, int steps) {
  PathPoints<2> point(material, 1);
  point.go(material, {0, 0, 0, gamma / 2}, steps);
  return point.stress[3][0];
}

// The strength of the start of a step makes an error of first order: a step of gamma = 1e-3 is wrong by 0.3 % of the
// strength at most, and half the step by half of it. On the residual branch nothing is wrong.
TEST(MohrCoulombSoftening, SimpleShearConvergesWithFirstOrder) {
  const auto material = material_of(clay + "}");
  std::vector<double> errors;
  for (const int steps : {200, 400, 800})
    errors.push_back(shear_stress(*material, 0.2, steps) - softening_branch(0.2, 0.2));
  EXPECT_LT(std::abs(errors[0]), 0.003 * 10e3);
  EXPECT_NEAR(errors[0] / errors[1], 2, 0.05);
  EXPECT_NEAR(errors[1] / errors[2], 2, 0.05);
  EXPECT_NEAR(shear_stress(*material, 1.0, 1000), 4e3, 1e-9);
}

// In cells of half the reference width the strain that softens is twice as large, and so is the work done on a volume:
// over the width of a cell it is the same. The area under the curve above the residual, of the exact triangle
// (c_p - c_r) gamma_p / 2, to the first order of the steps, 1e-3.
TEST(MohrCoulombSoftening, DissipationOfABandDoesNotDependOnTheCell) {
  for (const double cell : {2.0, 1.0, 0.5, 0.1}) {
    const auto material = material_of(clay + ", reference_width: 1 m}");
    material->set_cell_size(cell);
    PathPoints<2> point(*material, 1);
    point.strain[3][0] = 1e-5 / cell;
    double work = 0, before = 0;
    for (int n = 0; n < 40000; ++n) {
      point.update(*material);
      const double tau = point.stress[3][0], plastic = 2 * point.strain[3][0] - (tau - before) / shear_modulus;
      work += (0.5 * (tau + before) - 4e3) * plastic;
      before = tau;
    }
    EXPECT_NEAR(before, 4e3, 1e-9);
    EXPECT_NEAR(work * cell, 0.5 * 6e3 * std::numbers::sqrt3 * 0.2, 1e-3 * 1e3) << cell;
  }
  // The control: without the reference width the work per volume is the same, and that of a band grows with the cell.
  const auto coarse = material_of(clay + "}"), fine = material_of(clay + "}");
  coarse->set_cell_size(1);
  fine->set_cell_size(0.1);
  EXPECT_EQ(shear_stress(*coarse, 0.2, 400), shear_stress(*fine, 0.2, 400));
}

// After much shear the stress lies on the residual surface, as the perfect model of those strengths has it.
template <int Dim>
void expect_residual_surface() {
  const auto material = material_of(sand + falling + "}");
  const MohrCoulombReturn residual(MohrCoulombParameters{.elasticity = IsotropicElasticity::from_young(2e6, 0.3),
                                                         .friction_angle = 25 * std::numbers::pi / 180,
                                                         .cohesion = 1e3});
  PathPoints<Dim> points = random_points<Dim>(*material, 500, 11);
  for (int k = 0; k < 3; ++k)
    for (double& s : points.stress[k]) s -= 50e3;
  for (int n = 0; n < 200; ++n) points.update(*material);
  int softened = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points.state[0][i] < 0.1) continue;
    ++softened;
    const Eigen::Vector3d value =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(as_matrix<Dim>(points.stress_of(i))).eigenvalues();
    ASSERT_NEAR(residual.yield({value[2], value[1], value[0]}), 0, 1e-9 * (value.norm() + 1e3)) << i;
  }
  EXPECT_GT(softened, 100);
}
TEST(MohrCoulombSoftening, EndsOnTheResidualSurface) {
  expect_residual_surface<2>();
  expect_residual_surface<3>();
}

// At its peak, with softening that no strain reaches, the model is the perfect one: 1e-12 of trial stresses of 1 MPa.
template <int Dim>
void expect_perfect_at_the_peak(const std::string& cutoff) {
  const auto perfect = material_of(sand + cutoff), soft = material_of(sand + cutoff + falling + "e12}");
  PathPoints<Dim> a = random_points<Dim>(*perfect, 500, 12), b = random_points<Dim>(*soft, 500, 12);
  a.update(*perfect);
  b.update(*soft);
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (int k = 0; k < symmetric_components<Dim>; ++k) ASSERT_NEAR(a.stress[k][i], b.stress[k][i], 1e-6);
    ASSERT_NEAR(a.state[0][i], b.state[0][i], 1e-12);
  }
}
TEST(MohrCoulombSoftening, IsThePerfectModelAtThePeak) {
  for (const std::string cutoff : {"", ", tension_cutoff: 2 kPa"}) {
    expect_perfect_at_the_peak<2>(cutoff);
    expect_perfect_at_the_peak<3>(cutoff);
  }
}

// The apex falls from 7.1 to 2.1 kPa: a cut-off of 5 kPa acts first and then lies beyond the apex.
TEST(MohrCoulombSoftening, CutoffBeyondTheResidualApex) {
  const auto material = material_of(sand + ", tension_cutoff: 5 kPa" + falling + "}");
  PathPoints<2> point(*material, 1);
  point.go(*material, {0.01, 0.01, 0, 0}, 1);
  EXPECT_NEAR(std::max(point.stress[0][0], point.stress[2][0]), 5e3, 1e-9);
  point.state[0][0] = 1;
  point.go(*material, {0.01, 0.01, 0, 0}, 1);
  EXPECT_NEAR(point.stress[0][0], 1e3 / std::tan(25 * std::numbers::pi / 180), 1e-9);
}

// In time: nothing before the start, half the drop in the middle of the ramp, all of it from its end on; the lower of
// the two counts where strain softens, too. Round-off of 1e4 Pa.
TEST(MohrCoulombSoftening, FallsInTime) {
  const auto ramp = material_of(soil +
                                "friction_angle: 0 deg, cohesion: 10 kPa, softening: {cohesion: 4 kPa, "
                                "start: 10 s, ramp: 4 s}");
  const auto at_once = material_of(soil +
                                   "friction_angle: 0 deg, cohesion: 10 kPa, softening: {cohesion: 4 kPa, "
                                   "start: 10 s}");
  const auto strength = [](const Material& material, double time) {
    PathPoints<2> point(material, 1);
    point.time = time;
    point.go(material, {0, 0, 0, 0.1}, 1);
    return point.stress[3][0];
  };
  EXPECT_NEAR(strength(*ramp, 9.99), 10e3, 1e-9);
  EXPECT_NEAR(strength(*ramp, 12), 7e3, 1e-9);
  EXPECT_NEAR(strength(*ramp, 14), 4e3, 1e-9);
  EXPECT_NEAR(strength(*ramp, 99), 4e3, 1e-9);
  EXPECT_NEAR(strength(*at_once, 9.99), 10e3, 1e-9);
  EXPECT_NEAR(strength(*at_once, 10), 4e3, 1e-9);
  const auto both = material_of(clay + ", start: 10 s, ramp: 4 s}");
  PathPoints<2> point(*both, 1);
  point.time = 11;
  point.go(*both, {0, 0, 0, 0.5}, 1000);
  EXPECT_NEAR(point.stress[3][0], 4e3, 1e-9);
}

TEST(MohrCoulombSoftening, IsTheSameInAnyBatchAndDimension) {
  for (const std::string& keys : {sand + falling + "}", sand + ", tension_cutoff: 2 kPa" + falling + ", start: 0 s}"}) {
    const auto material = material_of(keys);
    expect_any_batch_gives_the_same_bits<2>(*material);
    expect_any_batch_gives_the_same_bits<3>(*material);
    expect_plane_strain_equals_three_dimensions(*material, 1e-5);  // trial stresses of 1e6 to 1e7 Pa
  }
}

TEST(MohrCoulombSoftening, Dissipates) {
  const auto material = material_of(sand + falling + "}");
  expect_dissipation<2>(*material, 20);
  expect_dissipation<3>(*material, 20);
}

TEST(MohrCoulombSoftening, SaysWhatIsWrong) {
  expect_complaint(sand + ", softening: {cohesion: 1 kPa}", {"m.yaml:1:", "neither", "`strain`", "`start`"});
  expect_complaint(sand + ", softening: {strain: 0.1}", {"nothing falls", "cohesion"});
  expect_complaint(sand + ", softening: {strain: 0.1, cohesion: 6 kPa}",
                   {"residual cohesion is 6000 Pa", "at most that of the peak, 5000 Pa"});
  expect_complaint(sand + ", softening: {strain: 0.1, friction_angle: 5 deg}",
                   {"softening: residual dilation_angle is 10 deg", "friction_angle, 5 deg"});
  expect_complaint(sand + ", softening: {strain: 0, cohesion: 1 kPa}", {"strain", "above 0"});
  expect_complaint(sand + ", softening: {strain: 0.1, cohesion: 1 kPa, reference_width: 0 m}", {"reference_width"});
  expect_complaint(sand + ", softening: {start: 1 s, cohesion: 1 kPa, reference_width: 1 m}",
                   {"reference_width", "`strain`", "missing"});
  expect_complaint(sand + ", softening: {strain: 0.1, cohesion: 1 kPa, ramp: 1 s}", {"`ramp`", "`start`", "missing"});
  expect_complaint(sand + ", softening: {strain: 0.1, cohesoin: 1 kPa}", {"cohesoin", "cohesion"});
  expect_complaint(clay + ", friction_angle: 1 deg}", {"friction_angle", "at most that of the peak"});
}

}  // namespace
}  // namespace sluice
