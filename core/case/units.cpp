#include "core/case/units.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>

#include "core/case/node.h"

namespace sluice {

namespace {

/// One unit in SI, as a quotient: 0.1 / 1000 is the number nearest to 1e-4, 0.1 * 0.001 is not.
struct Size {
  double multiply = 1, divide = 1;
  Dimension dimension;
};

struct Symbol {
  std::string_view text;
  Size size;
  std::string_view prefixes;
};

constexpr std::array symbols = {
    Symbol{"m", {1, 1, {1, 0, 0, 0}}, "numcdk"},  Symbol{"s", {1, 1, {0, 0, 1, 0}}, "num"},
    Symbol{"min", {60, 1, {0, 0, 1, 0}}, ""},     Symbol{"h", {3600, 1, {0, 0, 1, 0}}, ""},
    Symbol{"day", {86400, 1, {0, 0, 1, 0}}, ""},  Symbol{"g", {1, 1000, {0, 1, 0, 0}}, "mkM"},
    Symbol{"t", {1000, 1, {0, 1, 0, 0}}, "kM"},   Symbol{"N", {1, 1, {1, 1, -2, 0}}, "mkMG"},
    Symbol{"Pa", {1, 1, {-1, 1, -2, 0}}, "mkMG"}, Symbol{"J", {1, 1, {2, 1, -2, 0}}, "mkMG"},
    Symbol{"W", {1, 1, {2, 1, -3, 0}}, "mkMG"},   Symbol{"Hz", {1, 1, {0, 0, -1, 0}}, "kMG"},
    Symbol{"rad", {1, 1, {0, 0, 0, 1}}, "m"},     Symbol{"deg", {std::numbers::pi, 180, {0, 0, 0, 1}}, ""},
    Symbol{"%", {1, 100, {0, 0, 0, 0}}, ""},      Symbol{"1", {1, 1, {0, 0, 0, 0}}, ""},
};

constexpr std::array named_units = {
    unit::none,         unit::length,
    unit::area,         unit::volume,
    unit::mass,         unit::time,
    unit::angle,        unit::velocity,
    unit::acceleration, unit::density,
    unit::unit_weight,  unit::force,
    unit::stress,       unit::compressibility,
    unit::energy,       unit::power,
    unit::rate,         unit::angular_velocity,
    unit::viscosity,
};

Size prefix_size(char prefix) {
  switch (prefix) {
    case 'n':
      return {1, 1e9, {}};
    case 'u':
      return {1, 1e6, {}};
    case 'm':
      return {1, 1e3, {}};
    case 'c':
      return {1, 1e2, {}};
    case 'd':
      return {1, 1e1, {}};
    case 'k':
      return {1e3, 1, {}};
    case 'M':
      return {1e6, 1, {}};
    default:
      return {1e9, 1, {}};
  }
}

std::optional<Size> find_symbol(std::string_view text) {
  for (const Symbol& symbol : symbols)
    if (symbol.text == text) return symbol.size;
  if (text.size() < 2) return std::nullopt;
  for (const Symbol& symbol : symbols) {
    if (symbol.text != text.substr(1) || symbol.prefixes.find(text[0]) == std::string_view::npos) continue;
    const Size prefix = prefix_size(text[0]);
    Size size{symbol.size.multiply * prefix.multiply, symbol.size.divide * prefix.divide, symbol.size.dimension};
    if (size.multiply == 1000 && size.divide == 1000) size.multiply = size.divide = 1;  // kg
    return size;
  }
  return std::nullopt;
}

void multiply_by(Size& product, const Size& factor, int power) {
  for (int i = 0; i < std::abs(power); ++i) {
    product.multiply *= power > 0 ? factor.multiply : factor.divide;
    product.divide *= power > 0 ? factor.divide : factor.multiply;
  }
  product.dimension.length += power * factor.dimension.length;
  product.dimension.mass += power * factor.dimension.mass;
  product.dimension.time += power * factor.dimension.time;
  product.dimension.angle += power * factor.dimension.angle;
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

[[noreturn]] void throw_unknown_unit(std::string_view symbol) {
  static const std::vector<std::string> customary = {"m",   "km", "cm", "mm", "s",  "ms", "min", "h",   "day",
                                                     "kg",  "t",  "g",  "N",  "kN", "MN", "Pa",  "kPa", "MPa",
                                                     "GPa", "J",  "kJ", "W",  "kW", "Hz", "deg", "rad", "%"};
  const std::string near = nearest_word(std::string(symbol), customary);
  throw UnitError(fmt::format("unknown unit '{}'{}", symbol, near.empty() ? "" : "; did you mean '" + near + "'?"));
}

/// Takes "^-2", "-2" or "2" from the front; 1 if there is no power.
int take_power(std::string_view& text) {
  std::string_view rest = text;
  const bool caret = !rest.empty() && rest.front() == '^';
  if (caret) rest.remove_prefix(1);
  int power = 1;
  const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), power);
  if (error != std::errc() || std::abs(power) > 9 || power == 0) {
    if (caret || error == std::errc()) throw UnitError(fmt::format("'{}' is no power of a unit", text));
    return 1;
  }
  text = rest.substr(static_cast<std::size_t>(end - rest.data()));
  return power;
}

/// Takes a symbol from the front: letters, `%`, or the digit 1.
std::string_view take_symbol(std::string_view& text) {
  std::size_t n = 0;
  if (!text.empty() && (text.front() == '1' || text.front() == '%')) {
    n = 1;
  } else {
    while (n < text.size() && std::string_view("*/^ -+0123456789").find(text[n]) == std::string_view::npos) ++n;
  }
  const std::string_view symbol = text.substr(0, n);
  text.remove_prefix(n);
  return symbol;
}

std::string with_ascii_signs(std::string text) {
  const auto replace = [&text](std::string_view sign, std::string_view ascii) {
    for (std::size_t at = text.find(sign); at != std::string::npos; at = text.find(sign, at))
      text.replace(at, sign.size(), ascii);
  };
  replace("·", "*");
  replace("µ", "u");  // U+00B5, the micro sign
  replace("μ", "u");  // U+03BC, the Greek letter
  replace("°", "deg");
  replace("²", "2");
  replace("³", "3");
  return text;
}

Size read_unit(std::string_view text) {
  Size product;
  const std::string_view whole = text;
  int sign = 1;
  if (!text.empty() && text.front() == '/') {
    sign = -1;
    text = trimmed(text.substr(1));
  }
  for (;;) {
    const std::string_view symbol = take_symbol(text);
    if (symbol.empty()) throw UnitError(fmt::format("'{}' is no unit", whole));
    const auto size = find_symbol(symbol);
    if (!size) throw_unknown_unit(symbol);
    multiply_by(product, *size, sign * take_power(text));
    text = trimmed(text);
    if (text.empty()) return product;
    sign = text.front() == '/' ? -1 : 1;
    if (text.front() == '/' || text.front() == '*') text = trimmed(text.substr(1));
  }
}

}  // namespace

Quantity parse_unit(const std::string& text) {
  const std::string ascii = with_ascii_signs(text);
  const Size size = read_unit(trimmed(ascii));
  return {size.multiply / size.divide, size.dimension, true};
}

Quantity parse_quantity(const std::string& text) {
  const std::string ascii = with_ascii_signs(text);
  std::string_view rest = trimmed(ascii);
  if (rest.size() > 1 && rest[0] == '+' && rest[1] != '-') rest.remove_prefix(1);
  double number = 0;
  const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), number);
  if (error == std::errc::result_out_of_range) throw UnitError(fmt::format("'{}' is too large or too small", text));
  if (error != std::errc()) throw UnitError(fmt::format("'{}' is not a number", text));
  rest = trimmed(rest.substr(static_cast<std::size_t>(end - rest.data())));
  if (!std::isfinite(number)) throw UnitError(fmt::format("'{}' is not a finite number", text));
  if (rest.empty()) return {number, {}, false};
  if (rest.front() == ',') throw UnitError(fmt::format("'{}' has a comma; decimals are written with a point", text));
  const Size size = read_unit(rest);
  const double value = number * size.multiply / size.divide;
  if (!std::isfinite(value)) throw UnitError(fmt::format("'{}' is too large", text));
  return {value, size.dimension, true};
}

double parse_quantity(const std::string& text, const Unit& expected) {
  const auto wanted = [&] { return fmt::format("expected {}, for example {}", expected.name, expected.example); };
  Quantity quantity;
  try {
    quantity = parse_quantity(text);
  } catch (const UnitError& error) {
    const std::string what = error.what();
    if (what.back() == '?')
      throw UnitError(fmt::format("{} Expected {}, for example {}", what, expected.name, expected.example));
    throw UnitError(fmt::format("{}; {}", what, wanted()));
  }
  if (!quantity.has_unit) {
    if (expected.dimension == unit::angle.dimension && quantity.value != 0)
      throw UnitError(
          fmt::format("'{}' has no unit; an angle needs deg or rad, for example {}", text, expected.example));
    return quantity.value;
  }
  if (quantity.dimension != expected.dimension)
    throw UnitError(fmt::format("found '{}', {}; {}", text, name_of(quantity.dimension), wanted()));
  return quantity.value;
}

std::string name_of(const Dimension& dimension) {
  for (const Unit& named : named_units)
    if (named.dimension == dimension) return named.name;
  std::string above, below;
  const auto factor = [&](const char* symbol, int power) {
    if (power == 0) return;
    std::string& side = power > 0 ? above : below;
    const std::string exponent = std::abs(power) == 1 ? "" : std::to_string(std::abs(power));
    side += (power > 0 ? (side.empty() ? "" : " ") : "/") + (symbol + exponent);
  };
  factor("kg", dimension.mass);
  factor("m", dimension.length);
  factor("s", dimension.time);
  factor("rad", dimension.angle);
  return (above.empty() ? "1" : above) + below;
}

std::string format_quantity(double value, const Unit& unit) {
  return *unit.si == '\0' ? fmt::format("{}", value) : fmt::format("{} {}", value, unit.si);
}

}  // namespace sluice
