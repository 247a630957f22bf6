/// Table: a quantity that changes in time, as straight lines between given points; constant before the first and after
/// the last.
#pragma once

#include <string>
#include <vector>

#include "core/case/values.h"

namespace sluice {

struct Table {
  std::vector<double> time;   ///< [s], ascending; a single one for a constant
  std::vector<double> value;  ///< SI, as many as times

  static Table constant(double value) { return {{0}, {value}}; }
  double at(double t) const;
  /// From time 0 to t.
  double integral(double t) const;
};

namespace value {

/// One quantity, or a list of points [[time, value], …] with ascending times.
std::optional<Table> table(const Node& node, const std::string& name, const Unit& unit, const Range& range,
                           Problems& problems);
Node from_table(const Table& table, const Unit& unit);

}  // namespace value

}  // namespace sluice
