#include "core/case/table.h"

#include <fmt/format.h>

#include <algorithm>

namespace sluice {

double Table::at(double t) const {
  const auto after = std::upper_bound(time.begin(), time.end(), t) - time.begin();
  if (after == 0) return value.front();
  const auto i = static_cast<std::size_t>(after);
  if (i == time.size()) return value.back();
  const double share = (t - time[i - 1]) / (time[i] - time[i - 1]);
  return value[i - 1] + share * (value[i] - value[i - 1]);
}

double Table::integral(double t) const {
  // Over [0, t], or minus that over [t, 0]: pieces between the ends and the points that lie between them.
  const double from = std::min(0.0, t), to = std::max(0.0, t);
  double sum = 0, before = from;
  for (const double point : time) {
    if (point <= before || point >= to) continue;
    sum += 0.5 * (at(before) + at(point)) * (point - before);
    before = point;
  }
  sum += 0.5 * (at(before) + at(to)) * (to - before);
  return t < 0 ? -sum : sum;
}

namespace value {

std::optional<Table> table(const Node& node, const std::string& name, const Unit& unit, const Range& range,
                           Problems& problems) {
  if (node.kind != Node::Kind::list) {
    const auto constant = quantity(node, name, unit, range, problems);
    return constant ? std::optional(Table::constant(*constant)) : std::nullopt;
  }
  Table table;
  for (const Node& point : node.items) {
    if (point.kind != Node::Kind::list || point.items.size() != 2) {
      problems.add(point.place, fmt::format("{}: found {}; expected a point [time, value]", name, description(point)));
      return std::nullopt;
    }
    const auto t = quantity(point.items[0], name + ", time", unit::time, any_number, problems);
    const auto v = quantity(point.items[1], name, unit, range, problems);
    if (!t || !v) return std::nullopt;
    if (!table.time.empty() && *t <= table.time.back()) {
      problems.add(point.place, fmt::format("{}: the time {:g} s must be after the one before it, {:g} s", name, *t,
                                            table.time.back()));
      return std::nullopt;
    }
    table.time.push_back(*t);
    table.value.push_back(*v);
  }
  if (!table.time.empty()) return table;
  problems.add(node.place, name + ": found an empty list; expected a value or points [[time, value], …]");
  return std::nullopt;
}

Node from_table(const Table& table, const Unit& unit) {
  if (table.time.size() == 1) return from_quantity(table.value[0], unit);
  Node points = Node::list();
  for (std::size_t i = 0; i < table.time.size(); ++i)
    points.items.push_back(Node::list({from_quantity(table.time[i], unit::time), from_quantity(table.value[i], unit)}));
  return points;
}

}  // namespace value

}  // namespace sluice
