/// Mohr-Coulomb as a material: tensors in two and three dimensions, batches, vector units.
#include "physics/materials/mohr_coulomb.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "physics/materials/mohr_coulomb_batch.h"
#include "tests/unit/material_point.h"

namespace sluice {
namespace {

constexpr double degree = 3.14159265358979323846 / 180;

MohrCoulombParameters parameters(double friction, double dilation, double cohesion,
                                 double cutoff = std::numeric_limits<double>::infinity()) {
  return {.elasticity = IsotropicElasticity::from_young(2e6, 0.3),
          .friction_angle = friction * degree,
          .cohesion = cohesion,
          .dilation_angle = dilation * degree,
          .tension_cutoff = cutoff};
}

const std::vector<MohrCoulombParameters> sweep = {
    parameters(0, 0, 5e3),   parameters(0, 0, 5e3, 1e3),   parameters(20, 0, 5e3),    parameters(35, 35, 0),
    parameters(35, 15, 5e3), parameters(35, 15, 5e3, 2e3), parameters(45, 20, 2e3, 0)};

template <int Dim>
Eigen::Matrix3d tensor(const std::array<double, symmetric_components<Dim>>& s) {
  Eigen::Matrix3d t = Eigen::Vector3d(s[0], s[1], s[2]).asDiagonal();
  t(0, 1) = t(1, 0) = s[3];
  if constexpr (Dim == 3) {
    t(1, 2) = t(2, 1) = s[4];
    t(0, 2) = t(2, 0) = s[5];
  }
  return t;
}

template <int Dim>
MaterialPoints<Dim> updated(const MohrCoulombParameters& p, MaterialPoints<Dim> points) {
  MohrCoulomb(1800, p).update(points.batch());
  return points;
}

template <int Dim>
MaterialPoints<Dim> without_strain(MaterialPoints<Dim> points) {
  for (auto& column : points.strain_increment) std::fill(column.begin(), column.end(), 0.0);
  std::fill(points.state.begin(), points.state.end(), 0.0);
  return points;
}

// The stress of the independent eigenvalue solver lies within the surface, and a second update without strain changes
// nothing: 1e-12 of the stress, round-off of principal values and back.
template <int Dim>
void expect_admissible_and_idempotent() {
  for (const MohrCoulombParameters& p : sweep) {
    const MohrCoulombReturn map(p);
    MaterialPoints<Dim> once = updated(p, MaterialPoints<Dim>::random(2000, 3));
    const MaterialPoints<Dim> twice = updated(p, without_strain(once));
    int yielded = 0;
    for (std::size_t i = 0; i < once.size(); ++i) {
      const Eigen::Matrix3d s = tensor<Dim>(once.stress_of(i));
      const Eigen::Vector3d value = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(s).eigenvalues();
      const double tolerance = 1e-12 * (s.norm() + map.strength);
      ASSERT_LE(map.yield({value[2], value[1], value[0]}), tolerance);
      ASSERT_LE(value[2], map.cutoff + tolerance);
      ASSERT_LE((tensor<Dim>(twice.stress_of(i)) - s).norm(), tolerance);
      yielded += once.state[i] > 0;
    }
    ASSERT_GT(yielded, 200);
    ASSERT_LT(yielded, 1980);
  }
}
TEST(MohrCoulomb, AdmissibleAndIdempotentIn2D) { expect_admissible_and_idempotent<2>(); }
TEST(MohrCoulomb, AdmissibleAndIdempotentIn3D) { expect_admissible_and_idempotent<3>(); }

// Plane strain is a case of 3-D: 1e-12 of the trial stress (the two find principal values in different ways).
TEST(MohrCoulomb, PlaneStrainEqualsThreeDimensions) {
  for (const MohrCoulombParameters& p : sweep) {
    const MaterialPoints<2> plane_before = MaterialPoints<2>::random(500, 4);
    MaterialPoints<3> solid_before(500);
    for (int k = 0; k < 4; ++k) {
      solid_before.stress[k] = plane_before.stress[k];
      solid_before.strain_increment[k] = plane_before.strain_increment[k];
    }
    const MaterialPoints<2> plane = updated(p, plane_before);
    const MaterialPoints<3> solid = updated(p, solid_before);
    for (std::size_t i = 0; i < 500; ++i) {
      const double trial = 1e5 + 1e7 * std::abs(plane_before.strain_increment[0][i]);
      ASSERT_LT((tensor<2>(plane.stress_of(i)) - tensor<3>(solid.stress_of(i))).norm(), 1e-12 * trial);
      ASSERT_NEAR(plane.state[i], solid.state[i], 1e-12);
    }
  }
}

// Turning stress and strain turns the result: 1e-12 of the largest trial stress, 1e6 Pa.
TEST(MohrCoulomb, TurnsWithItsInput) {
  const Eigen::Matrix3d q = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, -0.5).normalized()).toRotationMatrix();
  for (const MohrCoulombParameters& p : sweep) {
    const MaterialPoints<3> before = MaterialPoints<3>::random(500, 5);
    MaterialPoints<3> turned = before;
    for (std::size_t i = 0; i < 500; ++i) {
      for (auto* columns : {&turned.stress, &turned.strain_increment}) {
        MaterialPoints<3>::Tensor t;
        for (int k = 0; k < 6; ++k) t[k] = (*columns)[k][i];
        const Eigen::Matrix3d r = q * tensor<3>(t) * q.transpose();
        const std::array<double, 6> values = {r(0, 0), r(1, 1), r(2, 2), r(0, 1), r(1, 2), r(0, 2)};
        for (int k = 0; k < 6; ++k) (*columns)[k][i] = values[k];
      }
    }
    const MaterialPoints<3> plain_result = updated(p, before), turned_result = updated(p, turned);
    for (std::size_t i = 0; i < 500; ++i) {
      const Eigen::Matrix3d expected = q * tensor<3>(plain_result.stress_of(i)) * q.transpose();
      ASSERT_LT((tensor<3>(turned_result.stress_of(i)) - expected).norm(), 1e-6);
      ASSERT_NEAR(turned_result.state[i], plain_result.state[i], 1e-12);
    }
  }
}

// The mirror image of an input has the mirror image of the result, to the last bit; so has the exchange of x and y.
TEST(MohrCoulomb, MirrorsExactly) {
  for (const MohrCoulombParameters& p : sweep) {
    const MaterialPoints<2> before = MaterialPoints<2>::random(500, 6);
    MaterialPoints<2> mirrored = before, exchanged = before;
    for (auto* columns : {&mirrored.stress, &mirrored.strain_increment}) {
      for (double& value : (*columns)[3]) value = -value;
    }
    for (auto* columns : {&exchanged.stress, &exchanged.strain_increment}) std::swap((*columns)[0], (*columns)[1]);
    const MaterialPoints<2> result = updated(p, before);
    mirrored = updated(p, mirrored);
    exchanged = updated(p, exchanged);
    for (std::size_t i = 0; i < 500; ++i) {
      const auto s = result.stress_of(i);
      ASSERT_EQ(mirrored.stress_of(i), (std::array{s[0], s[1], s[2], -s[3]}));
      ASSERT_EQ(exchanged.stress_of(i), (std::array{s[1], s[0], s[2], s[3]}));
      ASSERT_EQ(mirrored.state[i], result.state[i]);
      ASSERT_EQ(exchanged.state[i], result.state[i]);
    }
  }
}

// In 3-D a mirror changes the signs of two shear components: exact as well.
TEST(MohrCoulomb, MirrorsExactlyIn3D) {
  for (const MohrCoulombParameters& p : sweep) {
    for (const std::array<int, 2> flipped : {std::array{3, 5}, std::array{3, 4}, std::array{4, 5}}) {
      const MaterialPoints<3> before = MaterialPoints<3>::random(300, 7);
      MaterialPoints<3> mirrored = before;
      for (auto* columns : {&mirrored.stress, &mirrored.strain_increment}) {
        for (const int k : flipped) {
          for (double& value : (*columns)[k]) value = -value;
        }
      }
      const MaterialPoints<3> result = updated(p, before);
      mirrored = updated(p, mirrored);
      for (std::size_t i = 0; i < 300; ++i) {
        auto expected = result.stress_of(i);
        for (const int k : flipped) expected[k] = -expected[k];
        ASSERT_EQ(mirrored.stress_of(i), expected);
        ASSERT_EQ(mirrored.state[i], result.state[i]);
      }
    }
  }
}

template <int Dim, class Update>
void expect_same_bits_in_any_batch(const Update& update) {
  constexpr std::size_t size = 150, end = 140;
  const MaterialPoints<Dim> before = MaterialPoints<Dim>::random(size, 8);
  MaterialPoints<Dim> whole = before, alone = before, cut = before;
  update(whole.batch(0, end));
  for (std::size_t i = 0; i < end; ++i) update(alone.batch(i, 1));
  for (std::size_t first = 0, count = 1; first < end; first += count, count = count % 40 + 3) {
    update(cut.batch(first, std::min(count, end - first)));
  }
  for (std::size_t i = 0; i < size; ++i) {
    ASSERT_EQ(alone.stress_of(i), whole.stress_of(i)) << i;
    ASSERT_EQ(cut.stress_of(i), whole.stress_of(i)) << i;
    ASSERT_EQ(alone.state[i], whole.state[i]) << i;
    ASSERT_EQ(cut.state[i], whole.state[i]) << i;
    if (i >= end) {
      ASSERT_EQ(whole.stress_of(i), before.stress_of(i)) << "touched beyond the batch";
    }
  }
}

// Bit for bit: a point's result depends neither on its neighbours nor on its place.
TEST(MohrCoulomb, AnyBatchGivesTheSameBits) {
  for (const MohrCoulombParameters& p : sweep) {
    const MohrCoulomb material(1800, p);
    expect_same_bits_in_any_batch<2>([&](const MaterialBatch<2>& batch) { material.update(batch); });
    expect_same_bits_in_any_batch<3>([&](const MaterialBatch<3>& batch) { material.update(batch); });
  }
}

void update_here(const MaterialBatch<2>& batch, const MohrCoulombParameters& p) {
  const MohrCoulombReturn map(p);
  const double factor = std::sqrt(2.0) / (6 * p.elasticity.shear);
  if (map.has_cutoff()) {
    mohr_coulomb::update_plane<true>(batch, p.elasticity, mohr_coulomb::Perfect{map}, factor);
  } else {
    mohr_coulomb::update_plane<false>(batch, p.elasticity, mohr_coulomb::Perfect{map}, factor);
  }
}

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
__attribute__((target("arch=x86-64-v3"))) void update_v3(const MaterialBatch<2>& batch,
                                                         const MohrCoulombParameters& p) {
  const MohrCoulombReturn map(p);
  const double factor = std::sqrt(2.0) / (6 * p.elasticity.shear);
  if (map.has_cutoff()) {
    mohr_coulomb::update_plane<true>(batch, p.elasticity, mohr_coulomb::Perfect{map}, factor);
  } else {
    mohr_coulomb::update_plane<false>(batch, p.elasticity, mohr_coulomb::Perfect{map}, factor);
  }
}

__attribute__((target("arch=x86-64-v4"))) void update_v4(const MaterialBatch<2>& batch,
                                                         const MohrCoulombParameters& p) {
  const MohrCoulombReturn map(p);
  const double factor = std::sqrt(2.0) / (6 * p.elasticity.shear);
  if (map.has_cutoff()) {
    mohr_coulomb::update_plane<true>(batch, p.elasticity, mohr_coulomb::Perfect{map}, factor);
  } else {
    mohr_coulomb::update_plane<false>(batch, p.elasticity, mohr_coulomb::Perfect{map}, factor);
  }
}

// The same for each vector unit of this machine, and the units agree with each other to 1e-12 of the stress: they
// differ in fused multiplications alone.
TEST(MohrCoulomb, EveryVectorUnitAgrees) {
  using Update = void (*)(const MaterialBatch<2>&, const MohrCoulombParameters&);
  std::vector<Update> units = {update_here};
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) units.push_back(update_v3);
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl") &&
      __builtin_cpu_supports("avx512bw")) {
    units.push_back(update_v4);
  }
  for (const MohrCoulombParameters& p : sweep) {
    MaterialPoints<2> expected = MaterialPoints<2>::random(500, 9);
    const MaterialPoints<2> before = expected;
    update_here(expected.batch(), p);
    for (const Update update : units) {
      expect_same_bits_in_any_batch<2>([&](const MaterialBatch<2>& batch) { update(batch, p); });
      MaterialPoints<2> points = before;
      update(points.batch(), p);
      for (std::size_t i = 0; i < points.size(); ++i) {
        for (int k = 0; k < 4; ++k) ASSERT_NEAR(points.stress[k][i], expected.stress[k][i], 1e-12 * 1e6);
        ASSERT_NEAR(points.state[i], expected.state[i], 1e-12);
      }
    }
  }
}
#endif

// Zero stress, isotropic stress, equal principal values, no cohesion, huge strains: finite, and elastic stays elastic.
template <int Dim>
void expect_finite_at_degenerate_points() {
  for (const MohrCoulombParameters& p : sweep) {
    MaterialPoints<Dim> points(40);
    for (std::size_t i = 0; i < 20; ++i) {
      for (int k = 0; k < 3; ++k) points.stress[k][i] = (static_cast<double>(i) - 10) * 1e3;
    }
    const MaterialPoints<Dim> zero_strain = updated(p, points);
    EXPECT_EQ(zero_strain.stress_of(0), points.stress_of(0));
    EXPECT_EQ(zero_strain.stress_of(30), points.stress_of(30));
    EXPECT_EQ(zero_strain.state[30], 0);
    for (std::size_t i = 0; i < 40; ++i) {
      points.strain_increment[i % 2][i] = i % 3 == 0 ? 1e20 : -1e20;
      if (i % 5 == 0) points.strain_increment[3][i] = 1e30;
    }
    for (const MaterialPoints<Dim>& result : {zero_strain, updated(p, points)}) {
      for (std::size_t i = 0; i < 40; ++i) {
        ASSERT_TRUE(tensor<Dim>(result.stress_of(i)).allFinite()) << i;
        ASSERT_TRUE(std::isfinite(result.state[i])) << i;
      }
    }
  }
}
TEST(MohrCoulomb, FiniteAtDegeneratePointsIn2D) { expect_finite_at_degenerate_points<2>(); }
TEST(MohrCoulomb, FiniteAtDegeneratePointsIn3D) { expect_finite_at_degenerate_points<3>(); }

// A NaN stays where it is, so that the guard of the time loop finds the point that is to blame.
TEST(MohrCoulomb, NotANumberStaysInItsPoint) {
  MaterialPoints<2> points = MaterialPoints<2>::random(20, 10);
  const MaterialPoints<2> good = updated(sweep[4], points);
  points.stress[0][7] = std::numeric_limits<double>::quiet_NaN();
  const MaterialPoints<2> bad = updated(sweep[4], points);
  EXPECT_TRUE(std::isnan(bad.stress[0][7]));
  for (std::size_t i = 0; i < 20; ++i) {
    if (i != 7) {
      EXPECT_EQ(bad.stress_of(i), good.stress_of(i));
    }
  }
}

// Simple shear of a Tresca material: tau = c, and beyond yield the equivalent plastic strain is (2/3 (2 e_xy^2))^(1/2)
// of the plastic e_xy. Round-off only.
TEST(MohrCoulomb, EquivalentPlasticStrainInSimpleShear) {
  const MohrCoulombParameters p = parameters(0, 0, 5e3);
  MaterialPoints<2> points(1);
  points.strain_increment[3][0] = 0.01;
  for (int n = 0; n < 10; ++n) MohrCoulomb(1800, p).update(points.batch());
  const double plastic = 0.1 - 5e3 / (2 * p.elasticity.shear);
  EXPECT_NEAR(points.stress[3][0], 5e3, 1e-9);
  EXPECT_NEAR(points.state[0], 2 / std::sqrt(3.0) * plastic, 1e-13);
}

TEST(MohrCoulomb, DeclaresItsState) {
  const MohrCoulomb material(1800, sweep[4]);
  ASSERT_EQ(material.columns().size(), 1u);
  EXPECT_EQ(material.columns()[0].name, "equivalent_plastic_strain");
  EXPECT_EQ(material.columns()[0].unit, "1");
  EXPECT_EQ(material.density(), 1800);
}

}  // namespace
}  // namespace sluice
