/// Water: viscous stress alone, of the rate of strain.
#include <gtest/gtest.h>

#include "core/case/case_tree.h"
#include "tests/unit/material_point.h"

namespace sluice {
namespace {

std::unique_ptr<Material> water(const std::string& keys = "") {
  return make_material(read_yaml_text("{model: water" + keys + "}", "w.yaml"));
}

std::string message_of(const std::string& keys) {
  try {
    water(keys);
  } catch (const CaseError& error) {
    return error.what();
  }
  return "";
}

TEST(Water, IsALiquidWithoutStiffness) {
  const auto material = water();
  EXPECT_TRUE(material->liquid());
  EXPECT_EQ(material->density(), 1000);
  EXPECT_EQ(water(", density: 1.2 t/m3")->density(), 1200);
  EXPECT_EQ(material->elasticity().constrained_modulus(), 0);
  EXPECT_TRUE(material->columns().empty());
  const std::array<double, 6> stress{1, 2, 3, 4, 5, 6};
  EXPECT_EQ(material->stored_energy(stress), 0);
}

// sigma = 2 mu dev(eps) / dt: simple shear gives tau = mu dv/dz, and a change of volume nothing.
template <int Dim>
void expect_newton() {
  const double viscosity = 0.5, dt = 1e-2;
  const auto material = water(", viscosity: 0.5 Pa s");
  MaterialPoints<Dim> points = MaterialPoints<Dim>::random(100, 3);  // the stress before counts for nothing
  auto batch = points.batch();
  batch.dt = dt;
  material->update(batch);
  for (std::size_t i = 0; i < points.size(); ++i) {
    double trace = 0, mean = 0;
    for (int k = 0; k < 3; ++k) trace += points.strain_increment[k][i], mean += points.stress[k][i];
    EXPECT_NEAR(mean, 0, 1e-13);
    for (int k = 0; k < MaterialPoints<Dim>::components; ++k) {
      const double deviator = points.strain_increment[k][i] - (k < 3 ? trace / 3 : 0);
      EXPECT_NEAR(points.stress[k][i], 2 * viscosity * deviator / dt, 1e-12);
    }
  }
}

TEST(Water, HasTheStressOfNewton) {
  expect_newton<2>();
  expect_newton<3>();
}

TEST(Water, HasNoStressBeforeTheFirstStep) {
  const auto material = water(", viscosity: 0.5 Pa s");
  MaterialPoints<2> points = MaterialPoints<2>::random(10, 3);
  material->update(points.batch());  // dt = 0
  for (std::size_t i = 0; i < points.size(); ++i)
    for (const double s : points.stress_of(i)) EXPECT_EQ(s, 0);
}

TEST(Water, SaysWhatIsWrong) {
  EXPECT_EQ(message_of(", viscosity: -1 Pa s").substr(0, 11), "w.yaml:1:27");
  EXPECT_NE(message_of(", density: 0").find("must be above 0"), std::string::npos);
  EXPECT_NE(message_of(", youngs_modulus: 1 Pa").find("unknown key 'youngs_modulus'"), std::string::npos);
}

}  // namespace
}  // namespace sluice
