/// The resolved case reads back as the same case; the reference names every key.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/case/case_schema.h"
#include "core/case/reference.h"
#include "core/case/resolved_case.h"

namespace sluice {
namespace {

const char* const full = R"(
schema: 1
title: "A case: with everything"
physics: total_stress
grid: {min: [-0.1 m, 0 m], max: [10 m, 5 m], cell: 0.1 m}
gravity: [1 m/s2, -9.81 m/s2]
materials:
  soil: {model: linear_elastic, density: 1.8 t/m3, youngs_modulus: 2 MPa}
  clay: {model: linear_elastic, density: 2 t/m3, youngs_modulus: 3 MPa, poisson_ratio: 0.1}
bodies:
  - {material: soil, box: {min: [1 m, 0 m], max: [4 m, 3 m]}, half_space: {point: [0, 2 m], normal: [0.3, 1]}}
  - material: clay
    polygon: [[1 m, 0.1 m], [3 m, 0 m], [3.3333333333333333 m, 2 m], [1 m, 20 cm]]
    replaces: soil
    particles_per_cell: 9
    velocity: [1, 2, cm/s]
  - {material: clay, half_space: [{point: [9 m, 0], normal: [-1, 0]}, {point: [0, 2 m], normal: [0, 1]}]}
boundaries: {left: roller, right: fixed, bottom: {normal: fixed, friction: 0.4}}
initial_stress: {method: uniform, stress: [1 kPa, 2 kPa, 3 kPa, 0]}
scheme: {shape: linear, transfer: flip, flip_fraction: 0.97, stress_update: musl, f_bar: true, courant: 0.3}
outflow: remove
end_time: 2 min
observe:
  runout: {measure: front, direction: [-1, 2]}
  crest: {measure: mean_displacement, direction: [1, 3], region: {polygon: [[0, 0], [1, 0], [1, 1]]}}
output: {every: 1 s, pictures: [material], picture_times: [1 s, 100 s]}
)";

void expect_equal(const Region& a, const Region& b) {
  ASSERT_EQ(a.parts.size(), b.parts.size());
  for (std::size_t i = 0; i < a.parts.size(); ++i) {
    ASSERT_EQ(a.parts[i].index(), b.parts[i].index());
    if (const auto* const box = std::get_if<Box>(&a.parts[i])) {
      EXPECT_EQ(box->min, std::get<Box>(b.parts[i]).min);
      EXPECT_EQ(box->max, std::get<Box>(b.parts[i]).max);
    } else if (const auto* const polygon = std::get_if<Polygon>(&a.parts[i])) {
      EXPECT_EQ(polygon->vertices, std::get<Polygon>(b.parts[i]).vertices);
    } else {
      EXPECT_EQ(std::get<HalfSpace>(a.parts[i]).point, std::get<HalfSpace>(b.parts[i]).point);
      EXPECT_EQ(std::get<HalfSpace>(a.parts[i]).normal, std::get<HalfSpace>(b.parts[i]).normal);
    }
  }
}

TEST(ResolvedCase, ReadsBackAsTheSameCase) {
  const Case a = parse_case(full, "a.yaml");
  const std::string text = resolved_yaml(a);
  const Case b = parse_case(text, "b.yaml");
  EXPECT_EQ(resolved_yaml(b), text);

  EXPECT_EQ(a.title, b.title);
  EXPECT_EQ(a.grid.min, b.grid.min);
  EXPECT_EQ(a.grid.cell, b.grid.cell);
  EXPECT_EQ(a.gravity, b.gravity);
  EXPECT_EQ(a.end_time, b.end_time);
  EXPECT_EQ(a.outflow, b.outflow);
  ASSERT_EQ(a.bodies.size(), b.bodies.size());
  for (std::size_t i = 0; i < a.bodies.size(); ++i) {
    EXPECT_EQ(a.bodies[i].material, b.bodies[i].material);
    EXPECT_EQ(a.bodies[i].velocity, b.bodies[i].velocity);
    EXPECT_EQ(a.bodies[i].replaces, b.bodies[i].replaces);
    EXPECT_EQ(a.bodies[i].particles_per_cell, b.bodies[i].particles_per_cell);
    expect_equal(a.bodies[i].region, b.bodies[i].region);
  }
  ASSERT_EQ(a.faces.size(), b.faces.size());
  for (const auto& [name, face] : a.faces) {
    EXPECT_EQ(face.normal, b.faces.at(name).normal) << name;
    EXPECT_EQ(face.tangential, b.faces.at(name).tangential) << name;
    EXPECT_EQ(face.friction, b.faces.at(name).friction) << name;
  }
  EXPECT_EQ(a.scheme.flip_fraction, b.scheme.flip_fraction);
  EXPECT_EQ(a.scheme.stress_update, b.scheme.stress_update);
  EXPECT_EQ(a.scheme.fixed_time_step, b.scheme.fixed_time_step);
  EXPECT_EQ(a.scheme.courant, b.scheme.courant);
  ASSERT_EQ(a.observe.size(), b.observe.size());
  for (std::size_t i = 0; i < a.observe.size(); ++i) {
    EXPECT_EQ(a.observe[i].name, b.observe[i].name);
    EXPECT_EQ(a.observe[i].direction, b.observe[i].direction);
    ASSERT_EQ(a.observe[i].region.has_value(), b.observe[i].region.has_value());
    if (a.observe[i].region) expect_equal(*a.observe[i].region, *b.observe[i].region);
  }
  EXPECT_EQ(a.output.picture_times, b.output.picture_times);
  EXPECT_EQ(b.initial_stress.find("stress")->items[1].scalar, "2 kPa");
}

TEST(ResolvedCase, SectionsOfTheModuleTakeThePlaceOfThoseOfTheCase) {
  const Case a = parse_case(full, "a.yaml");
  Node stress = Node::map();
  stress.set("method", Node::text("none"));
  const std::string text = resolved_yaml(a, {{"initial_stress", stress}});
  EXPECT_EQ(parse_case(text, "b.yaml").initial_stress.find("method")->scalar, "none");
}

TEST(Reference, NamesEveryKeyWithItsUnitAndSentence) {
  const std::string text = case_reference_markdown();
  const std::function<void(const std::vector<FieldDoc>&)> check = [&](const std::vector<FieldDoc>& docs) {
    for (const FieldDoc& doc : docs) {
      EXPECT_NE(text.find("| `" + doc.name + "` |"), std::string::npos) << doc.name;
      EXPECT_NE(text.find(doc.sentence), std::string::npos) << doc.name;
      EXPECT_FALSE(doc.sentence.empty()) << doc.name;
      EXPECT_TRUE(doc.required || !doc.default_text.empty()) << doc.name;
      check(doc.nested);
    }
  };
  check(case_schema().docs());
}

TEST(Reference, JsonSchemaKnowsTheKeys) {
  const auto schema = nlohmann::json::parse(case_json_schema());
  EXPECT_EQ(schema["$schema"], "http://json-schema.org/draft-07/schema#");
  EXPECT_EQ(schema["additionalProperties"], false);
  for (const FieldDoc& doc : case_schema().docs()) EXPECT_TRUE(schema["properties"].contains(doc.name)) << doc.name;
  EXPECT_EQ(schema["properties"]["outflow"]["enum"], (std::vector<std::string>{"error", "remove", "clamp"}));
  EXPECT_TRUE(schema["properties"]["bodies"]["items"]["properties"].contains("half_space"));
}

}  // namespace
}  // namespace sluice
