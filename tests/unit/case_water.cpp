/// Cases with water: what is read, and every message with its place.
#include <gtest/gtest.h>

#include "core/simulation/simulation.h"
#include "physics/two_phase/water.h"

namespace sluice {
namespace {

/// Line 7 is the material, line 8 its water, line 10 the body, line 11 the water, line 12 what a test adds.
const std::string column =
    "schema: 1\n"
    "physics: two_phase\n"
    "end_time: 2 s\n"
    "grid: {min: [0 m, 0 m], max: [2 m, 5 m], cell: 0.5 m}\n"
    "gravity: [0, -9.81 m/s2]\n"
    "materials:\n"
    "  soil: {model: linear_elastic, density: 1600 kg/m3, youngs_modulus: 1 MPa,\n"
    "         water: {porosity: 0.4, permeability: 1e-4 m/s}}\n"
    "bodies:\n"
    "  - {material: soil, box: {min: [0 m, 0 m], max: [2 m, 3 m]}}\n"
    "water: {density: 1000 kg/m3}\n";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

std::string message_of(const std::string& text) {
  try {
    Simulation::create(parse_case(text, "c.yaml"));
  } catch (const CaseError& error) {
    return error.what();
  }
  return "";
}

std::string with(const std::string& from, const std::string& to) { return message_of(replaced(column, from, to)); }
std::string with_water(const std::string& keys) { return with("{density: 1000 kg/m3}", "{" + keys + "}"); }
std::string with_more(const std::string& lines) { return message_of(column + lines); }

TEST(CaseWater, IsAccepted) { EXPECT_EQ(message_of(column), ""); }

TEST(CaseWater, PeriodicFacesArePeriodicForTheWater) {
  const std::string wide = replaced(column, "max: [2 m, 5 m]", "max: [4 m, 4 m]");
  const std::string sides = "boundaries: {left: periodic, right: periodic}\n";
  EXPECT_EQ(message_of(wide + sides), "");
  EXPECT_EQ(message_of(replaced(wide, "{density: 1000 kg/m3}", "{faces: {left: drained}}") + sides),
            "c.yaml:11:17: water.faces.left: the face is periodic in `boundaries`, for the water too; leave out "
            "water.faces.left");
  EXPECT_EQ(
      message_of(wide + "boundaries: {bottom: periodic, top: periodic}\n"),
      "c.yaml:12:37: boundaries.top: periodic: the physics two_phase does not know it, for water needs a top and a "
      "bottom; take `physics: total_stress`, or make other faces periodic");
}

TEST(CaseWater, ReadsFacesLevelsAndTables) {
  const WaterCase water = read_water(parse_case(
      replaced(column, "{density: 1000 kg/m3}",
               "{bulk_modulus: 2 GPa, saturation: 0.99, table: [[0, 2 m], [2 m, 3 m]],\n"
               "        faces: {top: drained, bottom: impermeable, left: {head: 2 m}, right: {flux: [[0, 0], [1 s, "
               "2 m/s]]}}}"),
      "c.yaml"));
  EXPECT_EQ(water.faces.at("top").pressure->at(1), 0);
  EXPECT_FALSE(water.faces.at("bottom").pressure || water.faces.at("bottom").head || water.faces.at("bottom").flux);
  EXPECT_EQ(water.faces.at("left").head->at(9), 2);
  EXPECT_EQ(water.faces.at("right").flux->at(0.5), 1);
  EXPECT_NEAR(water.compressibility(), 0.99 / 2e9 + 0.01 / 101325, 1e-20);
  EXPECT_DOUBLE_EQ(water.table_level(-1), 2);
  EXPECT_DOUBLE_EQ(water.table_level(0.5), 2.25);
  EXPECT_DOUBLE_EQ(water.table_level(2), 3);
  EXPECT_DOUBLE_EQ(water.table_level(7), 3);
  EXPECT_TRUE(water.below_table(1, 2.5));
  EXPECT_FALSE(water.below_table(1, 2.6));
}

TEST(CaseWater, NamesUnknownFaces) {
  EXPECT_EQ(with_water("faces: {topp: drained}"),
            "c.yaml:11:17: unknown face 'topp' in water.faces; allowed: left, right, bottom, top; did you mean 'top'?");
  EXPECT_NE(with_water("faces: {front: drained}").find("unknown face 'front'"), std::string::npos);
  EXPECT_NE(with_water("faces: {top: draned}").find("c.yaml:11:22"), std::string::npos);
  EXPECT_NE(with_water("faces: drained").find("expected faces by name"), std::string::npos);
}

TEST(CaseWater, WantsOneThingOfAFace) {
  const std::string one = "water.faces.top: give one of pressure, head, flux, or one of the words impermeable, drained";
  EXPECT_EQ(with_water("faces: {top: {pressure: 1 kPa, head: 2 m}}"), "c.yaml:11:22: " + one);
  EXPECT_EQ(with_water("faces: {top: {}}"), "c.yaml:11:22: " + one);
  EXPECT_EQ(with_water("faces: {top: {flux: 0 m/s}}"), "");
}

TEST(CaseWater, WantsPoresThatCanBe) {
  EXPECT_EQ(with("1e-4 m/s", "-1e-4 m/s"), "c.yaml:8:47: permeability is -1e-4 m/s; it must be above 0");
  EXPECT_EQ(with("1e-4 m/s", "[1e-4, 0 m/s]").substr(0, 13), "c.yaml:8:54: ");
  EXPECT_NE(with("1e-4 m/s", "[1e-4, 1e-4, 1e-4 m/s]").find("found 3 components; the grid has 2"), std::string::npos);
  EXPECT_EQ(with("1e-4 m/s", "[1e-4, 1e-5 m/s]"), "");
  EXPECT_EQ(with("porosity: 0.4", "porosity: 1.4").substr(0, 13), "c.yaml:8:28: ");
  EXPECT_EQ(with("porosity: 0.4", "porosity: 0").substr(0, 13), "c.yaml:8:28: ");
  EXPECT_NE(with(", permeability: 1e-4 m/s", "")
                .find("c.yaml:8:17: water of a material: the key 'permeability' is "
                      "missing"),
            std::string::npos)
      << with(", permeability: 1e-4 m/s", "");
  EXPECT_NE(with("model: linear_elastic, density: 1600 kg/m3, youngs_modulus: 1 MPa,", "model: water,")
                .find("material 'soil': water has no pores"),
            std::string::npos);
}

TEST(CaseWater, WantsABulkModulusWhereItIsNeeded) {
  EXPECT_EQ(with_water("saturation: 0.98"),
            "c.yaml:11:21: water.saturation below 1 needs a bulk_modulus, for example 2.2 GPa");
  EXPECT_EQ(with_water("formulation: explicit"),
            "c.yaml:11:22: water: `formulation: explicit` needs a bulk_modulus, for example 2.2 GPa");
  EXPECT_EQ(with_water("formulation: explicit, bulk_modulus: 2.2 GPa"), "");
  EXPECT_NE(with_water("saturation: 0, bulk_modulus: 2.2 GPa").find("c.yaml:11:21: saturation is 0"),
            std::string::npos);
}

TEST(CaseWater, WantsOnePermeabilityWhereTheWaterHasItsOwnInertia) {
  EXPECT_EQ(message_of(replaced(replaced(column, "1e-4 m/s", "[1e-4, 1e-5 m/s]"), "{density: 1000 kg/m3}",
                                "{formulation: v-w-p}")),
            "c.yaml:8:47: material 'soil': only `formulation: u-p` takes permeabilities that differ between axes");
}

TEST(CaseWater, WantsATableThatAscends) {
  EXPECT_EQ(with_water("table: [[0, 2 m], [0, 3 m]]"),
            "c.yaml:11:27: water.table: x = 0 m must be beyond that of the point before, 0 m");
  EXPECT_NE(with_water("table: []").find("expected points [[x, y], …]"), std::string::npos);
  EXPECT_NE(with_water("table: 3 m").find("expected points [[x, y], …]"), std::string::npos);
}

TEST(CaseWater, WantsALevelForHydrostaticPressure) {
  EXPECT_EQ(with_water("initial: {method: hydrostatic}"),
            "c.yaml:11:18: water.initial: `method: hydrostatic` needs a level, or a water table");
  EXPECT_EQ(with_water("initial: {method: hydrostatic}, table: [[0, 2 m]]"), "");
  EXPECT_NE(message_of(replaced(replaced(column, "gravity: [0, -9.81 m/s2]", "gravity: [0, 0]"),
                                "{density: 1000 kg/m3}", "{ponds: [{level: 4 m}]}"))
                .find("c.yaml:11:16: water: ponds and hydrostatic pressure need gravity along the last axis"),
            std::string::npos);
}

TEST(CaseWater, WantsRegionsOfTheDimensionOfTheGrid) {
  const std::string flat = "region: {box: {min: [0, 0, 0], max: [1 m, 1 m, 1 m]}}";
  const std::string wrong = "box: found 3 components; the grid has 2 dimensions";
  EXPECT_EQ(with_more("surface_loads:\n  - {pressure: 1 kPa, " + flat + "}\n"), "c.yaml:13:37: " + wrong);
  EXPECT_EQ(with_water("ponds: [{level: 4 m, " + flat + "}]"), "c.yaml:11:44: " + wrong);
  EXPECT_NE(
      with_more("surface_loads: [{pressure: 1 kPa, region: {half_space: {point: [0, 0, 0], normal: [0, 0, 1]}}}]\n")
          .find("half_space: found 3 components"),
      std::string::npos);
  EXPECT_NE(with_more("surface_loads: [{pressure: 1 kPa, region: {}}]\n").find("region: it has no shape"),
            std::string::npos);
}

TEST(CaseWater, WantsListsOfLoadsAndPonds) {
  EXPECT_NE(with_more("surface_loads: {pressure: 1 kPa}\n").find("c.yaml:12:16: surface_loads: found "),
            std::string::npos);
  EXPECT_NE(with_water("ponds: {level: 1 m}").find("expected a list of sections"), std::string::npos);
  EXPECT_NE(with_more("surface_loads: [{pressure: 1 m}]\n").find("c.yaml:12:28"), std::string::npos);
  EXPECT_NE(with_more("surface_loads: [{}]\n").find("'pressure' is missing, and so is 'level'"), std::string::npos);
  EXPECT_EQ(with_more("surface_loads: [{pressure: 1 kPa, level: 1 m}]\n"),
            "c.yaml:12:42: surface load: give `pressure` or `level`, not both");
  EXPECT_EQ(with_more("surface_loads: [{pressure: 1 kPa, density: 1 t/m3}]\n"),
            "c.yaml:12:44: surface load: density belongs to a liquid; it needs `level`");
  EXPECT_EQ(
      message_of(replaced(column, "gravity: [0, -9.81 m/s2]", "gravity: [0, 0]") + "surface_loads: [{level: 1 m}]\n"),
      "c.yaml:12:25: surface load: a level needs gravity that points down along the last axis");
}

TEST(CaseWater, ChangesMustBeOfKnownMaterialsThatHoldTheSame) {
  EXPECT_EQ(with_more("changes:\n  - {at: 1 s, material: soil, becomes: sail}\n"),
            "c.yaml:13:5: changes: unknown material 'sail'; allowed: soil; did you mean 'soil'?");
  const std::string dry =
      "  dry: {model: linear_elastic, density: 1600 kg/m3, youngs_modulus: 1 MPa}\n"
      "  open: {model: linear_elastic, density: 1600 kg/m3, youngs_modulus: 1 MPa, water: {porosity: 0.5, "
      "permeability: 1e-4 m/s}}\n"
      "  same: {model: linear_elastic, density: 1600 kg/m3, youngs_modulus: 2 MPa, water: {porosity: 0.4, "
      "permeability: 1e-5 m/s}}\n"
      "bodies:\n";
  const std::string three = replaced(column, "bodies:\n", dry);
  const std::string change = "changes: [{at: 1 s, material: soil, becomes: ";
  EXPECT_EQ(message_of(three + change + "same}]\n"), "");
  for (const std::string to : {"dry", "open"})
    EXPECT_EQ(message_of(three + change + to + "}]\n"),
              "c.yaml:15:11: changes: 'soil' and '" + to +
                  "' must have the same density and porosity, or both be dry: the points keep their grains and their "
                  "water");
}

// Known only when the system of the pressure is solved: nothing holds the mean pressure.
TEST(CaseWater, MustNotBeClosedInAndIncompressible) {
  const std::string closed =
      replaced(column + "boundaries: {left: roller, right: roller, bottom: roller, top: roller}\n", "max: [2 m, 3 m]",
               "max: [2 m, 5 m]");
  const auto simulation = Simulation::create(parse_case(closed, "c.yaml"));
  try {
    simulation->advance(1);
    FAIL() << "accepted";
  } catch (const CaseError& error) {
    EXPECT_NE(std::string(error.what()).find("this water is incompressible and closed in"), std::string::npos)
        << error.what();
  }
  const auto compressible =
      Simulation::create(parse_case(replaced(closed, "{density: 1000 kg/m3}", "{bulk_modulus: 2.2 GPa}"), "c.yaml"));
  for (int i = 0; i < 10; ++i) compressible->advance(1);
}

// ---- total_stress has no water ----

std::string in_total_stress(const std::string& from, const std::string& to) {
  return message_of(replaced(replaced(column, "two_phase", "total_stress"), from, to));
}

TEST(CaseTotalStress, RefusesWater) {
  const std::string end = "total_stress knows no water; take `physics: two_phase`";
  EXPECT_EQ(in_total_stress("", ""), "c.yaml:8:17: material 'soil': water: the physics " + end +
                                         "\nc.yaml:11:8: water: the physics " + end +
                                         "; a reservoir without water in the pores is a level in `surface_loads`");
  const std::string dry = replaced(replaced(column, ",\n         water: {porosity: 0.4, permeability: 1e-4 m/s}}", "}"),
                                   "water: {density: 1000 kg/m3}\n", "");
  const std::string single = replaced(dry, "two_phase", "total_stress");
  EXPECT_EQ(message_of(single), "");
  EXPECT_EQ(message_of(single + "surface_loads: [{pressure: 1 kPa}, {level: 3 m}]\n"), "");
  EXPECT_EQ(
      message_of(replaced(single, "model: linear_elastic, density: 1600 kg/m3, youngs_modulus: 1 MPa", "model: water")),
      "c.yaml:7:17: material 'soil': the physics " + end);
}

}  // namespace
}  // namespace sluice
