/// Laboratory tests whose end, or whole path, has a closed form: the driver, mixed control and the materials together.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/verification/element_fixture.h"

namespace sluice::element {
namespace {

const std::string elastic = "model: linear_elastic, density: 1800 kg/m3, youngs_modulus: 10 MPa, poisson_ratio: 0.3";
const std::string clay =
    "model: modified_cam_clay, density: 1700 kg/m3, critical_stress_ratio: 1.1, lambda: 0.2, kappa: 0.04, "
    "initial_void_ratio: 1.2, overconsolidation_ratio: ";
const std::string p100 = "initial_pressure: 100 kPa";

std::string sand(double cohesion, double dilation) {
  return fmt::format(
      "model: mohr_coulomb, density: 1700 kg/m3, youngs_modulus: 30 MPa, poisson_ratio: 0.25, friction_angle: 35 deg, "
      "cohesion: {} Pa, dilation_angle: {} deg",
      cohesion, dilation);
}

double sine(double degrees) { return std::sin(degrees * std::numbers::pi / 180); }

PointState end_of(const std::string& material, const std::string& start, const std::string& path,
                  const std::string& rest = "increments: 100") {
  return rows_of(element_test(material, start, path, rest)).back().point;
}

// ---- linear elasticity: mixed control leaves 1e-11 of the largest stress an increment, hence 1e-9 here ----

TEST(ElementClosedForm, elastic_oedometer) {
  const IsotropicElasticity e = IsotropicElasticity::from_young(10e6, 0.3);
  const PointState p = end_of(elastic, "", "{type: oedometer, strain: 1 %}");
  EXPECT_NEAR(p.stress[2] / (-0.01 * e.constrained_modulus()), 1, 1e-9);
  EXPECT_NEAR(p.stress[0] / (-0.01 * e.lambda), 1, 1e-9);
  const PointState loaded = end_of(elastic, "", "{type: oedometer, stress: 50 kPa}");
  EXPECT_NEAR(loaded.strain[2] / (-50e3 / e.constrained_modulus()), 1, 1e-9);
}

TEST(ElementClosedForm, elastic_triaxial) {
  const PointState p = end_of(elastic, p100, "{type: triaxial_compression, strain: 1 %}");
  EXPECT_NEAR(p.stress[2], -100e3 - 0.01 * 10e6, 1e-3);
  EXPECT_NEAR(p.stress[0], -100e3, 1e-3);
  EXPECT_NEAR(p.strain[0], 0.3 * 0.01, 1e-10);
  const PointState isotropic = end_of(elastic, p100, "{type: isotropic, stress: 50 kPa}");
  const double bulk = 10e6 / (3 * (1 - 2 * 0.3));
  EXPECT_NEAR(isotropic.strain[0] + isotropic.strain[1] + isotropic.strain[2], -50e3 / bulk, 1e-10);
}

// Undrained, elastic and isotropic: q = 3 G eps, the effective pressure stays, and u = q / 3 (Skempton's A = 1/3).
TEST(ElementClosedForm, elastic_undrained_triaxial) {
  const double shear = 10e6 / 2.6;
  for (const auto& [path, sign] : {std::pair{"{type: triaxial_compression, strain: 1 %, undrained: true}", 1.0},
                                   {"{type: triaxial_extension, strain: 1 %, undrained: true}", -1.0}}) {
    const PointState p = end_of(elastic, p100, path);
    EXPECT_NEAR(mises_stress(p.stress), 3 * shear * 0.01, 1e-3);
    EXPECT_NEAR(pressure(p.stress), 100e3, 1e-3);
    EXPECT_NEAR(p.pore_pressure, sign * shear * 0.01, 1e-3);
    EXPECT_NEAR(p.strain[0] + p.strain[1] + p.strain[2], 0, 1e-12);
  }
}

// ---- Mohr-Coulomb; held stress to 1e-9 of it, and the strength follows ----

TEST(ElementClosedForm, mohr_coulomb_triaxial_strength_and_dilation) {
  const double ratio = (1 + sine(35)) / (1 - sine(35)), cohesion = 4e3, dilation = 8;
  const auto rows = rows_of(
      element_test(sand(cohesion, dilation), p100, "{type: triaxial_compression, strain: 4 %}", "increments: 100"));
  const PointState &end = rows.back().point, &before = rows[rows.size() - 2].point;
  EXPECT_NEAR(-end.stress[2], ratio * 100e3 + 2 * cohesion * std::sqrt(ratio), 1e-2);
  EXPECT_NEAR(-end.stress[0], 100e3, 1e-2);
  const auto volume = [](const PointState& p) { return p.strain[0] + p.strain[1] + p.strain[2]; };
  EXPECT_NEAR((volume(end) - volume(before)) / (before.strain[2] - end.strain[2]),
              2 * sine(dilation) / (1 - sine(dilation)), 1e-6);

  const PointState extended = end_of(sand(0, 0), p100, "{type: triaxial_extension, strain: 3 %}");
  EXPECT_NEAR(extended.stress[0] / extended.stress[2], ratio, 1e-7);
  const PointState dry = end_of(sand(0, 0), p100, "{type: triaxial_compression, strain: 3 %}");
  EXPECT_NEAR(dry.stress[2] / dry.stress[0], ratio, 1e-7);
}

// Isotropic extension: the apex c cot(phi), to round-off.
TEST(ElementClosedForm, mohr_coulomb_apex) {
  const PointState p = end_of(sand(4e3, 8), "", "{type: pure_strain, components: [1 %, 1 %, 1 %, 0, 0, 0]}");
  const double apex = 4e3 * std::sqrt(1 - sine(35) * sine(35)) / sine(35);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(p.stress[k], apex, 1e-6);
}

// ---- undrained strength: in shear s_u in both; in compression 3^(1/2) s_u after von Mises, 2 s_u after Tresca ----

TEST(ElementClosedForm, undrained_strength) {
  for (const std::string model : {"von_mises", "tresca"}) {
    const std::string keys = "model: " + model + ", density: 1700 kg/m3, youngs_modulus: 10 MPa, strength: 25 kPa";
    for (const std::string undrained : {"true", "false"}) {
      const PointState p = end_of(keys, p100, "{type: direct_simple_shear, strain: 3 %, undrained: " + undrained + "}");
      EXPECT_NEAR(p.stress[5], 25e3, 1e-4) << model;
      const PointState t =
          end_of(keys, p100, "{type: triaxial_compression, strain: 3 %, undrained: " + undrained + "}");
      EXPECT_NEAR(mises_stress(t.stress), 25e3 * (model == "tresca" ? 2 : std::numbers::sqrt3), 1e-2) << model;
    }
  }
}

// A strength that is a share of the overburden takes the vertical stress, zz, and remembers that of the start.
TEST(ElementClosedForm, strength_ratio_takes_the_initial_vertical_stress) {
  const PointState p =
      end_of("model: tresca, density: 1700 kg/m3, youngs_modulus: 8 MPa, strength_ratio: 0.25, minimum_strength: 5 kPa",
             "initial_stress: [-70, -70, -100, 0, 0, 0, kPa]", "{type: triaxial_extension, strain: 3 %}");
  EXPECT_NEAR(mises_stress(p.stress), 2 * 25e3, 1e-2);
}

// ---- modified Cam clay, equations CC of docs/materials/modified_cam_clay.md ----

// First compression is exact in any steps, whether strain or stress drives it: 1e-8 of the pressure.
TEST(ElementClosedForm, cam_clay_isotropic_line) {
  const PointState p = end_of(clay + "1", p100, "{type: isotropic, strain: 10 %}", "increments: 20");
  EXPECT_NEAR(pressure(p.stress) / (100e3 * std::exp(0.1 / (0.2 / 2.2))), 1, 1e-8);
  const PointState s = end_of(clay + "1", p100, "{type: isotropic, stress: 300 kPa}", "increments: 20");
  EXPECT_NEAR(-(s.strain[0] + s.strain[1] + s.strain[2]), 0.2 / 2.2 * std::log(4), 1e-8);
}

// (CC.10) at 20 %: within 1e-3, what is left of the approach and first order in 1000 increments.
TEST(ElementClosedForm, cam_clay_undrained_strength) {
  for (const double ratio : {1.0, 1.5, 4.0}) {
    const PointState p = end_of(clay + std::to_string(ratio), p100,
                                "{type: triaxial_compression, strain: 30 %, undrained: true}", "increments: 1000");
    EXPECT_NEAR(mises_stress(p.stress) / (1.1 * 100e3 * std::pow(ratio / 2, 0.8)), 1, 1e-3) << ratio;
    EXPECT_NEAR(mises_stress(p.stress) / pressure(p.stress), 1.1, 1e-3) << ratio;
    // total stress: the cell pressure stays
    EXPECT_NEAR(-p.stress[0] + p.pore_pressure, 100e3, 1e-2);
  }
}

// (CC.12): 1e-3, as above.
TEST(ElementClosedForm, cam_clay_drained_critical_state) {
  const PointState p = end_of(clay + "1", p100, "{type: triaxial_compression, strain: 100 %}", "increments: 2000");
  EXPECT_NEAR(mises_stress(p.stress) / (3 * 1.1 * 100e3 / (3 - 1.1)), 1, 1e-3);
  EXPECT_NEAR(mises_stress(p.stress) / pressure(p.stress), 1.1, 1e-3);
}

// The reference alone against the whole undrained path (CC.11): 2e-5, some ten times its tolerance.
TEST(ElementClosedForm, reference_follows_the_undrained_path_of_cam_clay) {
  const auto rows = reference_of(
      element_test(clay + "1", p100, "{type: triaxial_compression, strain: 10 %, undrained: true}", "increments: 50"));
  for (const Row& row : rows) {
    const double p = pressure(row.point.stress), eta = mises_stress(row.point.stress) / p;
    EXPECT_NEAR(p / (100e3 * std::pow(1.21 / (1.21 + eta * eta), 0.8)), 1, 2e-5);
  }
  EXPECT_GT(mises_stress(rows.back().point.stress), 60e3);
}

// ---- liquids ----

// Shear to a steady rate, (BH.3) and (NF): tau_y + mu gamma'; then rest, at which the excess over tau_y decays with
// exp(-G t / mu). The reference has it to 1e-5; the update is exact in steady flow and of first order in decay.
TEST(ElementClosedForm, bingham_flow_and_relaxation) {
  const ElementCase mud = element_test(
      "model: bingham, density: 1500 kg/m3, bulk_modulus: 1 MPa, shear_modulus: 20 kPa, yield_stress: 100 Pa, "
      "viscosity: 500 Pa s",
      "", "[{duration: 1 s, strain_rate: {xz: 0.1 1/s}}, {duration: 0.05 s}]", "increments: 500");
  const double flowing = 100 + 500 * 0.2, resting = 100 + 500 * 0.2 * std::exp(-20e3 * 0.05 / 500);
  const auto found = rows_of(mud), expected = reference_of(mud);
  EXPECT_NEAR(found[500].point.stress[5], flowing, 1e-5 * flowing);
  EXPECT_NEAR(expected[500].point.stress[5], flowing, 1e-5 * flowing);
  EXPECT_NEAR(found.back().point.stress[5], resting, 2e-3 * resting);
  EXPECT_NEAR(expected.back().point.stress[5], resting, 1e-5 * resting);
}

TEST(ElementClosedForm, newtonian_shear) {
  const std::string liquid = "model: newtonian, bulk_modulus: 1 MPa, viscosity: 1e4 Pa s";
  const PointState p = end_of(liquid, p100, "{type: direct_simple_shear, strain: 10 %, duration: 2 s}");
  EXPECT_NEAR(p.stress[5], 1e4 * 0.05, 1e-6);
  EXPECT_NEAR(p.stress[2], -100e3, 1e-3);
}

}  // namespace
}  // namespace sluice::element
