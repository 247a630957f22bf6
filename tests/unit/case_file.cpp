/// Case files: what is read, every message, extends, overrides, polygons of other files.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "core/case/case.h"

namespace sluice {
namespace {

/// Line 1 schema, 2 physics, 3 grid, 4 materials, 5 bodies, 6 the first body, 7 end_time.
const std::string minimal =
    "schema: 1\n"
    "physics: total_stress\n"
    "grid: {min: [0 m, 0 m], max: [10 m, 5 m], cell: 1 m}\n"
    "materials: {soil: {model: linear_elastic, density: 2000 kg/m3, youngs_modulus: 1 MPa}}\n"
    "bodies:\n"
    "  - {material: soil, box: {min: [1 m, 0 m], max: [4 m, 3 m]}}\n"
    "end_time: 2 s\n";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

std::string message_of(const std::string& text, const std::vector<Override>& overrides = {}) {
  try {
    parse_case(text, "c.yaml", overrides);
  } catch (const CaseError& error) {
    return error.what();
  }
  return "";
}

std::string message_with(const std::string& from, const std::string& to) {
  return message_of(replaced(minimal, from, to));
}

std::string message_with_more(const std::string& more) { return message_of(minimal + more); }

/// Files in a folder of their own, taken away at the end.
class CaseFiles : public testing::Test {
 protected:
  CaseFiles()
      : folder_(std::filesystem::path(testing::TempDir()) /
                ("sluice_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()))) {
    std::filesystem::create_directories(folder_);
  }
  ~CaseFiles() override { std::filesystem::remove_all(folder_); }

  std::string write(const std::string& name, const std::string& text) const {
    const std::string path = (folder_ / name).string();
    std::ofstream(path) << text;
    return path;
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  static std::string message_of_file(const std::string& file, const std::vector<Override>& overrides = {}) {
    try {
      load_case(file, overrides);
    } catch (const CaseError& error) {
      return error.what();
    }
    return "";
  }

 private:
  std::filesystem::path folder_;
};

TEST(CaseFile, MinimalCaseGetsAllDefaults) {
  const Case c = parse_case(minimal, "c.yaml");
  EXPECT_EQ(c.dimension(), 2);
  EXPECT_EQ(c.grid.cell, (std::vector<double>{1, 1}));
  EXPECT_EQ(c.gravity, (std::vector<double>{0, 0}));
  EXPECT_EQ(c.end_time, 2);
  ASSERT_EQ(c.bodies.size(), 1u);
  EXPECT_EQ(c.bodies[0].particles_per_cell, 4);
  EXPECT_EQ(c.bodies[0].velocity, (std::vector<double>{0, 0}));
  EXPECT_EQ(c.bodies[0].place.text(), "c.yaml:6:5");
  EXPECT_EQ(c.faces.size(), 4u);
  EXPECT_EQ(c.faces.at("left").normal, FaceCase::Normal::free);
  EXPECT_EQ(c.scheme.shape, SchemeCase{}.shape);
  EXPECT_FALSE(c.scheme.fixed_time_step);
  EXPECT_EQ(c.outflow, OutflowPolicy::error);
  EXPECT_FALSE(c.initial_stress);
  EXPECT_EQ(c.materials.at(0).first, "soil");
  EXPECT_EQ(c.output.checkpoint_every, 30);
}

TEST(CaseFile, ReadsEverything) {
  const Case c = parse_case(minimal +
                                "title: A slope\n"
                                "gravity: [0, -9.81 m/s2]\n"
                                "boundaries: {left: roller, right: fixed, bottom: {normal: fixed, friction: 0.4},\n"
                                "             top: {normal: fixed, tangential: free}}\n"
                                "initial_stress: {method: elastic_equilibrium}\n"
                                "scheme: {shape: linear, transfer: flip, flip_fraction: 99 %, stress_update: usf, "
                                "f_bar: true, time_step: 1 ms}\n"
                                "outflow: clamp\n"
                                "observe: {runout: {measure: front, direction: [-3, 4], region: {half_space: {point: "
                                "[5 m, 0 m], normal: [1, 0]}}}}\n"
                                "output: {every: 1 s, history_every: 0.1 s, pictures: [material], picture_times: [0, 1 "
                                "s], checkpoint_every: 1 min}\n",
                            "c.yaml");
  EXPECT_EQ(c.title, "A slope");
  EXPECT_EQ(c.gravity[1], -9.81);
  EXPECT_EQ(c.faces.at("left").normal, FaceCase::Normal::fixed);
  EXPECT_EQ(c.faces.at("left").tangential, FaceCase::Tangential::free);
  EXPECT_EQ(c.faces.at("right").tangential, FaceCase::Tangential::fixed);
  EXPECT_EQ(c.faces.at("bottom").tangential, FaceCase::Tangential::friction);
  EXPECT_EQ(c.faces.at("bottom").friction, 0.4);
  EXPECT_EQ(c.faces.at("top").normal, FaceCase::Normal::fixed);
  EXPECT_EQ(c.initial_stress.find("method")->scalar, "elastic_equilibrium");
  EXPECT_EQ(c.scheme.fixed_time_step, 1e-3);
  EXPECT_EQ(c.scheme.flip_fraction, 0.99);
  EXPECT_TRUE(c.scheme.f_bar);
  EXPECT_EQ(c.outflow, OutflowPolicy::clamp);
  ASSERT_EQ(c.observe.size(), 1u);
  EXPECT_EQ(c.observe[0].name, "runout");
  EXPECT_DOUBLE_EQ(c.observe[0].direction[0], -0.6);
  EXPECT_TRUE(c.observe[0].region->contains(std::vector{4.0, 100.0}));
  EXPECT_EQ(c.output.picture_times, (std::vector<double>{0, 1}));
  EXPECT_EQ(c.output.checkpoint_every, 60);
}

TEST(CaseFile, ThreeDimensions) {
  const Case c = parse_case(
      "schema: 1\nphysics: total_stress\ngrid: {min: [0, 0, 0], max: [4, 2, 3], cell: [1 m, 1 m, 50 cm]}\n"
      "materials: {soil: {model: linear_elastic}}\n"
      "bodies: [{material: soil, polygon: [[0, 0], [2, 0], [2, 2]]}]\nboundaries: {front: roller}\nend_time: 1 s\n",
      "c.yaml");
  EXPECT_EQ(c.dimension(), 3);
  EXPECT_EQ(c.bodies[0].particles_per_cell, 8);
  EXPECT_EQ(c.faces.size(), 6u);
  EXPECT_EQ(c.grid.cell[2], 0.5);
}

TEST(CaseFile, UnknownKeysAndMissingKeys) {
  EXPECT_NE(
      message_with_more("gravty: [0, 1]\n").find("c.yaml:8:1: unknown key 'gravty' in the case; allowed: schema, "),
      std::string::npos);
  EXPECT_NE(message_with_more("gravty: [0, 1]\n").find("did you mean 'gravity'?"), std::string::npos);
  EXPECT_EQ(
      message_with("cell: 1 m", "cel: 1 m"),
      "c.yaml:3:7: grid: the key 'cell' is missing (number in m, above 0; max - min must be a whole number of cells): "
      "Cell size: one number for all axes, or one for each.\n"
      "c.yaml:3:43: unknown key 'cel' in grid; allowed: min, max, cell; did you mean 'cell'?");
  EXPECT_NE(message_with("end_time: 2 s\n", "").find("the case: the key 'end_time' is missing (number in s, above 0)"),
            std::string::npos);
  EXPECT_EQ(message_with("schema: 1", "schema: 2"),
            "c.yaml:1:9: schema: found '2'; this version of the program knows schema 1 only");
  EXPECT_NE(message_of("").find("c.yaml:1:1: the case: the key 'grid' is missing"), std::string::npos);
  EXPECT_NE(
      message_with("model: linear_elastic, ", "").find("c.yaml:4:19: material 'soil': the key 'model' is missing"),
      std::string::npos);
}

TEST(CaseFile, WrongValues) {
  EXPECT_EQ(message_with("end_time: 2 s", "end_time: -2 s"), "c.yaml:7:11: end_time is -2 s; it must be above 0");
  EXPECT_EQ(message_with("end_time: 2 s", "end_time: 0"), "c.yaml:7:11: end_time is 0; it must be above 0");
  EXPECT_EQ(message_with("end_time: 2 s", "end_time: 2 m"),
            "c.yaml:7:11: end_time: found '2 m', a length; expected a time, for example 1 ms");
  EXPECT_EQ(message_with("end_time: 2 s", "end_time: [2 s]"),
            "c.yaml:7:11: end_time: found a list of 1; expected a time, for example 1 ms");
  EXPECT_EQ(message_with_more("scheme: {courant: 1.5}\n"),
            "c.yaml:8:19: courant is 1.5; it must be above 0 and at most 1");
  EXPECT_EQ(message_with_more("scheme: {time_step: compute}\n"),
            "c.yaml:8:21: time_step: found 'compute'; allowed: computed; did you mean 'computed'?");
  EXPECT_EQ(message_with_more("scheme: {stress_update: usx}\n"),
            "c.yaml:8:25: stress_update: found 'usx'; allowed: usf, usl, musl; did you mean 'usf'?");
  EXPECT_EQ(message_with_more("outflow: delete\n"),
            "c.yaml:8:10: outflow: found 'delete'; allowed: error, remove, clamp");
  EXPECT_EQ(message_with_more("gravity: [0, 0, -9.81 m/s2]\n"),
            "c.yaml:8:10: gravity: found 3 components; the grid has 2 dimensions");
  EXPECT_EQ(message_with_more("observe: {a: {measure: front, direction: [0, 0]}}\n"),
            "c.yaml:8:42: direction: all components are 0");
}

TEST(CaseFile, WrongGrids) {
  EXPECT_EQ(message_with("max: [10 m, 5 m]", "max: [10.5 m, 5 m]"),
            "c.yaml:3:30: grid: the extent along x is 10.5 m, which is 10.5 cells of 1 m; it must be a whole number of "
            "cells, "
            "for example 10 m or 11 m");
  EXPECT_EQ(message_with("max: [10 m, 5 m]", "max: [10 m, -5 m]"),
            "c.yaml:3:30: grid: max is -5 m along y; it must be above min, 0 m");
  EXPECT_EQ(message_with("max: [10 m, 5 m]", "max: [10 m, 5 m, 1 m]"),
            "c.yaml:3:30: grid: min has 2 components, max has 3");
  EXPECT_EQ(message_with("cell: 1 m", "cell: [1 m, 1 m, 1 m]"), "c.yaml:3:49: grid: cell has 3 components, min has 2");
  EXPECT_EQ(message_with("cell: 1 m", "cell: 0 m"), "c.yaml:3:49: cell is 0 m; it must be above 0");
  EXPECT_EQ(message_with("cell: 1 m", "cell: 1 um"),
            "c.yaml:3:49: grid: 1e+07 cells along x; at most 1e+06 are possible\n"
            "c.yaml:3:49: grid: 5e+06 cells along y; at most 1e+06 are possible");
  // Cells whose size is no binary fraction are whole numbers, too.
  EXPECT_EQ(message_with("cell: 1 m", "cell: 0.1 m"), "");
}

TEST(CaseFile, WrongBodies) {
  EXPECT_EQ(message_with("material: soil", "material: sol"),
            "c.yaml:6:16: unknown material 'sol'; allowed: soil; did you mean 'soil'?");
  EXPECT_EQ(message_with("box: {min: [1 m, 0 m], max: [4 m, 3 m]}",
                         "particles_per_cell: 5, box: {min: [1 m, 0 m], max: [4 m, 3 m]}"),
            "c.yaml:6:42: particles_per_cell is 5; it must be n^2 in 2-D; nearest: 4 and 9");
  EXPECT_EQ(message_with(", box: {min: [1 m, 0 m], max: [4 m, 3 m]}", ""),
            "c.yaml:6:5: body: it has no shape; give one or more of box, polygon, half_space, circle, sphere, layer, "
            "below_raster, above_raster, union, intersection, difference");
  EXPECT_EQ(message_with("min: [1 m, 0 m]", "min: [-12 m, 0 m]"),
            "c.yaml:6:5: the body of 'soil' reaches 12 m beyond the left face of the grid: it extends to x = -12 m, "
            "the grid ends "
            "at 0 m");
  EXPECT_EQ(message_with("max: [4 m, 3 m]", "max: [4 m, 6 m]"),
            "c.yaml:6:5: the body of 'soil' reaches 1 m beyond the top face of the grid: it extends to y = 6 m, the "
            "grid ends at "
            "5 m");
  EXPECT_EQ(message_with("max: [4 m, 3 m]}", "max: [4 m, 3 m]}, half_space: {point: [1 m, 0], normal: [1, 0]}"),
            "c.yaml:6:5: the body of 'soil' is empty: its shapes have nothing in common along x");
  EXPECT_EQ(message_with("box: {min: [1 m, 0 m], max: [4 m, 3 m]}", "half_space: {point: [0, -1 m], normal: [0, 1]}"),
            "c.yaml:6:5: the body of 'soil' lies outside the grid: it extends from y = -inf m to -1 m, the grid from 0 "
            "m to 5 m");
  EXPECT_EQ(message_with("max: [4 m, 3 m]", "max: [0 m, 3 m]"),
            "c.yaml:6:27: box: component 1 of max is 0 m; it must be above that of min, 1 m");
  EXPECT_EQ(message_with("box: {min: [1 m, 0 m], max: [4 m, 3 m]}", "polygon: [[0, 0], [1, 1]]"),
            "c.yaml:6:31: polygon: found a list of 2; expected three or more points [[x, y], …], or FILE.yaml#NAME");
  EXPECT_EQ(message_with("box: {min: [1 m, 0 m], max: [4 m, 3 m]}", "polygon: [[0, 0], [1, 1], [2, 2]]"),
            "c.yaml:6:31: polygon: its area is 0");
  EXPECT_EQ(message_with("max: [4 m, 3 m]}", "max: [4 m, 3 m]}, replaces: water"),
            "c.yaml:6:73: replaces: 'water' is not the material of an earlier body; allowed: none");
}

TEST(CaseFile, HalfSpacesMayBeUnbounded) {
  const Case c =
      parse_case(replaced(minimal, "box: {min: [1 m, 0 m], max: [4 m, 3 m]}",
                          "half_space: [{point: [0, 2 m], normal: [0, 1]}, {point: [0, 0], normal: [1, 1]}]"),
                 "c.yaml");
  EXPECT_EQ(c.bodies[0].region.parts.size(), 2u);
}

TEST(CaseFile, WrongFaces) {
  EXPECT_EQ(message_with_more("boundaries: {lft: roller}\n"),
            "c.yaml:8:14: unknown face 'lft' in boundaries; allowed: left, right, bottom, top; did you mean 'left'?");
  EXPECT_NE(message_with_more("boundaries: {front: roller}\n").find("unknown face 'front'"), std::string::npos);
  EXPECT_EQ(message_with_more("boundaries: {left: rollers}\n"),
            "c.yaml:8:20: boundaries.left: found 'rollers'; allowed: free, roller, fixed, periodic; did you mean "
            "'roller'?");
  EXPECT_EQ(message_with_more("boundaries: {left: {friction: 0.4}}\n"),
            "c.yaml:8:31: boundaries.left: friction needs `normal: fixed` or `normal: contact`");
  EXPECT_EQ(message_with_more("boundaries: {left: {normal: fixed, tangential: fixed, friction: 0.4}}\n"),
            "c.yaml:8:65: boundaries.left: friction contradicts `tangential: fixed`; leave out one of them");
  EXPECT_EQ(message_with_more("boundaries: {left: {normal: fixed, friction: -1}}\n"),
            "c.yaml:8:46: friction is -1; it must be at least 0");
}

TEST(CaseFile, PeriodicFaces) {
  EXPECT_EQ(message_with_more("boundaries: {left: periodic}\n"),
            "c.yaml:8:20: boundaries.left: periodic, but right is not; what leaves through one of them comes in at the "
            "other: give `right: periodic`, too");
  EXPECT_EQ(message_with_more("boundaries: {top: periodic, bottom: roller}\n"),
            "c.yaml:8:19: boundaries.top: periodic, but bottom is not; what leaves through one of them comes in at the "
            "other: give `bottom: periodic`, too");
  EXPECT_EQ(message_with_more("boundaries: {left: periodic, right: periodic}\n"),
            "c.yaml:8:20: boundaries.left: a periodic axis needs a multiple of 8 cells in 2-D; there are 10 along x; "
            "take 8 or 16");
  EXPECT_EQ(message_with_more("boundaries: {bottom: periodic, top: periodic}\n"),
            "c.yaml:8:22: boundaries.bottom: a periodic axis needs a multiple of 8 cells in 2-D; there are 5 along y; "
            "take 8");
  const Case good = parse_case(
      replaced(minimal, "max: [10 m, 5 m]", "max: [16 m, 5 m]") + "boundaries: {left: periodic, right: periodic}\n",
      "c.yaml");
  EXPECT_TRUE(good.grid.periodic[0]);
  EXPECT_FALSE(good.grid.periodic[1]);
}

TEST(CaseFile, AllProblemsComeAtOnce) {
  std::string text = replaced(minimal, "material: soil", "material: sol");
  text = replaced(text, "end_time: 2 s", "end_time: 2 m");
  text += "colour: red\n";
  const std::string message = message_of(text);
  EXPECT_EQ(std::count(message.begin(), message.end(), '\n'), 2);
  EXPECT_LT(message.find("c.yaml:6:16"), message.find("c.yaml:7:11"));
  EXPECT_LT(message.find("c.yaml:7:11"), message.find("c.yaml:8:1"));
}

TEST(CaseFile, OverridesAreCheckedLikeEverythingElse) {
  const Case c = parse_case(minimal, "c.yaml",
                            {{"materials.soil.youngs_modulus", "25 kPa"},
                             {"bodies.0.velocity", "[1 m/s, 0]"},
                             {"title", "Dam: a test"},
                             {"scheme.time_step", "2 ms"}});
  EXPECT_EQ(c.materials[0].second.find("youngs_modulus")->scalar, "25 kPa");
  EXPECT_EQ(c.materials[0].second.find("youngs_modulus")->place.text(), "--set materials.soil.youngs_modulus");
  EXPECT_EQ(c.bodies[0].velocity[0], 1);
  EXPECT_EQ(c.title, "Dam: a test");
  EXPECT_EQ(c.scheme.fixed_time_step, 2e-3);
  EXPECT_EQ(c.source.find("title")->scalar, "Dam: a test");

  EXPECT_EQ(message_of(minimal, {{"grid.cel", "1 m"}}),
            "--set grid.cel: unknown key 'cel' in grid; allowed: min, max, cell; did you mean 'cell'?");
  EXPECT_EQ(message_of(minimal, {{"end_time", "2 m"}}),
            "--set end_time: end_time: found '2 m', a length; expected a time, for example 1 ms");
  EXPECT_EQ(message_of(minimal, {{"end_time", ""}}),
            "--set end_time: end_time has no value; expected a time, for example 1 ms");
  EXPECT_EQ(message_of(minimal, {{"bodies.3.velocity", "[0, 0]"}}),
            "--set bodies.3.velocity: 'bodies' is a list of 1; '3' must be a number from 0 to 0");
  EXPECT_EQ(message_of(minimal, {{"end_time.a", "1"}}),
            "--set end_time.a: 'end_time' is the value '2 s' and has no key 'a'");
  EXPECT_NE(message_of(minimal, {{"gravity", "[0, 1"}}).find("--set gravity:1:"), std::string::npos);
  EXPECT_NE(message_of(minimal, {{"", "1"}}), "");
}

TEST_F(CaseFiles, MissingAndBrokenFiles) {
  EXPECT_EQ(message_of_file(path("none.yaml")), path("none.yaml") + ": no such file");
  const std::string broken = write("broken.yaml", "schema: 1\ngrid: {min: [0\n");
  EXPECT_EQ(message_of_file(broken).find(broken + ":"), 0u);
  EXPECT_NE(message_of_file(broken).find("YAML syntax"), std::string::npos);
}

TEST_F(CaseFiles, ExtendsMergesMapsAndKeepsPlaces) {
  write("base.yaml", minimal + "output: {every: 1 s, pictures: [a, b]}\n");
  write("middle.yaml", "extends: base.yaml\noutput: {pictures: [c]}\n");
  const std::string file =
      write("dam.yaml", "extends: middle.yaml\nend_time: 5 s\nmaterials: {soil: {density: 1 t/m3}}\n");
  const Case c = load_case(file);
  EXPECT_EQ(c.end_time, 5);
  EXPECT_EQ(c.output.every, 1);
  EXPECT_EQ(c.output.pictures, std::vector<std::string>{"c"});
  const Node& soil = c.materials.at(0).second;
  EXPECT_EQ(soil.find("density")->place.text(), file + ":3:29");
  EXPECT_EQ(soil.find("youngs_modulus")->place.text().substr(0, path("base.yaml").size() + 3),
            path("base.yaml") + ":4:");

  EXPECT_EQ(message_of_file(write("a.yaml", "extends: none.yaml\n")),
            path("a.yaml") + ":1:10: extends: there is no file '" + path("none.yaml") + "'");
  write("c.yaml", "extends: b.yaml\n");
  EXPECT_EQ(message_of_file(write("b.yaml", "extends: c.yaml\n")),
            path("c.yaml") + ":1:10: extends: 'b.yaml' leads back to itself");
}

TEST_F(CaseFiles, PolygonsOfOtherFiles) {
  write("section.yaml",
        "core: [[1 m, 0 m], [3 m, 0 m], [2 m, 2 m]]\nshell: {polygon: [[1, 0], [3, 0], [2, 2]]}\n"
        "bad: [[1 m, 0 m], [3 m, 0 s], [2 m, 2 m]]\n");
  const auto with = [&](const std::string& reference) {
    return write("case.yaml", replaced(minimal, "box: {min: [1 m, 0 m], max: [4 m, 3 m]}", "polygon: " + reference));
  };
  for (const char* const name : {"section.yaml#core", "section.yaml#shell"}) {
    const Case c = load_case(with(name));
    EXPECT_EQ(std::get<Polygon>(c.bodies[0].region.parts.at(0)).area(), 2);
    EXPECT_EQ(c.source.find("bodies")->items[0].find("polygon")->scalar, name);
  }
  const std::string place = path("case.yaml") + ":6:31: ";
  EXPECT_EQ(message_of_file(with("section.yaml#cor")),
            place + "polygon: 'section.yaml' has no 'cor'; allowed: core, shell, bad; did you mean 'core'?");
  EXPECT_EQ(message_of_file(with("none.yaml#core")), place + "polygon: there is no file '" + path("none.yaml") + "'");
  EXPECT_EQ(message_of_file(with("core")),
            place + "polygon: found 'core'; expected points [[x, y], …] or FILE.yaml#NAME");
  EXPECT_EQ(message_of_file(with("section.yaml#bad")),
            path("section.yaml") +
                ":3:25: point of the polygon, component 2: found '0 s', a time; expected a length, for example 0.5 m");
  const Case c = load_case(with("section.yaml#none"), {{"bodies.0.polygon", "section.yaml#core"}});
  EXPECT_EQ(std::get<Polygon>(c.bodies[0].region.parts.at(0)).vertices.size(), 3u);
}

// A preset fills what the case leaves out, and no more; what is resolved means the same without it.
TEST(CaseFile, PresetsFillTheScheme) {
  const auto scheme = [](const std::string& section) {
    return parse_case(
               "schema: 1\nphysics: total_stress\ngrid: {min: [0 m, 0 m], max: [1 m, 1 m], cell: 0.5 m}\n"
               "materials: {soil: {model: linear_elastic, density: 1 kg/m3, youngs_modulus: 1 Pa, poisson_ratio: 0}}\n"
               "bodies: [{material: soil, box: {min: [0 m, 0 m], max: [1 m, 1 m]}}]\nend_time: 1 s\n" +
                   section,
               "c.yaml")
        .scheme;
  };
  const SchemeCase usual = scheme(""), balanced = scheme("scheme: {preset: balanced}\n");
  EXPECT_EQ(usual.shape + usual.transfer + usual.stress_update, "quadratic_bsplineapicusl");
  EXPECT_EQ(balanced.shape + balanced.transfer + balanced.stress_update, "quadratic_bsplineapicusl");
  const SchemeCase paper = scheme("scheme: {preset: paper, stress_update: musl}\n");
  EXPECT_EQ(paper.shape + paper.transfer + paper.stress_update, "linearflipmusl");
  EXPECT_EQ(paper.flip_fraction, 1);
  EXPECT_EQ(paper.courant, 0.04);
  EXPECT_EQ(scheme("scheme: {preset: accurate}\n").shape, "cubic_bspline");
  try {
    scheme("scheme: {preset: fats}\n");
    FAIL();
  } catch (const CaseError& error) {
    EXPECT_STREQ(error.what(),
                 "c.yaml:7:18: unknown preset 'fats'; allowed: accurate, balanced, fast, paper; did you mean 'fast'?");
  }
}

}  // namespace
}  // namespace sluice
