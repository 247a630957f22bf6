#include "physics/element/comparison.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <span>

namespace sluice::element {

namespace {

/// Largest values and differences of a quantity.
struct Extremes {
  double value = 0, difference = 0;

  void add(std::span<const double> found, std::span<const double> expected) {
    for (std::size_t k = 0; k < found.size(); ++k) {
      value = std::max(value, std::abs(expected[k]));
      difference = std::max(difference, std::abs(found[k] - expected[k]));
    }
  }
  double ratio() const { return value > 1e-8 ? difference / value : difference; }
};

}  // namespace

Difference difference(const std::vector<Row>& found, const std::vector<Row>& expected) {
  assert(found.size() == expected.size());
  Extremes stress, strain;
  std::vector<Extremes> state(found.front().point.state.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    const PointState &a = found[i].point, &b = expected[i].point;
    stress.add(a.stress, b.stress);
    stress.add({&a.pore_pressure, 1}, {&b.pore_pressure, 1});
    strain.add(a.strain, b.strain);
    for (std::size_t k = 0; k < state.size(); ++k) state[k].add({&a.state[k], 1}, {&b.state[k], 1});
  }
  Difference result{.stress = stress.ratio(), .strain = strain.ratio(), .largest_stress = stress.value};
  for (const Extremes& column : state) result.state = std::max(result.state, column.ratio());
  return result;
}

}  // namespace sluice::element
