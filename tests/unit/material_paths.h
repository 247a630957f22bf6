/// Strain paths at one material point, for tests of constitutive models, and what can be said of any of them.
#pragma once

#include <gtest/gtest.h>

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "core/case/case_tree.h"
#include "physics/materials/material.h"

namespace sluice {

inline std::unique_ptr<Material> material_of(const std::string& keys) {
  return make_material(read_yaml_text("{" + keys + "}", "m.yaml"));
}

/// What is said about wrong keys; "accepted" if nothing is.
inline std::string complaint_about(const std::string& keys) {
  try {
    material_of(keys);
  } catch (const CaseError& error) {
    return error.what();
  }
  return "accepted";
}

inline void expect_complaint(const std::string& keys, const std::vector<std::string>& words) {
  const std::string message = complaint_about(keys);
  for (const std::string& word : words) EXPECT_NE(message.find(word), std::string::npos) << word << " in " << message;
}

template <int Dim>
Eigen::Matrix3d as_matrix(const std::array<double, symmetric_components<Dim>>& t) {
  Eigen::Matrix3d m = Eigen::Vector3d(t[0], t[1], t[2]).asDiagonal();
  m(0, 1) = m(1, 0) = t[3];
  if constexpr (Dim == 3) {
    m(1, 2) = m(2, 1) = t[4];
    m(0, 2) = m(2, 0) = t[5];
  }
  return m;
}

/// Points with as many state columns as the material wants.
template <int Dim>
class PathPoints {
 public:
  static constexpr int components = symmetric_components<Dim>;
  using Tensor = std::array<double, components>;

  PathPoints(const Material& material, std::size_t size) {
    for (auto* columns : {&strain, &stress})
      for (auto& column : *columns) column.assign(size, 0.0);
    for (const ColumnSpec& spec : material.columns())
      for (int c = 0; c < spec.components; ++c) state.emplace_back(size, 0.0);
  }

  std::size_t size() const { return stress[0].size(); }
  MaterialBatch<Dim> batch(std::size_t first, std::size_t count) {
    MaterialBatch<Dim> b;
    b.size = count;
    b.dt = dt;
    b.time = time;
    for (int k = 0; k < components; ++k) {
      b.strain_increment[k] = strain[k].data() + first;
      b.stress[k] = stress[k].data() + first;
    }
    pointers_.clear();
    for (auto& column : state) pointers_.push_back(column.data() + first);
    b.state = pointers_;
    return b;
  }
  void update(const Material& material) { material.update(batch(0, size())); }

  /// Point 0 goes `steps` equal steps along `total`.
  void go(const Material& material, const Tensor& total, int steps) {
    for (int k = 0; k < components; ++k) strain[k][0] = total[k] / steps;
    for (int n = 0; n < steps; ++n) update(material);
  }

  Tensor stress_of(std::size_t i) const {
    Tensor s;
    for (int k = 0; k < components; ++k) s[k] = stress[k][i];
    return s;
  }
  Tensor strain_of(std::size_t i) const {
    Tensor s;
    for (int k = 0; k < components; ++k) s[k] = strain[k][i];
    return s;
  }
  void set_stress(std::size_t i, const Tensor& s) {
    for (int k = 0; k < components; ++k) stress[k][i] = s[k];
  }
  double mean(std::size_t i) const { return (stress[0][i] + stress[1][i] + stress[2][i]) / 3; }
  /// The Mises stress, (3/2 s:s)^(1/2).
  double mises(std::size_t i) const {
    const Eigen::Matrix3d s = as_matrix<Dim>(stress_of(i)) - mean(i) * Eigen::Matrix3d::Identity();
    return std::sqrt(1.5) * s.norm();
  }

  std::array<std::vector<double>, components> strain, stress;
  std::vector<std::vector<double>> state;
  double dt = 1e-3, time = 0;

 private:
  std::vector<double*> pointers_;
};

/// Stresses about 15 kPa of compression and strain increments of which some make soft soil yield far.
template <int Dim>
PathPoints<Dim> random_points(const Material& material, std::size_t size, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0, 1);
  PathPoints<Dim> points(material, size);
  for (std::size_t i = 0; i < size; ++i) {
    const double strain_size = uniform(generator) < 0.5 ? 1e-4 : 3e-2;
    for (int k = 0; k < symmetric_components<Dim>; ++k) {
      points.stress[k][i] = 5e3 * normal(generator) - (k < 3 ? 15e3 : 0);
      points.strain[k][i] = Dim == 2 && k == 2 ? 0 : strain_size * normal(generator);
    }
  }
  return points;
}

/// A point's result depends neither on its neighbours nor on its place, bit for bit.
template <int Dim>
void expect_any_batch_gives_the_same_bits(const Material& material) {
  constexpr std::size_t size = 150, end = 140;
  const PathPoints<Dim> before = random_points<Dim>(material, size, 8);
  PathPoints<Dim> whole = before, alone = before;
  material.update(whole.batch(0, end));
  for (std::size_t i = 0; i < end; ++i) material.update(alone.batch(i, 1));
  for (std::size_t i = 0; i < size; ++i) {
    ASSERT_EQ(alone.stress_of(i), whole.stress_of(i)) << i;
    for (std::size_t s = 0; s < whole.state.size(); ++s) ASSERT_EQ(alone.state[s][i], whole.state[s][i]) << i;
    if (i >= end) {
      ASSERT_EQ(whole.stress_of(i), before.stress_of(i)) << "touched beyond the batch";
    }
  }
}

/// Plane strain is a case of 3-D: stress to `tolerance` [Pa], state to 1e-12 of itself or of 1.
inline void expect_plane_strain_equals_three_dimensions(const Material& material, double tolerance) {
  PathPoints<2> plane = random_points<2>(material, 500, 4);
  PathPoints<3> solid(material, 500);
  for (int k = 0; k < 4; ++k) {
    solid.stress[k] = plane.stress[k];
    solid.strain[k] = plane.strain[k];
  }
  for (int n = 0; n < 3; ++n) {
    plane.update(material);
    solid.update(material);
  }
  for (std::size_t i = 0; i < 500; ++i) {
    ASSERT_LT((as_matrix<2>(plane.stress_of(i)) - as_matrix<3>(solid.stress_of(i))).norm(), tolerance) << i;
    for (std::size_t s = 0; s < plane.state.size(); ++s)
      ASSERT_NEAR(plane.state[s][i], solid.state[s][i], 1e-12 * std::max(1.0, std::abs(plane.state[s][i])));
  }
}

/// The work that the plastic strain of each of `steps` random steps does at the stress that the step ends with, over
/// elasticity that does not change, is not negative: to 1e-12 of the work of the whole strain.
template <int Dim>
void expect_dissipation(const Material& material, int steps) {
  const IsotropicElasticity e = material.elasticity();
  const double bulk = e.lambda + 2 * e.shear / 3;
  PathPoints<Dim> points = random_points<Dim>(material, 1000, 5);
  points.update(material);  // stresses are admissible from here on
  std::mt19937 generator(6);
  std::normal_distribution<double> normal;
  double dissipated = 0;
  for (int n = 0; n < steps; ++n) {
    for (int k = 0; k < symmetric_components<Dim>; ++k)
      for (double& value : points.strain[k]) value = Dim == 2 && k == 2 ? 0 : 3e-3 * normal(generator);
    const PathPoints<Dim> before = points;
    points.update(material);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Eigen::Matrix3d s = as_matrix<Dim>(points.stress_of(i)), strain = as_matrix<Dim>(points.strain_of(i));
      const Eigen::Matrix3d change = s - as_matrix<Dim>(before.stress_of(i));
      const Eigen::Matrix3d one = Eigen::Matrix3d::Identity();
      const double mean = change.trace() / 3;
      const Eigen::Matrix3d elastic = (change - mean * one) / (2 * e.shear) + mean / (3 * bulk) * one;
      const double work = (s.array() * (strain - elastic).array()).sum();
      ASSERT_GE(work, -1e-12 * (s.norm() * strain.norm() + 1)) << i;
      dissipated += work;
    }
  }
  EXPECT_GT(dissipated, 0);
}

}  // namespace sluice
