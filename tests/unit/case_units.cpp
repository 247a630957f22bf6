/// Units parser: values, dimensions and messages.
#include <gtest/gtest.h>

#include <numbers>

#include "core/case/units.h"

namespace sluice {
namespace {

std::string message_of(const std::string& text, const Unit& expected) {
  try {
    parse_quantity(text, expected);
  } catch (const UnitError& error) {
    return error.what();
  }
  return "";
}

TEST(Units, QuantitiesInSi) {
  // The values are the literals of the same decimal number, to the last bit.
  EXPECT_EQ(parse_quantity("2 MPa", unit::stress), 2e6);
  EXPECT_EQ(parse_quantity("2MPa", unit::stress), 2e6);
  EXPECT_EQ(parse_quantity("1e-5 m/s", unit::velocity), 1e-5);
  EXPECT_EQ(parse_quantity("9.81 m/s2", unit::acceleration), 9.81);
  EXPECT_EQ(parse_quantity("-9.81 m/s^2", unit::acceleration), -9.81);
  EXPECT_EQ(parse_quantity("9.81 m s-2", unit::acceleration), 9.81);
  EXPECT_EQ(parse_quantity("9.81 m/s/s", unit::acceleration), 9.81);
  EXPECT_EQ(parse_quantity("1800 kg/m3", unit::density), 1800);
  EXPECT_EQ(parse_quantity("1.8 t/m3", unit::density), 1800);
  EXPECT_EQ(parse_quantity("1.8 g/cm3", unit::density), 1800);
  EXPECT_EQ(parse_quantity("16 kN/m3", unit::unit_weight), 16000);
  EXPECT_EQ(parse_quantity("30 kN/m2", unit::stress), 30000);
  EXPECT_EQ(parse_quantity("1 ms", unit::time), 0.001);
  EXPECT_EQ(parse_quantity("0.1 ms", unit::time), 1e-4);
  EXPECT_EQ(parse_quantity("2 min", unit::time), 120);
  EXPECT_EQ(parse_quantity("1 day", unit::time), 86400);
  EXPECT_EQ(parse_quantity("-250 m", unit::length), -250);
  EXPECT_EQ(parse_quantity("+2.5e2 cm", unit::length), 2.5);
  EXPECT_EQ(parse_quantity("5 %", unit::none), 0.05);
  EXPECT_EQ(parse_quantity("0.3", unit::none), 0.3);
  EXPECT_EQ(parse_quantity("2 Hz", unit::rate), 2);
  EXPECT_EQ(parse_quantity("2 1/s", unit::rate), 2);
  EXPECT_EQ(parse_quantity("1e-3 Pa s", unit::viscosity), 1e-3);
  EXPECT_EQ(parse_quantity("1e-3 Pa*s", unit::viscosity), 1e-3);
  EXPECT_EQ(parse_quantity("3 µm", unit::length), 3e-6);
  EXPECT_DOUBLE_EQ(parse_quantity("35 deg", unit::angle), 35 * std::numbers::pi / 180);
  EXPECT_EQ(parse_quantity("0.6 rad", unit::angle), 0.6);
}

TEST(Units, BareNumbersAreSiButAnglesNeedTheirUnit) {
  EXPECT_EQ(parse_quantity("2e6", unit::stress), 2e6);
  EXPECT_EQ(parse_quantity("0", unit::angle), 0);
  EXPECT_EQ(message_of("35", unit::angle), "'35' has no unit; an angle needs deg or rad, for example 35 deg");
}

TEST(Units, Messages) {
  EXPECT_EQ(message_of("2 m", unit::stress), "found '2 m', a length; expected a stress, for example 2 MPa");
  EXPECT_EQ(message_of("2 kg/m5", unit::stress), "found '2 kg/m5', kg/m5; expected a stress, for example 2 MPa");
  EXPECT_EQ(message_of("0.3 m", unit::none), "found '0.3 m', a length; expected a plain number, for example 0.3");
  EXPECT_EQ(message_of("2 Mpa", unit::stress),
            "unknown unit 'Mpa'; did you mean 'MPa'? Expected a stress, for example 2 MPa");
  EXPECT_EQ(message_of("soft", unit::stress), "'soft' is not a number; expected a stress, for example 2 MPa");
  EXPECT_EQ(message_of("", unit::stress), "'' is not a number; expected a stress, for example 2 MPa");
  EXPECT_EQ(message_of("2,5 MPa", unit::stress),
            "'2,5 MPa' has a comma; decimals are written with a point; expected a stress, for example 2 MPa");
  EXPECT_EQ(message_of("nan", unit::none), "'nan' is not a finite number; expected a plain number, for example 0.3");
  EXPECT_EQ(message_of("inf Pa", unit::stress),
            "'inf Pa' is not a finite number; expected a stress, for example 2 MPa");
  EXPECT_NE(message_of("1e999 Pa", unit::stress), "");
  EXPECT_NE(message_of("1e305 GPa", unit::stress), "");
  for (const char* const text : {"2 m/", "2 /", "2 m^", "2 m0", "2 m//s", "2 m3.5", "--2 m", "2 m^99", "+-2 m", "2 *m"})
    EXPECT_NE(message_of(text, unit::length), "") << text;
}

TEST(Units, WrittenValuesReadBackAsTheSameNumber) {
  for (const double value : {0.1, 1.0 / 3, -250.0, 6.02e23, 1e-300, 0.0}) {
    EXPECT_EQ(parse_quantity(format_quantity(value, unit::stress), unit::stress), value);
    EXPECT_EQ(parse_quantity(format_quantity(value, unit::angle), unit::angle), value);
    EXPECT_EQ(parse_quantity(format_quantity(value, unit::none), unit::none), value);
    EXPECT_EQ(parse_quantity(format_quantity(value, unit::compressibility), unit::compressibility), value);
  }
}

TEST(Units, ExamplesHaveTheDimensionThatTheyExplain) {
  for (const Unit& unit :
       {unit::none, unit::length, unit::area, unit::volume, unit::mass, unit::time, unit::angle, unit::velocity,
        unit::acceleration, unit::density, unit::unit_weight, unit::force, unit::stress, unit::compressibility,
        unit::energy, unit::power, unit::rate, unit::angular_velocity, unit::viscosity})
    EXPECT_EQ(message_of(unit.example, unit), "");
}

}  // namespace
}  // namespace sluice
