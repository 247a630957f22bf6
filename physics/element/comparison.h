/// Comparison of two solutions of the same path.
#pragma once

#include "physics/element/driver.h"

namespace sluice::element {

/// Largest differences over all rows, each over the largest value on the path; as it is where that is round-off, below
/// 1e-8.
struct Difference {
  double stress = 0, strain = 0, state = 0;
  double largest_stress = 0;  ///< [Pa]
};

/// The rows must be those of the same path. State is compared column by column.
Difference difference(const std::vector<Row>& found, const std::vector<Row>& expected);

}  // namespace sluice::element
