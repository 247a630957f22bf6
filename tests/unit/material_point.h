/// A batch of material points in memory of its own, for tests of constitutive models.
#pragma once

#include <array>
#include <cstddef>
#include <random>
#include <vector>

#include "physics/materials/material.h"

namespace sluice {

template <int Dim>
struct MaterialPoints {
  static constexpr int components = symmetric_components<Dim>;
  using Tensor = std::array<double, components>;

  explicit MaterialPoints(std::size_t size) : state(size, 0.0) {
    for (std::vector<double>& column : strain_increment) column.assign(size, 0.0);
    for (std::vector<double>& column : stress) column.assign(size, 0.0);
  }

  /// Stresses about a mean in compression, and strain increments that make some points of soft soil yield.
  static MaterialPoints random(std::size_t size, unsigned seed) {
    std::mt19937 generator(seed);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> uniform(0, 1);
    MaterialPoints points(size);
    for (std::size_t i = 0; i < size; ++i) {
      const double strain_size = uniform(generator) < 0.5 ? 1e-4 : 3e-2;
      for (int k = 0; k < components; ++k) {
        points.stress[k][i] = 5e3 * normal(generator) - (k < 3 ? 15e3 : 0);
        points.strain_increment[k][i] = Dim == 2 && k == 2 ? 0 : strain_size * normal(generator);
      }
    }
    return points;
  }

  std::size_t size() const { return state.size(); }

  /// The points [first, first + count) as a batch; the returned object must outlive its use.
  MaterialBatch<Dim> batch(std::size_t first, std::size_t count) {
    MaterialBatch<Dim> b;
    b.size = count;
    for (int k = 0; k < components; ++k) {
      b.strain_increment[k] = strain_increment[k].data() + first;
      b.stress[k] = stress[k].data() + first;
    }
    state_pointer = state.data() + first;
    b.state = {&state_pointer, 1};
    return b;
  }
  MaterialBatch<Dim> batch() { return batch(0, size()); }

  Tensor stress_of(std::size_t i) const {
    Tensor s;
    for (int k = 0; k < components; ++k) s[k] = stress[k][i];
    return s;
  }

  std::array<std::vector<double>, components> strain_increment, stress;
  std::vector<double> state;  ///< the equivalent plastic strain
  double* state_pointer = nullptr;
};

}  // namespace sluice
