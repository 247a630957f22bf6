/// Layers, circles, and unions, intersections and differences of regions: membership, measure of what is filled, and
/// the messages about their keys.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "core/case/case.h"
#include "core/case/resolved_case.h"
#include "core/particles/fill.h"
#include "core/simulation/scene.h"

namespace sluice {
namespace {

constexpr double pi = std::numbers::pi;

/// A case with this grid cell and these bodies on [0, 4 m]^Dim.
std::string scene(int dimension, double cell, const std::string& bodies) {
  const std::string zeros = dimension == 2 ? "[0, 0, m]" : "[0, 0, 0, m]",
                    fours = dimension == 2 ? "[4, 4, m]" : "[4, 4, 4, m]";
  return "schema: 1\nphysics: total_stress\nend_time: 1 s\ngrid: {min: " + zeros + ", max: " + fours +
         ", cell: " + std::to_string(cell) +
         " m}\nmaterials:\n"
         "  clay: {model: linear_elastic, density: 1 kg/m3, youngs_modulus: 1 MPa}\n"
         "  sand: {model: linear_elastic, density: 1 kg/m3, youngs_modulus: 1 MPa}\n"
         "bodies:\n" +
         bodies;
}

template <int Dim>
Particles fill(double cell, const std::string& bodies) {
  const Case definition = parse_case(scene(Dim, cell, bodies), "regions.yaml");
  Particles particles(Dim);
  fill_bodies<Dim>(
      definition, grid_of<Dim>(definition.grid), [](int) { return 1.0; }, particles);
  return particles;
}

/// Area or volume of the particles.
template <int Dim>
double measure(double cell, const std::string& region) {
  const Particles particles = fill<Dim>(cell, "  - {material: clay, " + region + "}\n");
  double sum = 0;
  for (const double v : particles.columns.values(particles.volume)) sum += v;
  return sum;
}

/// A point of the lattice stands for the square (cube) of edge s around it. The squares of all points in a body lie
/// within half a diagonal d of it, and cover it but for such a margin: the error is at most what lies within d of its
/// surface, surface * d and, at edges and where it is curved, pieces of the size of d^2 (Gauss's circle problem).
template <int Dim>
void expect_measure(const std::string& region, double exact, double surface) {
  for (const double cell : {0.5, 0.25, 0.125}) {
    const double d = 0.5 * std::sqrt(Dim) * cell / 2;  // two points an axis
    EXPECT_NEAR(measure<Dim>(cell, region), exact, surface * d + surface * d * d) << region << ", cells of " << cell;
  }
}

const std::string disc = "circle: {centre: [2 m, 2 m], radius: 1.3 m}";
const std::string ball = "sphere: {centre: [2 m, 2 m, 2 m], radius: 1.3 m}";

TEST(Regions, FilledMeasureIsExactToFirstOrder) {
  const double r = 1.3;
  expect_measure<2>(disc, pi * r * r, 2 * pi * r);
  expect_measure<3>(ball, 4.0 / 3 * pi * r * r * r, 4 * pi * r * r);
  expect_measure<3>(disc + ", layer: {bottom: 0.5 m, top: 3 m}", 2.5 * pi * r * r, 2 * pi * r * (2.5 + r));
  expect_measure<2>("layer: {bottom: 0.33 m, top: 1.77 m}", 4 * 1.44, 8);
  expect_measure<3>("layer: {top: 1.77 m}", 16 * 1.77, 16);
  // A ring, and the spherical shell.
  expect_measure<2>("difference: [{" + disc + "}, {circle: {centre: [2 m, 2 m], radius: 0.7 m}}]", pi * (r * r - 0.49),
                    2 * pi * (r + 0.7));
  expect_measure<3>("difference: [{" + ball + "}, {sphere: {centre: [2 m, 2 m, 2 m], radius: 0.7 m}}]",
                    4.0 / 3 * pi * (r * r * r - 0.343), 4 * pi * (r * r + 0.49));
  // The lower half, as an intersection within a section and as one of regions.
  expect_measure<2>(disc + ", layer: {top: 2 m}", pi * r * r / 2, (pi + 2) * r);
  expect_measure<2>("intersection: [{" + disc + "}, {layer: {top: 2 m}}]", pi * r * r / 2, (pi + 2) * r);
  // Two discs that meet in a lens of area r^2 (2 a - sin 2a), cos a = half the distance / r.
  const double a = std::acos(0.5 / r), lens = r * r * (2 * a - std::sin(2 * a));
  const std::string two =
      "[{circle: {centre: [1.5 m, 2 m], radius: 1.3 m}}, {circle: {centre: [2.5 m, 2 m], radius: "
      "1.3 m}}]";
  expect_measure<2>("union: " + two, 2 * pi * r * r - lens, 4 * pi * r - 4 * a * r);
  expect_measure<2>("intersection: " + two, lens, 4 * a * r);
}

// Nested three deep: a box less the union of a disc and the part of a layer right of x = 3.
TEST(Regions, Nest) {
  expect_measure<2>("difference: [{box: {min: [0 m, 0 m], max: [4 m, 4 m]}}, {union: [{" + disc +
                        "}, {intersection: [{layer: {bottom: 1 m, top: 2 m}}, {half_space: {point: [3.5 m, 0 m], "
                        "normal: [-1, 0]}}]}]}]",
                    16 - pi * 1.69 - 0.5, 16 + 2 * pi * 1.3 + 3);
}

// Bodies that are cut out of each other tile the grid: every point of the lattice is taken once, none twice. The
// surfaces of layers and boxes run through points of the lattice here, at multiples of an eighth less a sixteenth.
TEST(Regions, DifferencesTileWithoutGapsAndOverlaps) {
  const std::string bodies =
      "  - {material: clay, layer: {top: 1.0625 m}}\n"
      "  - {material: sand, layer: {bottom: 1.0625 m, top: 2.9375 m}, difference: [{layer: {bottom: 0 m}}, {" +
      disc +
      "}]}\n"
      "  - {material: clay, " +
      disc +
      ", layer: {bottom: 1.0625 m, top: 2.9375 m}}\n"
      "  - {material: sand, layer: {bottom: 2.9375 m}}\n";
  EXPECT_EQ(fill<2>(0.25, bodies).size(), 32u * 32u);
}

// Tolerance: none. The region and the difference from it share out every point, those on surfaces too.
TEST(Regions, WhatIsCutOutAndWhatIsLeftMakeTheWhole) {
  const Region whole{{Box{{0, 0}, {4, 4}}}};
  const std::vector<Region> cuts = {{{Circle{{{2, 2}, 1.5}}}},
                                    {{Layer{1, 3}}},
                                    {{Polygon{{{0.5, 0.5}, {3.5, 0.5}, {2, 3.5}}}}},
                                    {{Union{{{{Circle{{{1, 1}, 1}}}}, {{Layer{2.5, std::nullopt}}}}}}}};
  std::mt19937 random(11);
  std::uniform_int_distribution<int> eighth(0, 31);
  for (const Region& cut : cuts) {
    const Region rest{{Difference{{whole, cut}}}}, both{{Intersection{{whole, cut}}}};
    for (int i = 0; i < 2000; ++i) {
      const std::vector<double> x{eighth(random) / 8.0, eighth(random) / 8.0};
      EXPECT_EQ(rest.contains(x) + both.contains(x), 1);
    }
  }
}

TEST(Regions, DistancesAndBounds) {
  const Region a{{Box{{0, 0}, {1, 1}}}}, b{{Box{{3, 0}, {4, 2}}}};
  const Region either{{Union{{a, b}}}}, none{{Intersection{{a, b}}}};
  const Region hole{{Difference{{b, Region{{Circle{{{3.5, 1}, 0.25}}}}}}}};
  EXPECT_DOUBLE_EQ(either.distance_outside(std::vector{1.5, 0.5}), 0.5);
  EXPECT_DOUBLE_EQ(either.distance_outside(std::vector{3.5, 0.5}), 0);
  EXPECT_DOUBLE_EQ(none.distance_outside(std::vector{0.5, 0.5}), 2.5);
  EXPECT_DOUBLE_EQ(hole.distance_outside(std::vector{3.5, 1.0}), 0.25);
  EXPECT_DOUBLE_EQ(hole.distance_to_surface(std::vector{3.5, 0.5}), 0.25);
  EXPECT_EQ(either.bounds(2)[0], (std::vector<double>{0, 0}));
  EXPECT_EQ(either.bounds(2)[1], (std::vector<double>{4, 2}));
  EXPECT_EQ(hole.bounds(2)[0], (std::vector<double>{3, 0}));
  EXPECT_EQ((Region{{Layer{1, std::nullopt}}}.bounds(3)[0][2]), 1);
  EXPECT_TRUE(std::isinf(Region{{Layer{1, std::nullopt}}}.bounds(3)[1][2]));
}

TEST(Regions, ResolvedCaseReadsBack) {
  const std::string bodies =
      "  - {material: clay, difference: [{circle: {centre: [2 m, 2 m], radius: 1 m}}, {union: [{layer: {bottom: 2 "
      "m}}, {box: {min: [0, 0, m], max: [2, 1, m]}, half_space: {point: [1 m, 1 m], normal: [1, 1]}}]}]}\n"
      "  - {material: sand, layer: {top: 1 m}, intersection: [{polygon: [[0 m, 0 m], [1 m, 0 m], [1 m, 2 m]]}]}\n";
  const std::string text = resolved_yaml(parse_case(scene(2, 0.5, bodies), "a.yaml"));
  EXPECT_EQ(resolved_yaml(parse_case(text, "b.yaml")), text);
  for (const char* word : {"circle:", "union:", "layer:", "difference:", "intersection:"})
    EXPECT_NE(text.find(word), std::string::npos) << word;
}

std::string error_of(int dimension, const std::string& body) {
  try {
    parse_case(scene(dimension, 0.5, "  - {material: clay, " + body + "}\n"), "c.yaml");
  } catch (const CaseError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Regions, MessagesNamePlaceAndWhatIsAllowed) {
  EXPECT_NE(error_of(2, "diference: []").find("c.yaml:9:22: unknown key 'diference' in body"), std::string::npos);
  EXPECT_NE(error_of(2, "diference: []").find("did you mean 'difference'?"), std::string::npos);
  EXPECT_NE(error_of(2, "difference: [{layer: {top: 1 m}}]")
                .find("c.yaml:9:34: difference: found a list of 1; expected a list of two regions or more, the first "
                      "less the others, each beginning with a dash"),
            std::string::npos);
  EXPECT_NE(error_of(2, "union: {layer: {top: 1 m}}")
                .find("c.yaml:9:29: union: found a map; expected a list of regions, each beginning with a dash"),
            std::string::npos);
  EXPECT_NE(error_of(2, "union: [{}]").find("c.yaml:9:30: region in the union: it has no shape; give one or more of"),
            std::string::npos);
  EXPECT_NE(error_of(2, "union: [{ball: 1}]").find("unknown key 'ball' in region; allowed: box, polygon"),
            std::string::npos);
  EXPECT_NE(error_of(2, "layer: {}").find("c.yaml:9:29: layer: it has neither bottom nor top; give one or both"),
            std::string::npos);
  EXPECT_NE(error_of(2, "layer: {bottom: 2 m, top: 1 m}").find("layer: top is 1 m; it must be above bottom, 2 m"),
            std::string::npos);
  EXPECT_NE(error_of(3, "circle: {centre: [2 m, 2 m, 2 m], radius: 1 m}").find("c.yaml:9:39: centre"),
            std::string::npos);
  EXPECT_NE(error_of(2, "circle: {centre: [2 m, 2 m, 2 m], radius: 1 m}").find("c.yaml:9:39: centre"),
            std::string::npos);
  EXPECT_NE(error_of(2, "union: [{box: {min: [0, 0, 0, m], max: [1, 1, 1, m]}}]")
                .find("box: found 3 components; the grid has 2 dimensions"),
            std::string::npos);
  EXPECT_NE(error_of(2, "below_raster: hills.asc").find("below_raster: there is no file 'hills.asc'"),
            std::string::npos);
}

}  // namespace
}  // namespace sluice
