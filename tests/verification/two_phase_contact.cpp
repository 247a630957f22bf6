/// Friction of soil with water in its pores: between bodies that do not stick to each other, and on faces.

#include "core/simulation/physics_module.h"
#include "tests/verification/body_totals.h"
#include "tests/verification/resumed_run.h"
#include "tests/verification/scene_fixture.h"

namespace sluice {
namespace {

constexpr double g = 10, slope = 0.5;  // tan of the angle
constexpr double wet_density = 2000;   // grains of 2700 kg/m3 in a porosity of 7/17, with water of 1000 kg/m3

std::string soil(bool wet) {
  const double porosity = 7.0 / 17;
  return fmt::format("{{model: linear_elastic, density: {} kg/m3, youngs_modulus: 20 MPa, poisson_ratio: 0.2{}}}",
                     wet ? wet_density - 1000 * porosity : wet_density,
                     wet ? fmt::format(", water: {{porosity: {}, permeability: 1e-4 m/s}}", porosity) : "");
}

/// An endless layer of 1 m on an endless bench of 2 m, both full of water up to the surface, which flows along with
/// the slope. Gravity leans.
SceneText layers(const Scheme& scheme, double friction, bool layer_wet, bool bench_wet) {
  const double cosine = 1 / std::hypot(1.0, slope);
  return {.grid = "{min: [0 m, 0 m], max: [4 m, 5 m], cell: 0.25 m}",
          .material = soil(bench_wet) + "\n  layer: " + soil(layer_wet),
          .bodies =
              "  - {material: soil, box: {min: [0 m, 0 m], max: [4 m, 2 m]}}\n"
              "  - {material: layer, box: {min: [0 m, 2 m], max: [4 m, 3 m]}}",
          .gravity = fmt::format("[{} m/s2, {} m/s2]", g * slope * cosine, -g * cosine),
          .boundaries = "{left: periodic, right: periodic, bottom: fixed}",
          .initial_stress = "{method: elastic_equilibrium}",
          .scheme = scheme,
          .physics = "two_phase",
          .more = fmt::format("contact: {{materials: [layer], friction: {}}}\n"
                              "water: {{bulk_modulus: 2.2 GPa, initial: {{method: hydrostatic, level: {} m}}}}\n",
                              friction, layer_wet ? 3 : 2)};
}

/// Way of the layer in half a second [m].
double way(const SceneText& scene) {
  const auto simulation = simulate(scene);
  while (simulation->time() < 0.5) simulation->advance(0.5);
  return body_of(simulation->particles(), "layer").displacement(0);
}

constexpr double half_square = 0.5 * 0.25;

class WetLayer : public ::testing::TestWithParam<Scheme> {};

// The infinite slope with seepage along it: friction is that of the effective normal stress, (rho - rho_w) g cos H, and
// the layer slides with g (sin - mu (1 - rho_w / rho) cos) (Skempton & DeLory 1957). The tolerance is that of the dry
// block (body_contact.cpp), and a hundredth of what the pressure of the water makes.
TEST_P(WetLayer, SlidesWithTheFrictionOfEffectiveStress) {
  const double cosine = 1 / std::hypot(1.0, slope);
  for (const double friction : {0.3, 0.6}) {
    const double expected = g * cosine * (slope - friction * (1 - 1000 / wet_density)) * half_square;
    EXPECT_NEAR(way(layers(GetParam(), friction, true, true)), expected, 0.02 * expected) << friction;
  }
}

INSTANTIATE_TEST_SUITE_P(Schemes, WetLayer,
                         ::testing::Values(Scheme{"quadratic_bspline", "apic", "usl"},
                                           Scheme{"cubic_bspline", "flip", "usl"}, Scheme{"ugimp", "tpic", "usl"},
                                           Scheme{"quadratic_bspline", "xpic", "usl"}),
                         scheme_name);

/// Way of a wet layer of 1 m on a rough face in half a second [m].
double way_on_a_face(double cell, double friction) {
  SceneText scene = layers({}, 0, true, true);
  scene.grid = fmt::format("{{min: [0 m, 0 m], max: [4 m, 3 m], cell: {} m}}", cell);
  scene.bodies = "  - {material: layer, box: {min: [0 m, 0 m], max: [4 m, 1 m]}}";
  scene.boundaries =
      fmt::format("{{left: periodic, right: periodic, bottom: {{normal: contact, friction: {}}}}}", friction);
  scene.more = "water: {bulk_modulus: 2.2 GPa, initial: {method: hydrostatic, level: 1 m}}\n";
  return way(scene);
}

// The same on a face, in four and in eight cells: 1 % and half of it. (With all the force of the pressure at a node
// taken for what presses on the face, in place of eq. (49d), it was 4 and 2 %.)
TEST(WetLayerOnAFace, SlidesWithTheFrictionOfEffectiveStress) {
  const double expected = g / std::hypot(1.0, slope) * (slope - 0.3 * (1 - 1000 / wet_density)) * half_square;
  EXPECT_NEAR(way_on_a_face(0.25, 0.3), expected, 0.01 * expected);
  EXPECT_NEAR(way_on_a_face(0.125, 0.3), expected, 0.005 * expected);
}

// The negative control: the same weight without water, and the friction of all of it, holds.
TEST(DryLayer, IsHeldByTheSameFriction) { EXPECT_LT(std::abs(way(layers({}, 0.6, false, false))), 0.005); }

// A dry layer on a wet bench: the surface of the water lies in the joint, whose pressure is nought there, and friction
// is that of all the weight.
TEST(DryLayerOnAWetBench, SlidesWithAllFriction) {
  const double expected = g / std::hypot(1.0, slope) * (slope - 0.2) * half_square;
  EXPECT_NEAR(way(layers({}, 0.2, false, true)), expected, 0.02 * expected);
}

// Enough friction for the effective stress holds the wet layer, too.
TEST(WetLayers, AreHeldByEnoughFriction) { EXPECT_LT(std::abs(way(layers({}, 1.2, true, true))), 0.005); }

// Two wet discs graze each other: linear momentum is kept to round-off, whatever the pressures are.
TEST(WetDiscs, KeepMomentum) {
  const auto simulation = simulate(
      {.grid = "{min: [-5 m, -5 m], max: [5 m, 5 m], cell: 0.25 m}",
       .material = soil(true) + "\n  layer: " + soil(true),
       .bodies = "  - {material: soil, circle: {centre: [-1.5 m, 0.6 m], radius: 1 m}, velocity: [10, 0 m/s]}\n"
                 "  - {material: layer, circle: {centre: [1.5 m, -0.6 m], radius: 1 m}, velocity: [-10, 0 m/s]}",
       .physics = "two_phase",
       .more = "contact: {materials: [layer], friction: 0.5}\nwater: {bulk_modulus: 2.2 GPa}\n"});
  const Particles& particles = simulation->particles();
  const double momentum = body_of(particles, "soil").momentum[0];
  while (simulation->time() < 0.2) simulation->advance(0.2);
  EXPECT_LT(std::abs(total_momentum(particles, 0)), 1e-11 * momentum);
  EXPECT_LT(std::abs(total_momentum(particles, 1)), 1e-11 * momentum);
  EXPECT_LT(body_of(particles, "soil").velocity(0), 9);  // they have touched
}

// In space, on three threads and after a restart: the same bits.
TEST(WetLayersInSpace, SlideAndDoNotDependOnThreads) {
  const auto make = [] {
    SceneText scene = layers({}, 0.3, true, true);
    scene.grid = "{min: [0 m, 0 m, 0 m], max: [4 m, 2 m, 5 m], cell: 0.5 m}";
    scene.bodies =
        "  - {material: soil, box: {min: [0 m, 0 m, 0 m], max: [4 m, 2 m, 2 m]}}\n"
        "  - {material: layer, box: {min: [0 m, 0 m, 2 m], max: [4 m, 2 m, 3 m]}}";
    scene.gravity =
        fmt::format("[{0} m/s2, 0, {1} m/s2]", g * slope / std::hypot(1.0, slope), -g / std::hypot(1.0, slope));
    scene.boundaries = "{left: periodic, right: periodic, front: periodic, back: periodic, bottom: fixed}";
    return simulate(scene);
  };
  const auto reference = run_and_resume(make, 0.3, 29, {"position", "velocity", "stress", "pore_pressure"});
  const double expected = 0.5 * 0.09 * g / std::hypot(1.0, slope) * (slope - 0.3 * 0.5);
  EXPECT_NEAR(body_of(reference->particles(), "layer").displacement(0), expected, 0.03 * expected);
}

std::string refusal(const std::string& more, const std::string& boundaries = "{bottom: fixed}") {
  SceneText scene = layers({}, 0.3, true, true);
  scene.boundaries = boundaries;
  const std::string first = "water: {";
  scene.more.insert(scene.more.find(first) + first.size(), more);
  return refusal_of(scene);
}

TEST(WetContactRefused, SaysWhatAndWhere) {
  EXPECT_EQ(refusal(""), "");
  EXPECT_EQ(refusal("formulation: v-w-p, "),
            "scene.yaml:4:10: contact: it does not go with this `water.formulation`; take u-p");
  EXPECT_EQ(refusal("", "{bottom: fixed, left: {absorbing: {density: 2000 kg/m3, p_wave: 100 m/s, s_wave: 60 m/s}}}"),
            "scene.yaml:4:10: contact: it does not go with `absorbing` of boundaries.left where there is water; take a "
            "roller");
}

}  // namespace
}  // namespace sluice
