/// Values: single entries of a case file, read from a node with all checks, and written back.
///
/// A reader adds what is wrong to the problems and then returns nothing, so that the reading goes on.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/case/node.h"
#include "core/case/problems.h"
#include "core/case/units.h"

namespace sluice {

/// The numbers that are allowed, in SI.
struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool with_low = true, with_high = true;  ///< whether the ends belong to it

  bool contains(double value) const;
  /// "above 0", "at least 0 deg and below 90 deg"; empty if everything is allowed.
  std::string text(const Unit& unit) const;
};

inline constexpr Range any_number{};
constexpr Range above(double low) { return {.low = low, .with_low = false}; }
constexpr Range at_least(double low) { return {.low = low}; }
constexpr Range below(double high) { return {.high = high, .with_high = false}; }
constexpr Range at_most(double high) { return {.high = high}; }
/// Between both, which do not belong to it.
constexpr Range within(double low, double high) { return {low, high, false, false}; }
/// Both belong to it.
constexpr Range from_to(double low, double high) { return {low, high, true, true}; }
/// `low` belongs to it, `high` does not.
constexpr Range from_below(double low, double high) { return {low, high, true, false}; }
/// `high` belongs to it, `low` does not.
constexpr Range above_to(double low, double high) { return {low, high, false, true}; }

/// How many components a list may have.
struct Components {
  std::vector<std::size_t> allowed;  ///< empty: any number of them
  std::string text() const;          ///< "2 or 3"
};

namespace value {

/// `name` is the key, for messages.
std::optional<double> quantity(const Node& node, const std::string& name, const Unit& unit, const Range& range,
                               Problems& problems);
/// A list of quantities. Its last item may be a unit alone, which then holds for all bare numbers: [250, 357, m].
std::optional<std::vector<double>> quantities(const Node& node, const std::string& name, const Unit& unit,
                                              const Range& range, const Components& components, Problems& problems);
std::optional<std::int64_t> integer(const Node& node, const std::string& name, const Range& range, Problems& problems);
std::optional<bool> boolean(const Node& node, const std::string& name, Problems& problems);
std::optional<std::string> text(const Node& node, const std::string& name, Problems& problems);
/// A word out of `allowed`.
std::optional<std::string> word(const Node& node, const std::string& name, const std::vector<std::string>& allowed,
                                Problems& problems);
/// A name that the catalogue with this plural (see registry.h) knows. A catalogue that the program has not, allows all.
std::optional<std::string> registered(const Node& node, const std::string& name, const std::string& catalogue,
                                      Problems& problems);
/// A list of words, or one word alone.
std::optional<std::vector<std::string>> words(const Node& node, const std::string& name, Problems& problems);

Node from_quantity(double value, const Unit& unit);
Node from_quantities(const std::vector<double>& values, const Unit& unit);
Node from_words(const std::vector<std::string>& words);

}  // namespace value
}  // namespace sluice
