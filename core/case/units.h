/// Units: quantities as people write them ("2 MPa", "35 deg", "9.81 m/s2") and their dimensions.
#pragma once

#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

namespace sluice {

/// Powers of length, mass, time and angle. The angle is kept apart, though it is none in SI: degrees taken for radians
/// are the classic mistake.
struct Dimension {
  int length = 0, mass = 0, time = 0, angle = 0;
  friend bool operator==(const Dimension&, const Dimension&) = default;
};

/// What a key expects: a dimension, its name with article, its SI unit, and an example for messages.
struct Unit {
  Dimension dimension;
  const char* name;
  const char* si;
  const char* example;
};

namespace unit {
inline constexpr Unit none{{0, 0, 0, 0}, "a plain number", "", "0.3"};
inline constexpr Unit length{{1, 0, 0, 0}, "a length", "m", "0.5 m"};
inline constexpr Unit area{{2, 0, 0, 0}, "an area", "m2", "2 m2"};
inline constexpr Unit volume{{3, 0, 0, 0}, "a volume", "m3", "2 m3"};
inline constexpr Unit mass{{0, 1, 0, 0}, "a mass", "kg", "5 kg"};
inline constexpr Unit time{{0, 0, 1, 0}, "a time", "s", "1 ms"};
inline constexpr Unit angle{{0, 0, 0, 1}, "an angle", "rad", "35 deg"};
inline constexpr Unit velocity{{1, 0, -1, 0}, "a velocity", "m/s", "1e-5 m/s"};
inline constexpr Unit acceleration{{1, 0, -2, 0}, "an acceleration", "m/s2", "9.81 m/s2"};
inline constexpr Unit density{{-3, 1, 0, 0}, "a density", "kg/m3", "1800 kg/m3"};
inline constexpr Unit unit_weight{{-2, 1, -2, 0}, "a unit weight", "N/m3", "16 kN/m3"};
inline constexpr Unit force{{1, 1, -2, 0}, "a force", "N", "5 kN"};
inline constexpr Unit stress{{-1, 1, -2, 0}, "a stress", "Pa", "2 MPa"};
inline constexpr Unit compressibility{{1, -1, 2, 0}, "a compressibility", "1/Pa", "4.5e-10 1/Pa"};
inline constexpr Unit energy{{2, 1, -2, 0}, "an energy", "J", "3 kJ"};
inline constexpr Unit power{{2, 1, -3, 0}, "a power", "W", "3 kW"};
inline constexpr Unit rate{{0, 0, -1, 0}, "a rate", "1/s", "2 Hz"};
inline constexpr Unit angular_velocity{{0, 0, -1, 1}, "an angular velocity", "rad/s", "2 rad/s"};
inline constexpr Unit viscosity{{-1, 1, -1, 0}, "a dynamic viscosity", "Pa s", "1e-3 Pa s"};
}  // namespace unit

inline constexpr double right_angle = std::numbers::pi / 2;

/// A quantity as written. `has_unit` tells "2" from "2 %".
struct Quantity {
  double value = 0;  ///< in SI
  Dimension dimension;
  bool has_unit = false;
};

/// What is wrong with a quantity, without the place.
class UnitError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Units are m s min h day g t N Pa J W Hz deg rad % 1, with prefixes n u m c d k M G where customary; products with a
/// blank, `*` or `·`, quotients with `/` (which concerns the next unit only), powers as in m2, m^2 or s-1.
/// Throws UnitError if there is no finite number or the unit is unknown.
Quantity parse_quantity(const std::string& text);
/// The dimension and size of a unit alone. Throws UnitError.
Quantity parse_unit(const std::string& text);

/// The value in SI of a quantity that must have this dimension; bare numbers are SI, but an angle other than 0 needs
/// its unit. Throws UnitError.
double parse_quantity(const std::string& text, const Unit& expected);

/// "a stress" where the dimension has a name, otherwise its unit in SI base units, "kg/m5".
std::string name_of(const Dimension& dimension);

/// The value with its SI unit in the fewest digits that read back as the same number: "-250 m".
std::string format_quantity(double value, const Unit& unit);

}  // namespace sluice
