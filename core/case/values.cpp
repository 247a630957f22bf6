#include "core/case/values.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "core/case/registry.h"

namespace sluice {

bool Range::contains(double value) const {
  return (with_low ? value >= low : value > low) && (with_high ? value <= high : value < high);
}

std::string Range::text(const Unit& unit) const {
  const auto number = [&](double value) {
    if (unit.dimension == unit::angle.dimension) return fmt::format("{:g} deg", value * 180 / std::numbers::pi);
    return value == 0 ? "0" : format_quantity(value, unit);
  };
  std::string text;
  if (std::isfinite(low)) text = (with_low ? "at least " : "above ") + number(low);
  if (std::isfinite(high)) text += (text.empty() ? "" : " and ") + ((with_high ? "at most " : "below ") + number(high));
  return text;
}

std::string Components::text() const { return fmt::format("{}", fmt::join(allowed, " or ")); }

namespace value {

namespace {

/// An entry that is no scalar, or has no value at all.
bool is_scalar(const Node& node, const std::string& name, const std::string& expected, Problems& problems) {
  if (node.kind == Node::Kind::scalar) return true;
  problems.add(node.place, node.kind == Node::Kind::absent
                               ? fmt::format("{} has no value; expected {}", name, expected)
                               : fmt::format("{}: found {}; expected {}", name, description(node), expected));
  return false;
}

std::string expectation(const Unit& unit) { return fmt::format("{}, for example {}", unit.name, unit.example); }

/// "[1, 2, m]": the unit that stands alone at the end, or "".
std::string common_unit(const Node& list) {
  if (list.items.size() < 2 || list.items.back().kind != Node::Kind::scalar) return "";
  try {
    parse_quantity(list.items.back().scalar);
  } catch (const UnitError&) {
    try {
      parse_unit(list.items.back().scalar);
      return list.items.back().scalar;
    } catch (const UnitError&) {
    }
  }
  return "";
}

bool has_unit(const std::string& text) {
  try {
    return parse_quantity(text).has_unit;
  } catch (const UnitError&) {
    return true;
  }
}

}  // namespace

std::optional<double> quantity(const Node& node, const std::string& name, const Unit& unit, const Range& range,
                               Problems& problems) {
  if (!is_scalar(node, name, expectation(unit), problems)) return std::nullopt;
  try {
    const double value = parse_quantity(node.scalar, unit);
    if (range.contains(value)) return value;
    problems.add(node.place, fmt::format("{} is {}; it must be {}", name, node.scalar, range.text(unit)));
  } catch (const UnitError& error) {
    problems.add(node.place, fmt::format("{}: {}", name, error.what()));
  }
  return std::nullopt;
}

std::optional<std::vector<double>> quantities(const Node& node, const std::string& name, const Unit& unit,
                                              const Range& range, const Components& components, Problems& problems) {
  const std::string size = components.allowed.empty() ? "a list" : "a list of " + components.text();
  if (node.kind != Node::Kind::list) {
    problems.add(node.place,
                 fmt::format("{}: found {}; expected {}, each {}", name, description(node), size, expectation(unit)));
    return std::nullopt;
  }
  const std::string common = common_unit(node);
  const std::size_t count = node.items.size() - (common.empty() ? 0 : 1);
  if (!components.allowed.empty() &&
      std::find(components.allowed.begin(), components.allowed.end(), count) == components.allowed.end()) {
    problems.add(node.place, fmt::format("{}: found {} components; expected {}", name, count, components.text()));
    return std::nullopt;
  }
  std::vector<double> values;
  for (std::size_t i = 0; i < count; ++i) {
    Node item = node.items[i];
    if (!common.empty() && item.kind == Node::Kind::scalar && !has_unit(item.scalar)) item.scalar += " " + common;
    if (const auto value = quantity(item, fmt::format("{}, component {}", name, i + 1), unit, range, problems))
      values.push_back(*value);
  }
  if (values.size() != count) return std::nullopt;
  return values;
}

std::optional<std::int64_t> integer(const Node& node, const std::string& name, const Range& range, Problems& problems) {
  if (!is_scalar(node, name, "a whole number", problems)) return std::nullopt;
  std::int64_t value = 0;
  const char* const end = node.scalar.data() + node.scalar.size();
  const auto [rest, error] = std::from_chars(node.scalar.data(), end, value);
  if (error != std::errc() || rest != end) {
    problems.add(node.place, fmt::format("{}: found '{}'; expected a whole number", name, node.scalar));
    return std::nullopt;
  }
  if (range.contains(static_cast<double>(value))) return value;
  problems.add(node.place, fmt::format("{} is {}; it must be {}", name, value, range.text(unit::none)));
  return std::nullopt;
}

std::optional<bool> boolean(const Node& node, const std::string& name, Problems& problems) {
  const auto found = word(node, name, {"true", "false"}, problems);
  return found ? std::optional(*found == "true") : std::nullopt;
}

std::optional<std::string> text(const Node& node, const std::string& name, Problems& problems) {
  if (!is_scalar(node, name, "text", problems)) return std::nullopt;
  if (!node.scalar.empty()) return node.scalar;
  problems.add(node.place, fmt::format("{} is empty; expected text", name));
  return std::nullopt;
}

std::optional<std::string> word(const Node& node, const std::string& name, const std::vector<std::string>& allowed,
                                Problems& problems) {
  if (!is_scalar(node, name, fmt::format("one of {}", fmt::join(allowed, ", ")), problems)) return std::nullopt;
  if (std::find(allowed.begin(), allowed.end(), node.scalar) != allowed.end()) return node.scalar;
  problems.add(node.place, fmt::format("{}: found '{}'; {}", name, node.scalar, allowed_words(node.scalar, allowed)));
  return std::nullopt;
}

std::optional<std::string> registered(const Node& node, const std::string& name, const std::string& catalogue,
                                      Problems& problems) {
  const auto found = text(node, name, problems);
  const auto entry = Catalogue::all().find(catalogue);
  if (!found || entry == Catalogue::all().end()) return found;
  try {
    entry->second->require(*found, node.place);
    return found;
  } catch (const CaseError& error) {
    problems.add(node.place, error);
  }
  return std::nullopt;
}

std::optional<std::vector<std::string>> words(const Node& node, const std::string& name, Problems& problems) {
  std::vector<std::string> words;
  if (node.kind == Node::Kind::scalar && !node.scalar.empty()) return std::vector{node.scalar};
  if (node.kind != Node::Kind::list) {
    problems.add(node.place, fmt::format("{}: found {}; expected a word or a list of words", name, description(node)));
    return std::nullopt;
  }
  for (const Node& item : node.items)
    if (const auto word = text(item, name, problems)) words.push_back(*word);
  if (words.size() != node.items.size()) return std::nullopt;
  return words;
}

Node from_quantity(double value, const Unit& unit) { return Node::text(format_quantity(value, unit)); }

Node from_quantities(const std::vector<double>& values, const Unit& unit) {
  Node list = Node::list();
  for (const double value : values) list.items.push_back(from_quantity(value, unit));
  return list;
}

Node from_words(const std::vector<std::string>& words) {
  Node list = Node::list();
  for (const std::string& word : words) list.items.push_back(Node::text(word));
  return list;
}

}  // namespace value
}  // namespace sluice
