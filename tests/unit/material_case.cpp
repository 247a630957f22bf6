/// Materials from a case file: values, defaults, and the messages of what is wrong.
#include <gtest/gtest.h>

#include <numbers>
#include <string>

#include "physics/materials/material.h"
#include "tests/unit/material_point.h"

namespace sluice {
namespace {

std::unique_ptr<Material> material(const std::string& text) { return make_material(read_yaml_text(text, "soil.yaml")); }

std::string error_of(const std::string& text) {
  try {
    material(text);
  } catch (const CaseError& error) {
    return error.what();
  }
  return "accepted";
}

void expect_words(const std::string& message, const std::vector<std::string>& words) {
  for (const std::string& word : words) EXPECT_NE(message.find(word), std::string::npos) << word << " in " << message;
}

const std::string clay = "{model: mohr_coulomb, density: 1800 kg/m3, youngs_modulus: 2 MPa, ";

TEST(MaterialCase, LinearElasticWithUnitsAndDefault) {
  const auto rock = material("{model: linear_elastic, density: 2.5 t/m3, youngs_modulus: 1 GPa}");
  EXPECT_DOUBLE_EQ(rock->density(), 2500);
  EXPECT_DOUBLE_EQ(rock->elasticity().shear, 1e9 / 2.6);
  EXPECT_TRUE(rock->columns().empty());
}

// The strength that was read shows in simple shear: c cos(phi) at zero mean stress and psi = 0. Round-off of 1e4 Pa.
TEST(MaterialCase, MohrCoulombReadsItsStrength) {
  const auto soil = material(clay + "friction_angle: 30 deg, cohesion: 10 kPa}");
  MaterialPoints<2> points(1);
  points.strain_increment[3][0] = 1;
  soil->update(points.batch());
  EXPECT_NEAR(points.stress[3][0], 10e3 * std::numbers::sqrt3 / 2, 1e-8);

  const auto cracked = material(clay + "friction_angle: 30 deg, cohesion: 10 kPa, tension_cutoff: 1 kPa}");
  points = MaterialPoints<2>(1);
  points.strain_increment[0][0] = points.strain_increment[1][0] = 1;
  cracked->update(points.batch());
  EXPECT_NEAR(points.stress[0][0], 1e3, 1e-8);
}

TEST(MaterialCase, MissingOrUnknownModel) {
  expect_words(error_of("{density: 1800 kg/m3}"), {"soil.yaml:1", "model", "linear_elastic", "mohr_coulomb"});
  expect_words(error_of("{modell: linear_elastic, density: 1800 kg/m3}"), {"soil.yaml:1", "`model`", "`modell`"});
  expect_words(error_of("{model: mohr_colomb, density: 1800 kg/m3}"), {"soil.yaml:1:9", "mohr_colomb", "mohr_coulomb"});
  expect_words(error_of("{model: [1, 2]}"), {"soil.yaml:1:9"});
}

TEST(MaterialCase, ParametersOutOfRange) {
  expect_words(error_of("{model: linear_elastic, density: 1800 kg/m3, youngs_modulus: -2 MPa}"),
               {"soil.yaml:1:", "youngs_modulus", "-2 MPa"});
  expect_words(error_of("{model: linear_elastic, density: 1800 kg/m3, youngs_modulus: 2 MPa, poisson_ratio: 0.5}"),
               {"poisson_ratio", "0.5"});
  expect_words(error_of(clay + "friction_angle: 90 deg, cohesion: 0 kPa}"), {"friction_angle", "90"});
  expect_words(error_of(clay + "friction_angle: 30 deg, cohesion: -1 kPa}"), {"cohesion", "-1 kPa"});
  expect_words(error_of(clay + "friction_angle: 30 deg, cohesion: 1 kPa, tension_cutoff: -1 kPa}"), {"tension_cutoff"});
  expect_words(error_of(clay + "friction_angel: 30 deg, cohesion: 1 kPa}"), {"friction_angel", "friction_angle"});
}

TEST(MaterialCase, ParametersThatContradictEachOther) {
  expect_words(error_of(clay + "friction_angle: 0 deg, cohesion: 0 kPa}"),
               {"soil.yaml:1:", "cohesion", "friction_angle", "above 0"});
  expect_words(error_of(clay + "friction_angle: 20 deg, cohesion: 1 kPa, dilation_angle: 25 deg}"),
               {"soil.yaml:1:", "dilation_angle is 25 deg", "friction_angle, 20 deg"});
}

TEST(MaterialCase, CatalogueDescribesTheModels) {
  const auto& entries = material_registry().entries();
  for (const std::string name : {"linear_elastic", "mohr_coulomb", "von_mises", "tresca", "drucker_prager",
                                 "modified_cam_clay", "newtonian", "bingham", "water"}) {
    ASSERT_TRUE(entries.count(name)) << name;
    EXPECT_FALSE(entries.at(name).summary.empty());
    EXPECT_TRUE(entries.at(name).keys);
  }
}

}  // namespace
}  // namespace sluice
