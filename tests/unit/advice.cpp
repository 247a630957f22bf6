/// The advisor on whole cases: what it measures in them, what it says, what `physics: auto` takes, and what it refuses.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/case/resolved_case.h"
#include "core/simulation/simulation.h"
#include "physics/advice/judgement.h"

namespace sluice::advice {
namespace {

/// A layer of saturated soil, 8 m wide and 4 m thick, drained at its surface.
struct Layered {
  std::string physics = "two_phase";
  std::string soil =
      "{model: linear_elastic, density: 1590 kg/m3, youngs_modulus: 10 MPa, water: {porosity: 0.4, permeability: 1e-5 "
      "m/s}}";
  std::string more;
  std::string bodies = "  - {material: soil, box: {min: [0 m, 0 m], max: [8 m, 4 m]}}\n";
  std::string advice = "loading_time: 1 s";

  std::string text() const {
    return fmt::format(
        "schema: 1\nphysics: {}\nend_time: 2 s\n"
        "grid: {{min: [0 m, 0 m], max: [8 m, 6 m], cell: 0.5 m}}\n"
        "materials:\n  soil: {}\n"
        "bodies:\n{}"
        "boundaries: {{bottom: roller, left: roller, right: roller}}\n"
        "advice: {{{}}}\n{}",
        physics, soil, bodies, advice, more);
  }
  Case read() const { return parse_case(text(), "c.yaml"); }
};

std::string message_of(const Layered& layered) {
  try {
    layered.read();
  } catch (const CaseError& error) {
    return error.what();
  }
  return "";
}

std::string all_lines(const Layered& layered) {
  const Case definition = layered.read();
  std::string text;
  for (const std::string& line : lines(judge(definition), definition)) text += line + "\n";
  return text;
}

bool says(const Layered& layered, const std::string& words) {
  return all_lines(layered).find(words) != std::string::npos;
}

// ---- what it measures ----

// Exact, for ways along an axis of the lattice.
TEST(Advice, DrainageLengthIsTheWayToTheSurface) {
  EXPECT_NEAR(numbers_of(Layered{}.read()).soils[0].drainage_length, 4, 1e-9);
  Layered both{.more = "water: {faces: {bottom: drained}}\n"};
  EXPECT_NEAR(numbers_of(both.read()).soils[0].drainage_length, 2, 0.26);  // half a point of the lattice more
  Layered dry_above{.bodies = "  - {material: soil, box: {min: [0 m, 0 m], max: [8 m, 4 m]}}\n",
                    .advice = "",
                    .more = ""};
  dry_above.more = "water: {table: [[0, 3 m], [8 m, 3 m]]}\n";
  EXPECT_NEAR(numbers_of(dry_above.read()).soils[0].drainage_length, 3, 1e-9);
}

// A drain a thousand times as permeable is as good as a surface; one ten times as permeable is part of the way.
TEST(Advice, WaterLeavesThroughSoilThatIsFarMorePermeable) {
  for (const auto& [k, length] : {std::pair{1e-2, 2.0}, {1e-4, 3.0}}) {
    Layered layered;
    layered.soil += fmt::format(
        "\n  drain: {{model: linear_elastic, density: 1590 kg/m3, youngs_modulus: 10 MPa, water: {{porosity: 0.4, "
        "permeability: {} m/s}}}}\n  cap: {{model: linear_elastic, density: 1590 kg/m3, youngs_modulus: 10 MPa, water: "
        "{{porosity: 0.4, permeability: 1e-5 m/s}}}}",
        k);
    layered.bodies =
        "  - {material: soil, box: {min: [0 m, 0 m], max: [8 m, 2 m]}}\n"
        "  - {material: drain, box: {min: [0 m, 2 m], max: [8 m, 3 m]}}\n";
    const auto soils = numbers_of(layered.read()).soils;
    EXPECT_NEAR(soils[0].drainage_length, length, 1e-9) << k;
    ASSERT_EQ(soils.size(), 2u) << "cap is nowhere";
  }
}

TEST(Advice, WithoutAWayOutSoilIsUndrained) {
  Layered closed{.soil =
                     "{model: linear_elastic, density: 1590 kg/m3, youngs_modulus: 10 MPa, water: {porosity: 0.4, "
                     "permeability: 1e-2 m/s}}",
                 .bodies = "  - {material: soil, box: {min: [0 m, 0 m], max: [8 m, 6 m]}}\n"};
  const Judgement judgement = judge(closed.read());
  EXPECT_TRUE(std::isinf(judgement.scene.soils[0].drainage_length));
  EXPECT_EQ(judgement.choices[1].demand.error, 0);
  EXPECT_GT(judgement.choices[0].demand.error, 0.9);
}

// The thickness of a layer, level or at 45 degrees, and not its length; the sides of the grid do not end it.
TEST(Advice, ThicknessIsTheShortWayAcross) {
  Layered layered;
  layered.soil += "\n  lens: {model: linear_elastic, density: 1590 kg/m3, youngs_modulus: 10 MPa}";
  layered.bodies +=
      "  - {material: lens, box: {min: [1 m, 1 m], max: [5 m, 2 m]}, replaces: soil}\n";
  auto layers = numbers_of(layered.read()).layers;
  EXPECT_NEAR(layers[1].thickness, 1, 1e-9);
  EXPECT_TRUE(says(layered, "'lens', is 1 m thick: 2 cells, where 4 are wanted: cells of 0.25 m"));
  layered.bodies =
      "  - {material: soil, box: {min: [0 m, 0 m], max: [8 m, 4 m]}}\n"
      "  - {material: lens, polygon: [[1 m, 0.5 m], [2.5 m, 0.5 m], [5 m, 3 m], [3.5 m, 3 m]], replaces: soil}\n";
  layers = numbers_of(layered.read()).layers;
  EXPECT_NEAR(layers[1].thickness, 1.5 * std::sqrt(0.5), 0.4);  // a point of the lattice along the diagonal: 0.35 m
}

// ---- how loads come ----

TEST(Advice, GuessesHowTheLoadComes) {
  const auto names = [](const std::string& more) {
    Layered layered{.more = more, .advice = ""};
    std::string all;
    for (const Stage& stage : numbers_of(layered.read()).stages) all += stage.name + "; ";
    return all;
  };
  EXPECT_EQ(names(""), "the whole run, 2 s; ");
  EXPECT_EQ(names("surface_loads: [{pressure: [[0.5 s, 0 Pa], [0.8 s, 1 kPa], [1 s, 1 kPa]]}]\n"),
            "surface_loads, 0.3 s; the whole run, 2 s; ");
  EXPECT_EQ(names("surface_loads: [{pressure: [[0, 0], [1, 1], [2, -1], [3, 1], [4, -1], [5, 1], [6, 0]]}]\n"),
            "surface_loads, 0.5 Hz; the whole run, 2 s; ");
  // Elastic soil does not fall.
  EXPECT_EQ(names("gravity: [0, -9.81]\n"), "the whole run, 2 s; ");
}

// ---- what it says ----

// c_v t / L2 = 0.13 for k = 1e-4 m/s: neither drained nor undrained.
TEST(Advice, ModelsTooMuchTooLittleOrWhatItNeeds) {
  Layered layered;
  layered.soil = replaced_permeability("1e-4 m/s");
}

}  // namespace
}  // namespace sluice::advice
