/// The file of `sluice element`: what it may say, what its paths become, and what is said about mistakes.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <set>
#include <sstream>

#include "physics/element/driver.h"
#include "physics/element/newton.h"
#include "physics/element/path.h"

namespace sluice::element {
namespace {

const std::string elastic = "{model: linear_elastic, density: 1800 kg/m3, youngs_modulus: 10 MPa}";

/// Line 1 schema, 2 material, 3 start, 4 path, 5 the rest.
std::string file(const std::string& path, const std::string& start = "initial_pressure: 100 kPa",
                 const std::string& rest = "increments: 10", const std::string& material = elastic) {
  return "schema: 1\nmaterial: " + material + "\n" + start + "\npath: " + path + "\n" + rest + "\n";
}

std::string complaint_about(const std::string& text) {
  try {
    parse_element(text, "e.yaml");
  } catch (const CaseError& error) {
    return error.what();
  }
  return "accepted";
}

void expect_complaint(const std::string& text, const std::vector<std::string>& words) {
  const std::string message = complaint_about(text);
  for (const std::string& word : words) EXPECT_NE(message.find(word), std::string::npos) << word << " in " << message;
}

const std::string usual = "{type: triaxial_compression, strain: 5 %}";

// ---- what is read ----

TEST(ElementCase, reads_a_named_path) {
  const ElementCase e =
      parse_element(file("{type: direct_simple_shear, strain: 4 %, duration: 20 s, undrained: true}"), "e");
  ASSERT_EQ(e.stages.size(), 1u);
  const Stage& stage = e.stages[0];
  EXPECT_TRUE(stage.undrained);
  EXPECT_EQ(stage.increments, 10);
  EXPECT_DOUBLE_EQ(stage.strain_rate[5], 0.5 * 0.04 / 20);  // gamma is twice the tensor strain
  EXPECT_TRUE(stage.stress_given[2]);
  EXPECT_FALSE(stage.stress_given[0]);
  EXPECT_DOUBLE_EQ(e.initial_stress[1], -100e3);
}

TEST(ElementCase, reads_stages) {
  const ElementCase e = parse_element(file("[{duration: 2 s, strain_rate: {zz: -1 %/s}, stress: {xx: hold, yy: -80 "
                                           "kPa}}, {duration: 1 s, increments: 3}]"),
                                      "e");
  ASSERT_EQ(e.stages.size(), 2u);
  EXPECT_DOUBLE_EQ(e.stages[0].strain_rate[2], -0.01);
  EXPECT_TRUE(e.stages[0].stress_given[0]);
  EXPECT_FALSE(e.stages[0].stress[0].has_value());
  EXPECT_DOUBLE_EQ(*e.stages[0].stress[1], -80e3);
  EXPECT_EQ(e.stages[0].increments, 10);
  EXPECT_EQ(e.stages[1].increments, 3);
}

// Cycles: strain between + and - the amplitude and back to 0; one-way where only compression has a meaning.
TEST(ElementCase, cycles_swing_about_the_start) {
  const auto peaks = [](const std::string& path, std::size_t component) {
    std::vector<double> reached;
    double strain = 0;
    for (const Stage& stage : parse_element(file(path), "e").stages) {
      strain += stage.strain_rate[component] * stage.duration;
      reached.push_back(std::round(strain * 1e6) / 1e6);
    }
    return reached;
  };
  EXPECT_EQ(peaks("{type: direct_simple_shear, strain: 2 %, cycles: 2}", 5),
            (std::vector<double>{0.01, -0.01, 0.01, -0.01, 0}));
  EXPECT_EQ(peaks("{type: oedometer, strain: 2 %, cycles: 2}", 2), (std::vector<double>{-0.02, 0, -0.02, 0}));
  std::vector<double> stresses;
  for (const Stage& stage : parse_element(file("{type: triaxial_compression, stress: 30 kPa, cycles: 1}"), "e").stages)
    stresses.push_back(*stage.stress[2]);
  EXPECT_EQ(stresses, (std::vector<double>{-130e3, -70e3, -100e3}));
}

TEST(ElementCase, strain_increment_decides_their_number) {
  const auto increments = [](const std::string& path) {
    std::vector<int> all;
    for (const Stage& stage :
         parse_element(file(path, "initial_pressure: 1 kPa", "strain_increment: 0.1 %"), "e").stages)
      all.push_back(stage.increments);
    return all;
  };
  EXPECT_EQ(increments(usual), (std::vector<int>{50}));
  EXPECT_EQ(increments("{type: triaxial_compression, strain: 1 %, cycles: 1}"), (std::vector<int>{10, 20, 10}));
}

TEST(ElementCase, resolved_reads_back_as_the_same) {
  const ElementCase e = parse_element(file(usual), "e");
  EXPECT_NE(e.resolved.find("poisson_ratio: 0.3"), std::string::npos) << e.resolved;
  EXPECT_EQ(parse_element(e.resolved, "again").resolved, e.resolved);
  const ElementCase stages = parse_element(file("[{duration: 2 s, stress: {zz: hold}}]"), "e");
  EXPECT_EQ(parse_element(stages.resolved, "again").resolved, stages.resolved);
}

TEST(ElementCase, overrides_and_void_ratio) {
  const ElementCase e = parse_element(file(usual), "e", {{"path.strain", "1 %"}, {"initial_void_ratio", "0.7"}});
  EXPECT_DOUBLE_EQ(e.stages[0].strain_rate[2] * e.stages[0].duration, -0.01);
  EXPECT_DOUBLE_EQ(*e.initial_void_ratio, 0.7);
  const ElementCase clay = parse_element(
      file(usual, "initial_pressure: 100 kPa", "increments: 5",
           "{model: modified_cam_clay, density: 1700 kg/m3, critical_stress_ratio: 1, lambda: 0.2, kappa: 0.04, "
           "initial_void_ratio: 1.3, overconsolidation_ratio: 2}"),
      "e");
  EXPECT_DOUBLE_EQ(*clay.initial_void_ratio, 1.3);
}

// ---- what is refused: place, what was found, what is allowed ----

TEST(BadElementFile, keys_and_words) {
  expect_complaint(
      file("{type: triaxal_compression, strain: 5 %}"),
      {"e.yaml:4:14", "triaxal_compression", "allowed: isotropic, oedometer", "did you mean 'triaxial_compression'?"});
  expect_complaint(file(usual, "initial_presure: 1 kPa"),
                   {"e.yaml:3:1", "unknown key 'initial_presure'", "did you mean 'initial_pressure'?"});
  expect_complaint(file("{type: oedometer, strain: 5 kPa}"),
                   {"e.yaml:4:33: strain: found '5 kPa', a stress; expected a plain number"});
  expect_complaint(file("{type: oedometer, strain: -5 %}"), {"e.yaml:4:33", "above 0"});
  expect_complaint("schema: 2\nmaterial: " + elastic + "\npath: " + usual, {"e.yaml:1:9", "schema 1 only"});
  expect_complaint("schema: 1\npath: " + usual, {"the key 'material' is missing"});
  expect_complaint("schema: 1\nmaterial: " + elastic, {"the key 'path' is missing"});
  expect_complaint(file(usual, "increments: 0", ""),
                   {"e.yaml:3:13", "increments is 0; it must be at least 1 and at most 1000000"});
}

TEST(BadElementFile, material) {
  expect_complaint(file(usual, "title: t", "", "{model: mohr_colomb}"),
                   {"e.yaml:2:19", "did you mean 'mohr_coulomb'?"});
  expect_complaint(file(usual, "title: t", "", "{model: linear_elastic, density: 1 kg/m3, youngs_modulus: 1 m}"),
                   {"e.yaml:2:", "youngs_modulus"});
  expect_complaint(file(usual, "title: t", "", "sand"), {"e.yaml:2:11", "expected a section with a model"});
  expect_complaint(file(usual, "title: t", "", "{model: water}"), {"e.yaml:2:19", "water has no stress of its own"});
}

TEST(BadElementFile, contradictions_of_a_named_path) {
  expect_complaint(file("{type: oedometer}"), {"e.yaml:4:7", "none of `strain` and `stress` is given"});
  expect_complaint(file("{type: oedometer, strain: 1 %, stress: 1 kPa}"), {"both of `strain` and `stress` are given"});
  expect_complaint(file("{type: oedometer, strain: 1 %, undrained: true}"),
                   {"`undrained` is for triaxial and shear", "oedometer"});
  expect_complaint(file("{type: pure_strain, strain: 1 %}"), {"needs `components: [xx, yy, zz, xy, yz, xz]`"});
  expect_complaint(file("{type: pure_strain, components: [1 %, 0, 0]}"),
                   {"e.yaml:4:39", "found 3 components; expected 6"});
  expect_complaint(file("{type: isotropic, strain: 1 %, components: [0, 0, 0, 0, 0, 0]}"),
                   {"`components` is for `type: pure_strain` only"});
}

TEST(BadElementFile, stages) {
  expect_complaint(file("[]"), {"e.yaml:4:7", "an empty list"});
  expect_complaint(file("[{strain_rate: {zz: 1 1/s}}]"), {"e.yaml:4:8", "the key 'duration' is missing"});
  expect_complaint(file("[{duration: 1 s, strain_rate: {zy: 1 1/s}}]"),
                   {"e.yaml:4:38", "unknown component 'zy'", "xx, yy, zz, xy, yz, xz"});
  expect_complaint(file("[{duration: 1 s, strain_rate: {zz: 1 s}}]"), {"e.yaml:4:42", "strain_rate.zz", "a rate"});
  expect_complaint(file("[{duration: 1 s, stress: {zz: hodl}}]"), {"e.yaml:4:37", "stress.zz", "did you mean 'hold'?"});
  expect_complaint(file("[{duration: 1 s, stress: {zz: hold}, strain_rate: {zz: 1 1/s}}]"),
                   {"e.yaml:4:58", "strain rate and stress are both given"});
  expect_complaint(file("[{duration: 1 s, undrained: true, stress: {xz: hold}}]"),
                   {"e.yaml:4:8", "at least one of xx, yy, zz"});
  expect_complaint(file("[{duration: 1 s, stress: hold}]"), {"e.yaml:4:32", "expected values by component"});
}

TEST(BadElementFile, numbers_that_exclude_each_other) {
  expect_complaint(file(usual, "initial_pressure: 1 kPa", "initial_stress: [0, 0, 0, 0, 0, 0]"),
                   {"e.yaml:3:19", "initial_stress and initial_pressure are both given"});
  expect_complaint(file(usual, "strain_increment: 1 %"),
                   {"e.yaml:3:19", "increments and strain_increment are both given"});
  expect_complaint(file("{type: isotropic, stress: 1 kPa}", "strain_increment: 1 %", ""),
                   {"e.yaml:4:7", "no strain is given here; name `increments` instead"});
  expect_complaint(file(usual, "strain_increment: 1e-9", ""), {"e.yaml:4:7", "at most 1000000"});
}

// Everything that is wrong is said at once.
TEST(BadElementFile, is_told_all_of_it) {
  expect_complaint(file("{type: oedomter, strain: 1 m}", "initial_pressure: 1 m"),
                   {"e.yaml:3:19", "e.yaml:4:14", "e.yaml:4:32"});
}

// ---- the point ----

TEST(ElementPoint, is_refused_outside_of_the_yield_surface) {
  const std::string sand =
      "{model: mohr_coulomb, density: 1700 kg/m3, youngs_modulus: 20 MPa, friction_angle: 30 deg, cohesion: 0 Pa}";
  const ElementCase e =
      parse_element(file(usual, "initial_stress: [-10, -10, -100, 0, 0, 0, kPa]", "", sand), "e.yaml");
  try {
    initial_point(e, *material_of(e));
    FAIL() << "accepted";
  } catch (const CaseError& error) {
    EXPECT_NE(std::string(error.what()).find("e.yaml:3:17: the initial stress is more than the material bears"),
              std::string::npos)
        << error.what();
  }
}

TEST(ElementPoint, invariants) {
  EXPECT_DOUBLE_EQ(pressure({-30, -20, -10, 5, 5, 5}), 20);
  EXPECT_DOUBLE_EQ(mises_stress({-20, -20, -50, 0, 0, 0}), 30);
  EXPECT_DOUBLE_EQ(mises_stress({0, 0, 0, 0, 0, 10}), 10 * std::sqrt(3.0));
}

// ---- Newton ----

// A kink, and two equations of which one says nothing new: the shortest of all solutions is found.
TEST(ElementNewton, passes_kinks_and_takes_the_shortest_solution) {
  const auto residual = [](const Vector& x) {
    const double sum = x[0] + x[1], bent = sum < 1 ? 10 * sum : 10 + 0.1 * (sum - 1);
    return Vector{{bent - 11, bent - 11}};
  };
  Vector x = Vector::Zero(2);
  EXPECT_TRUE(newton(residual, x, {.perturbation = 1e-6, .tolerance = 1e-10, .acceptable = 1e-8}));
  EXPECT_NEAR(x[0], 5.5, 1e-6);
  EXPECT_NEAR(x[1], 5.5, 1e-6);
}

TEST(ElementNewton, says_that_there_is_no_solution) {
  Vector x = Vector::Zero(1);
  EXPECT_FALSE(newton([](const Vector& v) { return Vector{{std::tanh(v[0]) - 2}}; }, x,
                      {.perturbation = 1e-6, .tolerance = 1e-10, .acceptable = 1e-8}));
}

// ---- the manual ----

// docs/element.md has a row for each key.
void expect_rows(const std::vector<FieldDoc>& docs, const std::string& page) {
  for (const FieldDoc& doc : docs) {
    EXPECT_NE(page.find("| `" + doc.name + "` |"), std::string::npos) << doc.name;
    expect_rows(doc.nested, page);
    for (const FieldDoc& other : doc.alternatives) expect_rows(other.nested, page);
  }
}

TEST(ElementManual, names_every_key_and_path) {
  std::ifstream in(SLUICE_SOURCE_DIR "/docs/element.md");
  std::ostringstream page;
  page << in.rdbuf();
  expect_rows(element_docs(), page.str());
  for (const PathType& type : path_types())
    EXPECT_NE(page.str().find("| `" + type.name + "` |"), std::string::npos) << type.name;
}

}  // namespace
}  // namespace sluice::element
