/// Schemas: reading, checking, defaults and documentation of one section.
#include <gtest/gtest.h>

#include <numbers>

#include "core/case/schema.h"

namespace sluice {
namespace {

enum class Drainage { drained, undrained };

struct Layer {
  std::string name;
  double thickness = 0;
};

struct Soil {
  double density = 0, modulus = 0, angle = 0, ratio = 0;
  std::optional<double> cutoff;
  std::vector<double> stress;
  int layers_per_metre = 0;
  bool saturated = false;
  Drainage drainage = Drainage::drained;
  std::vector<std::string> tags;
  std::optional<Layer> top;
  std::vector<Layer> layers;
  std::vector<Layer> named;
};

const Schema<Soil>& soil_schema() {
  static const auto layer =
      Schema<Layer>("layer").quantity("thickness", &Layer::thickness, unit::length, above(0), "Thickness.");
  static const auto schema =
      Schema<Soil>("soil")
          .quantity("density", &Soil::density, unit::density, above(0), "Mass per volume.")
          .quantity("youngs_modulus", &Soil::modulus, unit::stress, above(0), "Young's modulus.")
          .quantity("friction_angle", &Soil::angle, unit::angle, from_below(0, right_angle), "Friction angle.", 0)
          .quantity("poisson_ratio", &Soil::ratio, unit::none, within(-1, 0.5), "Poisson's ratio.", 0.3)
          .quantity("cutoff", &Soil::cutoff, unit::stress, at_least(0), "Tension cut-off.", Absent{"the apex"})
          .quantities("stress", &Soil::stress, unit::stress, any_number, {{4, 6}}, "Stress.", Absent{"zero"})
          .integer("layers_per_metre", &Soil::layers_per_metre, from_to(1, 10), "Layers.", 2)
          .boolean("saturated", &Soil::saturated, "Whether the pores are full of water.", true)
          .choice("drainage", &Soil::drainage, {{"drained", Drainage::drained}, {"undrained", Drainage::undrained}},
                  "Drainage.", Drainage::undrained)
          .words("tags", &Soil::tags, "Tags.")
          .section("top", &Soil::top, layer, "The uppermost layer.")
          .sections("layers", &Soil::layers, layer, "Layers.", false)
          .named_sections("named", &Soil::named, layer, "Layers with names.");
  return schema;
}

Soil read(const std::string& text) { return soil_schema().read(read_yaml_text(text, "s.yaml"), {"model"}); }

std::string message_of(const std::string& text) {
  try {
    read("density: 1 kg/m3\nyoungs_modulus: 1 Pa\n" + text);
  } catch (const CaseError& error) {
    return error.what();
  }
  return "";
}

TEST(Schema, ReadsValuesAndFillsInDefaults) {
  const Soil soil = read(
      "{model: any, density: 1.8 t/m3, youngs_modulus: 2 MPa, friction_angle: 30 deg, stress: [1, 2, 3 Pa, 0, kPa], "
      "drainage: drained, tags: wet, layers: [{thickness: 1 m}, {thickness: 20 cm}], named: {clay: {thickness: 3}}}");
  EXPECT_EQ(soil.density, 1800);
  EXPECT_EQ(soil.modulus, 2e6);
  EXPECT_DOUBLE_EQ(soil.angle, std::numbers::pi / 6);
  EXPECT_EQ(soil.ratio, 0.3);
  EXPECT_FALSE(soil.cutoff);
  EXPECT_EQ(soil.stress, (std::vector<double>{1000, 2000, 3, 0}));
  EXPECT_EQ(soil.layers_per_metre, 2);
  EXPECT_TRUE(soil.saturated);
  EXPECT_EQ(soil.drainage, Drainage::drained);
  EXPECT_EQ(soil.tags, std::vector<std::string>{"wet"});
  EXPECT_FALSE(soil.top);
  ASSERT_EQ(soil.layers.size(), 2u);
  EXPECT_EQ(soil.layers[1].thickness, 0.2);
  ASSERT_EQ(soil.named.size(), 1u);
  EXPECT_EQ(soil.named[0].name, "clay");
}

TEST(Schema, Messages) {
  EXPECT_EQ(message_of("densty: 2\n").substr(0, 49), "s.yaml:3:1: unknown key 'densty' in soil; allowed");
  EXPECT_NE(message_of("densty: 2\n").find("layers, named, model; did you mean 'density'?"), std::string::npos);
  EXPECT_EQ(message_of("poisson_ratio: 0.7\n"), "s.yaml:3:16: poisson_ratio is 0.7; it must be above -1 and below 0.5");
  EXPECT_EQ(message_of("friction_angle: 95 deg\n"),
            "s.yaml:3:17: friction_angle is 95 deg; it must be at least 0 deg and below 90 deg");
  EXPECT_EQ(message_of("friction_angle: 30\n"),
            "s.yaml:3:17: friction_angle: '30' has no unit; an angle needs deg or rad, for example 35 deg");
  EXPECT_EQ(message_of("cutoff: 3 m\n"),
            "s.yaml:3:9: cutoff: found '3 m', a length; expected a stress, for example 2 MPa");
  EXPECT_EQ(message_of("cutoff: [1, 2]\n"),
            "s.yaml:3:9: cutoff: found a list of 2; expected a stress, for example 2 MPa");
  EXPECT_EQ(message_of("cutoff:\n"), "s.yaml:3:1: cutoff has no value; expected a stress, for example 2 MPa");
  EXPECT_EQ(message_of("stress: [1, 2]\n"), "s.yaml:3:9: stress: found 2 components; expected 4 or 6");
  EXPECT_EQ(message_of("stress: [1, 2, x, 4]\n"),
            "s.yaml:3:16: stress, component 3: 'x' is not a number; expected a stress, for example 2 MPa");
  EXPECT_EQ(message_of("layers_per_metre: 2.5\n"),
            "s.yaml:3:19: layers_per_metre: found '2.5'; expected a whole number");
  EXPECT_EQ(message_of("layers_per_metre: 11\n"),
            "s.yaml:3:19: layers_per_metre is 11; it must be at least 1 and at most 10");
  EXPECT_EQ(message_of("saturated: maybe\n"), "s.yaml:3:12: saturated: found 'maybe'; allowed: true, false");
  EXPECT_EQ(message_of("drainage: draind\n"),
            "s.yaml:3:11: drainage: found 'draind'; allowed: drained, undrained; did you mean 'drained'?");
  EXPECT_EQ(message_of("top: 3\n"), "s.yaml:3:6: layer: found '3'; expected a map of keys and values");
  EXPECT_EQ(message_of("layers: {}\n"),
            "s.yaml:3:9: layers: found a map; expected a list of sections, each beginning with a dash");
  EXPECT_EQ(message_of("named: [a]\n"), "s.yaml:3:8: named: found a list of 1; expected sections by name, NAME: {…}");
  EXPECT_EQ(message_of("top: {}\n"),
            "s.yaml:3:6: layer: the key 'thickness' is missing (number in m, above 0): Thickness.");
}

TEST(Schema, AllProblemsAreReportedInTheOrderOfTheirPlaces) {
  try {
    read("youngs_modulus: -2 MPa\ncolor: red\nlayers:\n  - {thickness: 0 m}\n");
    FAIL();
  } catch (const CaseError& error) {
    const std::string text = error.what();
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 3);
    const auto at = [&](const std::string& part) { return text.find(part); };
    EXPECT_EQ(at("s.yaml:1:1: soil: the key 'density' is missing (number in kg/m3, above 0): Mass per volume.\n"), 0u);
    EXPECT_LT(at("s.yaml:1:17: youngs_modulus is -2 MPa; it must be above 0\n"), at("s.yaml:2:1: unknown key 'color'"));
    EXPECT_LT(at("s.yaml:2:1: unknown key 'color'"), at("s.yaml:4:17: thickness is 0 m; it must be above 0"));
    EXPECT_NE(at("s.yaml:4:17: thickness is 0 m; it must be above 0"), std::string::npos);
  }
}

TEST(Schema, ResolvedSectionHasAllDefaultsAndReadsBack) {
  const Node section =
      read_yaml_text("{model: any, density: 1.8 t/m3, youngs_modulus: 2 MPa, friction_angle: 33 deg}", "s.yaml");
  const Node resolved = soil_schema().resolve(section, {"model"});
  EXPECT_EQ(resolved.keys[0].first, "model");
  EXPECT_EQ(resolved.find("density")->scalar, "1800 kg/m3");
  EXPECT_EQ(resolved.find("poisson_ratio")->scalar, "0.3");
  EXPECT_EQ(resolved.find("drainage")->scalar, "undrained");
  EXPECT_EQ(resolved.find("cutoff"), nullptr);
  const std::string text = yaml_text(resolved);
  EXPECT_EQ(yaml_text(soil_schema().resolve(read_yaml_text(text, "r.yaml"), {"model"})), text);
  EXPECT_EQ(read(text).angle, soil_schema().read(section, {"model"}).angle);
}

TEST(Schema, DocumentsItsKeys) {
  const auto docs = soil_schema().docs();
  EXPECT_EQ(docs[0].name, "density");
  EXPECT_EQ(docs[0].type, field_type::quantity);
  EXPECT_EQ(docs[0].unit, "kg/m3");
  EXPECT_EQ(docs[0].range, "above 0");
  EXPECT_TRUE(docs[0].required);
  EXPECT_EQ(docs[3].default_text, "0.3");
  EXPECT_EQ(docs[4].default_text, "the apex");
  EXPECT_EQ(docs[5].range, "4 or 6 components");
  EXPECT_EQ(docs[8].words, (std::vector<std::string>{"drained", "undrained"}));
  EXPECT_EQ(docs[11].nested.at(0).name, "thickness");
}

}  // namespace
}  // namespace sluice
