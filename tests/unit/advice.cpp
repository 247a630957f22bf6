/// The advisor on whole cases: what it measures in them, what it says, what `physics: auto` takes, and what it refuses.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/case/resolved_case.h"
#include "core/simulation/simulation.h"
#include "physics/advice/judgement.h"
#include "physics/materials/material.h"

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
  Layered dry_above{.more = "water: {table: [[0, 3 m], [8 m, 3 m]]}\n"};
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
  layered.bodies += "  - {material: lens, box: {min: [1 m, 1 m], max: [5 m, 2 m]}, replaces: soil}\n";
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

/// M = 13.5 MPa: c_v = 1372 k. Gravity is absent, so that total stresses may be drained.
Layered layer(double permeability, const std::string& advice, const std::string& more = "") {
  Layered layered{.more = more, .advice = advice};
  layered.soil = fmt::format(
      "{{model: linear_elastic, density: 1590 kg/m3, youngs_modulus: 10 MPa, water: {{porosity: 0.4, permeability: {} "
      "m/s}}}}",
      permeability);
  return layered;
}

/// Q = 50 MPa: kappa = 0.79, and sound is but 2.2 times as fast as the waves of the skeleton.
const std::string some_air = "water: {bulk_modulus: 20 MPa}\n";

TEST(Advice, SaysWhatIsTooMuch) {
  EXPECT_TRUE(says(layer(1e-2, "loading_time: 20 s"), "more than it needs: drained total stress is within 5 %"));
  EXPECT_TRUE(says(layer(1e-8, "loading_time: 1 s", some_air), "more than it needs: undrained total stress"));
  EXPECT_TRUE(says(layer(1e-4, "loading_time: 1 s"), "u-p is the right one within 5 %"));
  EXPECT_TRUE(says(layer(1e-4, "loading_time: 1 s", "water: {formulation: v-w-p}\n"), "more than it needs: u-p"));
  EXPECT_TRUE(says(Layered{.soil = "{model: linear_elastic, density: 1590 kg/m3, youngs_modulus: 10 MPa}"},
                   "nothing holds water; take `physics: total_stress`"));
}

// The simplest is not the cheapest where the sound of stiff water limits its step.
TEST(Advice, SaysWhyTheSimplestIsNotTaken) {
  EXPECT_TRUE(says(layer(1e-8, "loading_time: 1 s"), "undrained total stress would do"));
  EXPECT_TRUE(says(layer(1e-8, "loading_time: 1 s", "water: {bulk_modulus: 2.2 GPa}\n"),
                   "sound in its water makes 18 times as many steps"));
  EXPECT_TRUE(says(layer(1e-2, "loading_time: 20 s", "gravity: [0, -9.81]\n"),
                   "drained total stress would do (error 1.9 %), but its water has a pressure"));
}

TEST(Advice, WarnsOfWhatIsTooLittle) {
  EXPECT_TRUE(says(layer(0.05, "frequency: 10 Hz"), "WARNING         the case models too little: u-p is"));
  EXPECT_TRUE(says(layer(0.05, "frequency: 10 Hz"), "take v-w-p"));
  Layered dry{.physics = "total_stress",
              .soil = "{model: linear_elastic, density: 1990 kg/m3, youngs_modulus: 10 MPa}"};
  EXPECT_TRUE(says(dry, "total stresses; with advice.materials.NAME.permeability it is judged"));
  dry.advice = "loading_time: 1 s, materials: {soil: {permeability: 1e-3 m/s}}";
  EXPECT_TRUE(says(dry, "WARNING         the case models too little: undrained total stress is 33 % off"));
  EXPECT_TRUE(says(dry, "take u-p"));
  dry.advice = "loading_time: 1 s, materials: {soil: {permeability: 1e-7 m/s}}";
  EXPECT_TRUE(says(dry, "undrained total stress is the right one"));
}

// The slide of the dam is undrained; the same dam shaken needs its pore pressure, for its sand has friction.
TEST(Advice, ShakingOfSoilWithFrictionNeedsWater) {
  Layered dam{.physics = "total_stress",
              .soil =
                  "{model: mohr_coulomb, density: 1800 kg/m3, youngs_modulus: 2 MPa, friction_angle: 35 deg, "
                  "cohesion: 1 Pa}"};
  dam.advice = "loading_time: 50 s, materials: {soil: {permeability: 1e-7 m/s}}";
  EXPECT_TRUE(says(dam, "undrained total stress is the right one"));
  dam.advice = "frequency: 2 Hz, materials: {soil: {permeability: 1e-7 m/s}}";
  EXPECT_TRUE(says(dam,
                   "WARNING         the case models too little: loads that go to and fro build up pressure in "
                   "'soil'"));
  EXPECT_TRUE(says(dam, "take u-p"));
}

TEST(Advice, TheMostDemandingStageCounts) {
  EXPECT_TRUE(says(layer(0.05, "stages: {slow: {loading_time: 100 s}, shaking: {frequency: 10 Hz}}"),
                   "'soil', shaking, 10 Hz); take v-w-p"));
}

TEST(Advice, KnowsTheAxesAlongWhichNothingVaries) {
  EXPECT_TRUE(says(Layered{}, "nothing varies along x: one cell across gives the same 16 times cheaper"));
  EXPECT_FALSE(says(Layered{.more = "gravity: [1, -9]\n"}, "nothing varies"));
  EXPECT_FALSE(says(Layered{.more = "surface_loads: [{pressure: 1 kPa, region: {box: {min: [0, 0], max: [2, 6]}}}]\n"},
                    "nothing varies"));
  const auto deep = [](const std::string& more, const std::string& body) {
    const Case definition = parse_case(
        "schema: 1\nphysics: total_stress\nend_time: 2 s\n"
        "grid: {min: [0, 0, 0], max: [4, 3, 3], cell: 0.5 m}\n"
        "materials: {soil: {model: linear_elastic, density: 1590 kg/m3, youngs_modulus: 10 MPa}}\n"
        "bodies: [{material: soil, " +
            body + "}]\n" + more,
        "c.yaml");
    std::string text;
    for (const std::string& line : lines(judge(definition), definition)) text += line + "\n";
    return text;
  };
  const std::string wedge = "polygon: [[0, 0], [4, 0], [0, 2]]",
                    walls = "boundaries: {bottom: fixed, front: roller, back: roller}\n";
  EXPECT_NE(deep(walls, wedge).find("nothing varies along y: plane strain gives the same with 12 times fewer"),
            std::string::npos);
  EXPECT_EQ(deep("boundaries: {front: fixed, back: roller}\n", wedge).find("nothing varies"), std::string::npos);
  EXPECT_EQ(deep("boundaries: {front: roller}\n", wedge).find("nothing varies"), std::string::npos);
  EXPECT_EQ(deep(walls, "box: {min: [0, 0, 0], max: [2, 2, 2]}").find("nothing varies"), std::string::npos);
}

TEST(Advice, WarnsOfSchemesThatDoNotSuit) {
  const std::string gravity = "gravity: [0, -9.81]\n";
  Layered layered{.more = gravity + "scheme: {shape: linear, transfer: apic}\n"};
  EXPECT_TRUE(says(layered, "linear functions with APIC are not to be recommended"));
  EXPECT_FALSE(says(layered, "cross cells")) << "an elastic layer settles by 1 cm";
  layered.soil =
      "{model: tresca, density: 1590 kg/m3, youngs_modulus: 1 MPa, strength: 5 kPa, water: {porosity: 0.4, "
      "permeability: 1e-5 m/s}}";
  EXPECT_TRUE(says(layered, "stresses jump when points cross cells"));
  EXPECT_TRUE(says(layered, "'soil' keeps its volume where it flows: `f_bar: true`"));
  layered.more = gravity + "scheme: {shape: ugimp}\n";
  EXPECT_TRUE(says(layered, "`f_bar: true`"));
  for (const char* splines : {"f_bar: true", "f_bar: false"}) {
    layered.more = gravity + fmt::format("scheme: {{{}}}\n", splines);
    EXPECT_TRUE(says(layered, "quadratic_bspline, apic, usl suit the case"));
  }
}

// ---- physics: auto ----

double number(const Case& definition, const std::string& key) {
  const Node* const value = definition.materials.at(0).second.find(key);
  return value == nullptr ? NAN : std::stod(value->scalar);
}

std::string verdict(const Case& definition) { return definition.advice.find("verdict")->find("model")->scalar; }

Layered automatic(Layered layered) {
  layered.physics = "auto";
  return layered;
}

TEST(Auto, TakesTheFormulation) {
  const Case slow = automatic(layer(1e-4, "loading_time: 1 s")).read();
  EXPECT_EQ(slow.physics, "two_phase");
  EXPECT_EQ(slow.water.find("formulation")->scalar, "u-p");
  EXPECT_EQ(verdict(slow), "u-p");
  const Case fast = automatic(layer(0.3, "frequency: 10 Hz")).read();  // coarser than u-p allows at all
  EXPECT_EQ(fast.water.find("formulation")->scalar, "v-w-p");
  EXPECT_EQ(Simulation::create(fast)->steps(), 0);
}

// Total stresses get the weight of the water; undrained ones its stiffness: lambda + K_w / n, and the same shear
// modulus.
TEST(Auto, TakesTotalStresses) {
  const Case drained = automatic(layer(1e-2, "loading_time: 20 s")).read();
  EXPECT_EQ(drained.physics, "total_stress");
  EXPECT_EQ(verdict(drained), "drained total stress");
  EXPECT_DOUBLE_EQ(number(drained, "density"), 1990);
  EXPECT_NEAR(make_material(drained.materials[0].second)->elasticity().shear, 1e7 / 2.6, 1);
  const Case undrained = automatic(layer(1e-8, "loading_time: 1 s", some_air)).read();
  EXPECT_EQ(undrained.physics, "total_stress");
  const auto elasticity = make_material(undrained.materials[0].second)->elasticity();
  EXPECT_NEAR(elasticity.shear, 1e7 / 2.6, 1);
  EXPECT_NEAR(elasticity.constrained_modulus(), exact::constrained_modulus(1e7, 0.3) + 20e6 / 0.4, 100);
  for (const Case& definition : {drained, undrained}) {
    const auto simulation = Simulation::create(definition);
    simulation->advance(1);
    EXPECT_FALSE(simulation->particles().columns.contains("pore_pressure"));
  }
}

// Friction needs an undrained strength; the section that gives it takes the place of the material.
TEST(Auto, TakesWhatTheMaterialIsWhenUndrained) {
  Layered clay = automatic(layer(1e-9, "loading_time: 1 s"));
  const std::string pores = "water: {porosity: 0.4, permeability: 1e-9 m/s}";
  clay.more = "gravity: [0, -9.81]\nwater: {ponds: [{level: 5 m}]}\n";
  clay.soil =
      "{model: mohr_coulomb, density: 1590 kg/m3, youngs_modulus: 10 MPa, friction_angle: 25 deg, cohesion: 1 "
      "kPa, " +
      pores + "}";
  EXPECT_EQ(verdict(clay.read()), "u-p");
  EXPECT_TRUE(says(clay, "u-p")) << "the case is two_phase by now";
  clay.soil.pop_back();
  clay.soil +=
      ", undrained: {model: tresca, density: 1990 kg/m3, youngs_modulus: 12 MPa, poisson_ratio: 0.49, strength: 20 "
      "kPa}}";
  clay.advice += ", tolerance: 10 %";
  const Case taken = clay.read();
  EXPECT_EQ(verdict(taken), "u-p") << "its nearly incompressible total stresses take 2.9 times as many steps";
  Layered soft = clay;
  soft.soil.replace(soft.soil.find("0.49"), 4, "0.45");
  const Case total = soft.read();
  EXPECT_EQ(verdict(total), "undrained total stress");
  EXPECT_EQ(total.materials[0].second.find("model")->scalar, "tresca");
  // The pond presses on.
  ASSERT_EQ(total.surface_loads.items.size(), 1u);
  EXPECT_EQ(total.surface_loads.items[0].find("level")->scalar, "5 m");
  EXPECT_NO_THROW(Simulation::create(total));
}

// The resolved case needs no advisor: it holds the module that was taken, and the verdict with its numbers.
TEST(Auto, StandsInTheResolvedCase) {
  const Case taken = automatic(layer(1e-4, "loading_time: 1 s")).read();
  const auto simulation = Simulation::create(taken);
  const std::string resolved = resolved_yaml(taken, simulation->resolved_sections());
  EXPECT_NE(resolved.find("physics: two_phase"), std::string::npos);
  const Case again = parse_case(resolved, "resolved.yaml");
  EXPECT_EQ(resolved_yaml(again, Simulation::create(again)->resolved_sections()), resolved);
  for (const char* const key : {"pi_1", "pi_2", "pi_3", "drainage_length_m", "error_of_u_p", "time_factor"})
    EXPECT_NE(again.advice.find("verdict")->find(key), nullptr) << key;
}

// ---- what it refuses ----

TEST(Advice, RefusesWhatIsWrong) {
  const auto with = [](const std::string& advice, const std::string& physics = "two_phase") {
    Layered layered{.physics = physics, .advice = advice};
    if (physics == "total_stress")
      layered.soil = "{model: linear_elastic, density: 1990 kg/m3, youngs_modulus: 10 MPa}";
    return message_of(layered);
  };
  EXPECT_EQ(with("loading_time: 1 s"), "");
  EXPECT_NE(with("loading: 1 s").find("c.yaml:10:10: unknown key 'loading'"), std::string::npos)
      << with("loading: 1 s");
  EXPECT_EQ(with("loading_time: 1 s, frequency: 2 Hz"),
            "c.yaml:10:40: advice: give loading_time or frequency, or stages with one of them each");
  EXPECT_EQ(with("stages: {slide: {}}"), "c.yaml:10:26: advice.stages.slide: give one of loading_time, frequency");
  EXPECT_EQ(with("frequency: 2 Hz, stages: {slide: {frequency: 1 Hz}}"),
            "c.yaml:10:35: advice: stages take the place of loading_time and frequency; leave these out");
  EXPECT_EQ(with("materials: {soil: {permeability: 1 mm/s}}"),
            "c.yaml:10:28: advice.materials.soil: the physics two_phase reads `water` of the material; leave this out");
  EXPECT_EQ(with("materials: {sol: {permeability: 1 mm/s}}", "total_stress"),
            "c.yaml:10:27: advice.materials: unknown material 'sol'; allowed: soil; did you mean 'soil'?");
  EXPECT_EQ(message_of(automatic(layer(1e-4, "", "water: {formulation: u-p}\n"))),
            "c.yaml:11:22: water.formulation: `physics: auto` chooses it; leave it out");
  Layered undrained = layer(1e-4, "");
  undrained.soil.pop_back();
  undrained.soil += ", undrained: {model: water}}";
  EXPECT_EQ(message_of(undrained), "");  // read by the module: without auto an unknown key of the material
  EXPECT_THROW(Simulation::create(undrained.read()), CaseError);
}

}  // namespace
}  // namespace sluice::advice
