/// Every registered material on every standard path: the update of the program against the reference whose error is
/// controlled by ARKODE, and its order of convergence.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "physics/element/path.h"
#include "tests/verification/element_fixture.h"

namespace sluice::element {
namespace {

/// Parameters of a material, and what its update may differ from the reference with 200 increments.
struct Sample {
  std::string model, keys;
  double tolerance;  ///< of the largest stress, strain, or state on the path
};

/// At least one for each registered model. Tolerances: 1e-5 is what the reference itself is good for (its tolerance is
/// 1e-6, and it finds first yield some 1e-8 of strain early), for laws whose update is exact where the strain
/// increments keep their direction. The others, and friction where the principal axes turn in simple shear, are of
/// first order in the increment: their tolerance is what 200 increments leave, and the test below shows that it
/// vanishes with them.
const std::vector<Sample>& samples() {
  static const std::vector<Sample> all = {
      {"linear_elastic", "youngs_modulus: 10 MPa, poisson_ratio: 0.3", 1e-5},
      {"mohr_coulomb",
       "youngs_modulus: 20 MPa, poisson_ratio: 0.25, friction_angle: 33 deg, cohesion: 2 kPa, dilation_angle: 6 deg",
       1e-3},
      {"mohr_coulomb",
       "youngs_modulus: 20 MPa, friction_angle: 35 deg, cohesion: 5 kPa, dilation_angle: 5 deg, softening: {strain: "
       "0.1, "
       "friction_angle: 30 deg, cohesion: 1 kPa, dilation_angle: 0 deg}",
       1e-2},
      {"drucker_prager",
       "youngs_modulus: 20 MPa, poisson_ratio: 0.25, friction_angle: 33 deg, cohesion: 2 kPa, dilation_angle: 6 deg",
       1e-3},
      {"von_mises", "youngs_modulus: 10 MPa, poisson_ratio: 0.45, strength: 30 kPa", 1e-5},
      {"von_mises",
       "youngs_modulus: 10 MPa, poisson_ratio: 0.45, strength: 30 kPa, softening: {strain: 0.05, sensitivity: 3}",
       1e-5},
      {"tresca", "youngs_modulus: 10 MPa, poisson_ratio: 0.45, strength_ratio: 0.3, minimum_strength: 2 kPa", 1e-5},
      {"modified_cam_clay",
       "critical_stress_ratio: 1.1, lambda: 0.2, kappa: 0.04, initial_void_ratio: 1.2, overconsolidation_ratio: 1.5",
       5e-3},
      {"modified_cam_clay",
       "critical_stress_ratio: 1.1, lambda: 0.2, kappa: 0.04, initial_void_ratio: 1.2, overconsolidation_ratio: 6, "
       "shear_modulus: 8 MPa",
       5e-3},
      {"newtonian", "bulk_modulus: 1 MPa, viscosity: 1e6 Pa s", 1e-3},
      {"bingham", "bulk_modulus: 1 MPa, shear_modulus: 100 kPa, yield_stress: 2 kPa, viscosity: 2e6 Pa s", 3e-2}};
  return all;
}

const std::vector<std::string>& paths() {
  static const std::vector<std::string> all = {
      "{type: isotropic, strain: 1 %}",
      "{type: oedometer, strain: 2 %}",
      "{type: triaxial_compression, strain: 3 %}",
      "{type: triaxial_extension, strain: 2 %}",
      "{type: direct_simple_shear, strain: 4 %}",
      "{type: triaxial_compression, strain: 3 %, undrained: true}",
      "{type: triaxial_extension, strain: 3 %, undrained: true}",
      "{type: direct_simple_shear, strain: 4 %, undrained: true}",
      "{type: direct_simple_shear, strain: 1 %, cycles: 1, undrained: true}",
      "{type: pure_strain, components: [-0.2 %, 0.1 %, -0.6 %, 0.3 %, -0.2 %, 0.5 %]}"};
  return all;
}

std::vector<Row> rows_with(const Sample& sample, const std::string& path, int increments, int every, bool reference) {
  const ElementCase definition = element_test(
      fmt::format("model: {}, density: 1800 kg/m3, {}", sample.model, sample.keys), "initial_pressure: 100 kPa", path,
      fmt::format("increments: {}\noutput: {{every: {}}}", increments, every));
  return reference ? reference_of(definition) : rows_of(definition);
}

double largest(const Difference& d) { return std::max({d.stress, d.strain, d.state}); }

class ElementReference : public testing::TestWithParam<std::size_t> {};

// Tolerances: those of the samples, and a quarter of the error with four times the increments (first order), to 40 % of
// it for the leading term alone does not rule at 50 increments, or nothing but the error of the reference itself.
TEST_P(ElementReference, update_converges_to_it_on_every_standard_path) {
  const Sample& sample = samples()[GetParam()];
  for (const std::string& path : paths()) {
    SCOPED_TRACE(path);
    const auto expected = rows_with(sample, path, 50, 1, true);
    const double coarse = largest(difference(rows_with(sample, path, 50, 1, false), expected));
    const double fine = largest(difference(rows_with(sample, path, 200, 4, false), expected));
    EXPECT_LT(fine, sample.tolerance);
    EXPECT_LT(fine, 0.4 * coarse + 1e-5);
  }
}

std::string name_of(const testing::TestParamInfo<std::size_t>& info) {
  return samples()[info.param].model + "_" + std::to_string(info.param);
}

INSTANTIATE_TEST_SUITE_P(Materials, ElementReference, testing::Range<std::size_t>(0, samples().size()), name_of);

// The state that yields tells that the paths above are not all elastic: each plastic sample flows in one of them.
TEST(ElementReference, samples_yield) {
  for (const Sample& sample : samples()) {
    if (sample.model == "linear_elastic" || sample.model == "newtonian") continue;
    double flow = 0;
    for (const std::string& path : paths())
      flow = std::max(flow, rows_with(sample, path, 50, 1, false).back().point.state[0]);
    EXPECT_GT(flow, 5e-3) << sample.model;
  }
}

/// Linear elasticity with an error that vanishes in tiny increments: right rates, wrong steps.
class WrongSteps final : public Material {
 public:
  explicit WrongSteps(const Material& right) : right_(right) {}
  double density() const override { return right_.density(); }
  IsotropicElasticity elasticity() const override { return right_.elasticity(); }
  double stored_energy(std::span<const double> stress) const override { return right_.stored_energy(stress); }
  void update(const MaterialBatch<2>&) const override {}
  void update(const MaterialBatch<3>& batch) const override {
    double e[components];
    MaterialBatch<3> wrong = batch;
    for (std::size_t k = 0; k < components; ++k) {
      e[k] = batch.strain_increment[k][0] * (1 + 20 * std::abs(batch.strain_increment[k][0]));
      wrong.strain_increment[k] = &e[k];
    }
    right_.update(wrong);
  }

 private:
  const Material& right_;
};

// The control: an update that is wrong by 20 times the increment, here 0.8 % of it, is found out, and so is its order.
TEST(ElementReference, finds_an_update_that_is_wrong_in_finite_steps) {
  const std::string elastic = "model: linear_elastic, density: 1800 kg/m3, youngs_modulus: 10 MPa";
  std::vector<double> errors;
  for (const int n : {50, 100}) {
    const ElementCase definition = element_test(elastic, "initial_pressure: 100 kPa", "{type: oedometer, strain: 2 %}",
                                                fmt::format("increments: {}", n));
    std::vector<Row> found, expected;
    const auto right = material_of(definition);
    const WrongSteps material(*right);
    drive(definition, material, [&](const Row& row) { found.push_back(row); });
    integrate_reference(definition, material, [&](const Row& row) { expected.push_back(row); });
    errors.push_back(difference(found, expected).stress);
  }
  EXPECT_GT(errors[0], 5e-3);
  EXPECT_NEAR(errors[1] / errors[0], 0.5, 0.01);
}

TEST(ElementReference, knows_every_material_and_every_path) {
  std::set<std::string> models;
  for (const Sample& sample : samples()) models.insert(sample.model);
  for (const std::string& name : material_registry().names()) {
    if (name == "water") continue;  // refused: it has no pressure of its own
    EXPECT_EQ(models.count(name), 1u) << "give `" << name << "` parameters above";
  }
  for (const PathType& type : path_types()) {
    bool there = false;
    for (const std::string& path : paths()) there = there || path.find("type: " + type.name + ",") != std::string::npos;
    EXPECT_TRUE(there) << type.name;
  }
}

}  // namespace
}  // namespace sluice::element
