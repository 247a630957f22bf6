/// Drucker-Prager: the cones against Mohr-Coulomb, every region of the return, and what is refused.
#include <numbers>

#include "physics/materials/mohr_coulomb_return.h"
#include "tests/unit/material_paths.h"

namespace sluice {
namespace {

constexpr double degree = std::numbers::pi / 180;
const std::string soil = "model: drucker_prager, density: 1800 kg/m3, youngs_modulus: 2 MPa, ";
const std::string sand = soil + "friction_angle: 35 deg, cohesion: 5 kPa";

MohrCoulombReturn mohr_coulomb(double friction, double cohesion) {
  return MohrCoulombReturn(MohrCoulombParameters{.elasticity = IsotropicElasticity::from_young(2e6, 0.3),
                                                 .friction_angle = friction * degree,
                                                 .cohesion = cohesion});
}

double mohr_coulomb_yield(const MohrCoulombReturn& map, const Eigen::Matrix3d& s) {
  const Eigen::Vector3d value = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(s).eigenvalues();
  return map.yield({value[2], value[1], value[0]});
}

// In triaxial compression (extension) the cone of that name has the strength of Mohr-Coulomb: 1e-12 of the stress.
TEST(DruckerPrager, MatchesTriaxialStrength) {
  const auto map = mohr_coulomb(35, 5e3);
  for (const auto& [word, sign] : {std::pair{"compression", 1.0}, std::pair{"extension", -1.0}}) {
    const auto material = material_of(sand + ", matching: " + word);
    PathPoints<3> point(*material, 1);
    point.set_stress(0, {-1e5, -1e5, -1e5, 0, 0, 0});
    point.go(*material, {0.1 * sign, 0.1 * sign, -0.2 * sign, 0, 0, 0}, 10);
    EXPECT_NEAR(mohr_coulomb_yield(map, as_matrix<3>(point.stress_of(0))), 0, 1e-12 * 1e6) << word;
  }
}

// In plane-strain flow, with the dilation that belongs to it, the in-plane circle touches the line of Mohr-Coulomb. The
// out-of-plane stress comes to rest exponentially: 1e-9 of the stress after 40 % shear.
TEST(DruckerPrager, MatchesThePlaneStrainFlow) {
  for (const double dilation : {0.0, 10.0, 35.0}) {
    const auto material = material_of(sand + fmt::format(", dilation_angle: {} deg", dilation));
    PathPoints<2> point(*material, 1);
    point.set_stress(0, {-1e5, -1e5, -1e5, 0});
    const double volume = 0.4 * std::sin(dilation * degree);
    point.go(*material, {volume / 2, volume / 2, 0, 0.2}, 4000);
    const auto s = point.stress_of(0);
    const double centre = 0.5 * (s[0] + s[1]), radius = std::hypot(0.5 * (s[0] - s[1]), s[3]);
    EXPECT_NEAR(radius, 5e3 * std::cos(35 * degree) - centre * std::sin(35 * degree), 1e-9 * 1e5) << dilation;
    // Steady flow: one more step changes nothing.
    point.go(*material, {volume / 4000, volume / 4000, 0, 0.4 / 4000}, 1);
    EXPECT_NEAR(point.stress[0][0], s[0], 1e-9 * 1e5) << dilation;
  }
}

// The inscribed cone is nowhere stronger than Mohr-Coulomb and touches each of its faces: 1e-4 of the strength, the
// square of the 1 degree between the Lode angles that are tried. The other cones are stronger somewhere.
TEST(DruckerPrager, InscribedConeTouchesFromWithin) {
  const auto map = mohr_coulomb(35, 5e3);
  for (const std::string word : {"inscribed", "compression", "extension", "plane_strain"}) {
    const auto material = material_of(sand + ", matching: " + word);
    double worst = -1e300;
    for (int lode = 0; lode < 360; ++lode) {
      const double a = lode * degree, third = 2 * std::numbers::pi / 3;
      PathPoints<3> point(*material, 1);
      point.set_stress(0, {-1e5, -1e5, -1e5, 0, 0, 0});
      point.go(*material, {0.2 * std::cos(a), 0.2 * std::cos(a - third), 0.2 * std::cos(a + third), 0, 0, 0}, 1);
      worst = std::max(worst, mohr_coulomb_yield(map, as_matrix<3>(point.stress_of(0))));
    }
    if (word == "inscribed") {
      EXPECT_LT(worst, 1e-9);
      EXPECT_GT(worst, -1e-4 * 2e5);
    } else {
      EXPECT_GT(worst, 1e3) << word;
    }
  }
}

/// Hydrostatic start, one step with volumetric strain `volume` and deviatoric strain `shear` in pure shear.
PathPoints<2> after(const Material& material, double volume, double shear) {
  PathPoints<2> point(material, 1);
  point.set_stress(0, {-20e3, -20e3, -20e3, 0});
  point.go(material, {volume / 2, volume / 2, 0, shear}, 1);
  return point;
}

// Each region by its own closed form: elastic, cone, the edge of cone and cut-off, cut-off alone, apex. 1e-12 of 1e6
// Pa.
TEST(DruckerPrager, EveryRegionOfTheReturn) {
  const std::string keys = sand + ", dilation_angle: 10 deg, matching: inscribed";
  const auto material = material_of(keys), cut = material_of(keys + ", tension_cutoff: 2 kPa");
  const double shear = 2e6 / 2.6, bulk = 2e6 / (3 * 0.4), sine = std::sin(35 * degree);
  const double slope = sine / std::sqrt(1 + sine * sine / 3), intercept = 5e3 * slope / std::tan(35 * degree);
  const double flow = std::sin(10 * degree) / std::sqrt(1 + std::pow(std::sin(10 * degree), 2) / 3);
  const auto root = [](const PathPoints<2>& p) { return p.mises(0) / std::numbers::sqrt3; };
  // What the trial has: strains in the plane give xx and yy alike, zz otherwise.
  const auto trial = [&](double volume, double e) {
    return std::pair{-20e3 + bulk * volume, std::hypot(2 * shear * e, 2 * shear * volume / (2 * std::sqrt(3.0)))};
  };

  EXPECT_EQ(after(*material, 1e-4, 1e-4).state[0][0], 0);

  auto [mean, j] = trial(0, 0.03);
  const double multiplier = (j + slope * mean - intercept) / (shear + bulk * slope * flow);
  const auto cone = after(*material, 0, 0.03);
  EXPECT_NEAR(cone.mean(0), mean - bulk * flow * multiplier, 1e-6);
  EXPECT_NEAR(root(cone), j - shear * multiplier, 1e-6);
  EXPECT_NEAR(cone.state[0][0], multiplier / std::numbers::sqrt3, 1e-12);

  const auto edge = after(*cut, 0.05, 0.03);
  EXPECT_NEAR(edge.mean(0), 2e3, 1e-6);
  EXPECT_NEAR(root(edge), intercept - slope * 2e3, 1e-6);

  std::tie(mean, j) = trial(0.0138, 1e-5);  // a mean just beyond 2 kPa, hardly a deviator: it stays
  const auto cap =
      after(*material_of(soil + "friction_angle: 35 deg, cohesion: 20 kPa, tension_cutoff: 2 kPa"), 0.0138, 1e-5);
  EXPECT_GT(mean, 2e3);
  EXPECT_NEAR(cap.mean(0), 2e3, 1e-6);
  EXPECT_NEAR(root(cap), j, 1e-6);
  EXPECT_EQ(cap.state[0][0], 0);

  const auto apex = after(*material, 0.1, 0.01);
  EXPECT_NEAR(apex.mean(0), 5e3 / std::tan(35 * degree), 1e-6);
  EXPECT_NEAR(root(apex), 0, 1e-6);
}

// One step equals 1e4 small ones from a hydrostatic stress, where the deviator keeps its direction: 1e-6 of the stress.
// Exact up to round-off while the surfaces in action only grow in number.
TEST(DruckerPrager, AgreesWithTinySteps) {
  const auto material = material_of(sand + ", dilation_angle: 10 deg, tension_cutoff: 3 kPa");
  for (const auto& [volume, shear] :
       {std::pair{0.0, 0.1}, std::pair{-0.05, 0.1}, std::pair{0.03, 0.01}, std::pair{0.01, 0.05}}) {
    PathPoints<3> once(*material, 1), often(*material, 1);
    const PathPoints<3>::Tensor strain = {volume / 3, volume / 3, volume / 3, shear, 0.5 * shear, 0};
    for (auto* point : {&once, &often}) point->set_stress(0, {-20e3, -20e3, -20e3, 0, 0, 0});
    once.go(*material, strain, 1);
    often.go(*material, strain, 10000);
    const Eigen::Matrix3d s = as_matrix<3>(once.stress_of(0));
    EXPECT_LT((s - as_matrix<3>(often.stress_of(0))).norm(), 1e-6 * s.norm()) << volume << " " << shear;
    EXPECT_NEAR(once.state[0][0], often.state[0][0], 1e-9);
  }
}

template <int Dim>
void expect_admissible_and_idempotent(const std::string& keys, double friction, double cohesion) {
  const auto material = material_of(keys);
  PathPoints<Dim> points = random_points<Dim>(*material, 2000, 3);
  points.update(*material);
  const PathPoints<Dim> once = points;
  for (auto& column : points.strain) std::fill(column.begin(), column.end(), 0.0);
  points.update(*material);
  const double sine = std::sin(friction * degree), root3 = std::numbers::sqrt3;
  const double slope = 6 * sine / (root3 * (3 - sine)),
               intercept = 6 * cohesion * std::cos(friction * degree) / (root3 * (3 - sine));
  for (std::size_t i = 0; i < once.size(); ++i) {
    const double scale = 1e-12 * (1e4 + std::abs(once.mean(i)) + once.mises(i));
    ASSERT_LE(once.mises(i) / root3 + slope * once.mean(i), intercept + scale);
    for (int k = 0; k < symmetric_components<Dim>; ++k) ASSERT_NEAR(points.stress[k][i], once.stress[k][i], scale);
  }
}
TEST(DruckerPrager, AdmissibleAndIdempotent) {
  for (const double friction : {0.0, 20.0, 45.0})
    for (const std::string more : {"", ", tension_cutoff: 1 kPa"}) {
      const std::string keys =
          soil + fmt::format("friction_angle: {} deg, cohesion: 5 kPa, matching: compression", friction) + more;
      expect_admissible_and_idempotent<2>(keys, friction, 5e3);
      expect_admissible_and_idempotent<3>(keys, friction, 5e3);
    }
}

TEST(DruckerPrager, IsTheSameInAnyBatchAndDimension) {
  const auto material = material_of(sand + ", dilation_angle: 10 deg, tension_cutoff: 1 kPa");
  expect_any_batch_gives_the_same_bits<2>(*material);
  expect_any_batch_gives_the_same_bits<3>(*material);
  expect_plane_strain_equals_three_dimensions(*material, 1e-7);
}

TEST(DruckerPrager, Dissipates) {
  for (const std::string more : {"", ", dilation_angle: 35 deg", ", dilation_angle: 10 deg, tension_cutoff: 0 Pa"}) {
    const auto material = material_of(sand + more);
    expect_dissipation<2>(*material, 20);
    expect_dissipation<3>(*material, 20);
  }
}

TEST(DruckerPrager, SaysWhatIsWrong) {
  expect_complaint(soil + "friction_angle: 0 deg, cohesion: 0 kPa", {"m.yaml:1:", "no strength at all"});
  expect_complaint(sand + ", dilation_angle: 40 deg", {"dilation_angle is 40 deg", "friction_angle, 35 deg"});
  expect_complaint(sand + ", matching: outer", {"matching", "outer", "compression"});
  expect_complaint(sand + ", matching: inscribd", {"did you mean", "inscribed"});
  expect_complaint(sand + ", tension_cutoff: -1 kPa", {"tension_cutoff"});
}

}  // namespace
}  // namespace sluice
