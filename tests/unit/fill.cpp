/// Filling bodies with material points: the lattice, shared edges, overlaps, replacement.
#include "core/particles/fill.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>

#include "core/simulation/scene.h"

namespace sluice {
namespace {

std::string scene(int dimension, const std::string& bodies) {
  const std::string size = dimension == 2 ? "{min: [0 m, 0 m], max: [4 m, 2 m], cell: [1 m, 0.5 m]}"
                                          : "{min: [0 m, 0 m, 0 m], max: [4 m, 2 m, 3 m], cell: [1 m, 0.5 m, 1.5 m]}";
  return "schema: 1\nphysics: total_stress\nend_time: 1 s\ngrid: " + size +
         "\nmaterials:\n"
         "  clay: {model: linear_elastic, density: 2 t/m3, youngs_modulus: 1 MPa}\n"
         "  sand: {model: linear_elastic, density: 1 t/m3, youngs_modulus: 1 MPa}\n"
         "bodies:\n" +
         bodies;
}

template <int Dim>
Particles fill(const std::string& bodies) {
  const Case definition = parse_case(scene(Dim, bodies), "fill.yaml");
  Particles particles(Dim);
  fill_bodies<Dim>(
      definition, grid_of<Dim>(definition.grid), [](int material) { return material == 0 ? 2000.0 : 1000.0; },
      particles);
  return particles;
}

std::ptrdiff_t count(const Particles& particles, const std::string& material) {
  const auto names = particles.material_names;
  const auto index = static_cast<std::int32_t>(std::find(names.begin(), names.end(), material) - names.begin());
  return std::count(particles.material.begin(), particles.material.end(), index);
}

template <int Dim>
std::string error_of(const std::string& bodies) {
  try {
    fill<Dim>(bodies);
  } catch (const CaseError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Fill, LatticeOfABox) {
  const Particles particles = fill<2>("  - {material: clay, box: {min: [1 m, 0 m], max: [3 m, 1 m]}}\n");
  ASSERT_EQ(particles.size(), 2u * 2u * 4u);
  EXPECT_EQ(particles.columns.data(particles.position, 0)[0], 1.25);
  EXPECT_EQ(particles.columns.data(particles.position, 1)[0], 0.125);
  std::set<std::int32_t> ids;
  for (std::size_t p = 0; p < particles.size(); ++p) {
    ids.insert(particles.id[p]);
    EXPECT_DOUBLE_EQ(particles.columns.data(particles.volume)[p], 1 * 0.5 / 4);
    EXPECT_DOUBLE_EQ(particles.columns.data(particles.mass)[p], 2000 * 1 * 0.5 / 4);
    for (int a = 0; a < 2; ++a)
      EXPECT_EQ(particles.columns.data(particles.position, a)[p],
                particles.columns.data(particles.initial_position, a)[p]);
  }
  EXPECT_EQ(ids.size(), particles.size());
}

TEST(Fill, PointsPerCellAndVelocity) {
  EXPECT_EQ(fill<2>("  - {material: clay, particles_per_cell: 9, box: {min: [0 m, 0 m], max: [4 m, 2 m]}}\n").size(),
            4u * 4u * 9u);
  EXPECT_EQ(fill<2>("  - {material: clay, particles_per_cell: 1, box: {min: [0 m, 0 m], max: [4 m, 2 m]}}\n").size(),
            16u);
  const Particles solid = fill<3>(
      "  - {material: clay, box: {min: [0 m, 0 m, 0 m], max: [4 m, 2 m, 3 m]}, velocity: [1 m/s, 2 m/s, 3 m/s]}\n");
  ASSERT_EQ(solid.size(), 4u * 4u * 2u * 8u);
  EXPECT_DOUBLE_EQ(solid.columns.data(solid.mass)[7], 2000 * 1 * 0.5 * 1.5 / 8);
  for (int a = 0; a < 3; ++a) EXPECT_EQ(solid.columns.data(solid.velocity, a)[100], a + 1);
}

// The volume of a triangle to half a row of points: 4 * 2 / 2 = 4 m2 at 1/8 m2 a point.
TEST(Fill, TriangleHasItsArea) {
  const Particles particles = fill<2>("  - {material: clay, polygon: [[0 m, 0 m], [4 m, 0 m], [0 m, 2 m]]}\n");
  EXPECT_NEAR(static_cast<double>(particles.size()) / 8, 4, 0.5);
}

TEST(Fill, HalfSpaceEndsAtTheGrid) {
  EXPECT_EQ(fill<2>("  - {material: clay, half_space: {point: [0 m, 1 m], normal: [0, 1]}}\n").size(), 4u * 2u * 4u);
}

// Neighbours share an edge and leave no gap: every point of the lattice belongs to exactly one of them.
TEST(Fill, NeighboursShareNoPoint) {
  const Particles particles = fill<2>(
      "  - {material: clay, polygon: [[0 m, 0 m], [4 m, 0 m], [0 m, 2 m]]}\n"
      "  - {material: sand, polygon: [[4 m, 0 m], [4 m, 2 m], [0 m, 2 m]]}\n");
  EXPECT_EQ(particles.size(), 4u * 4u * 4u);
  EXPECT_EQ(count(particles, "clay") + count(particles, "sand"), 64);
}

TEST(Fill, ReplacesTakesPointsFromEarlierBodies) {
  const Particles particles = fill<2>(
      "  - {material: clay, box: {min: [0 m, 0 m], max: [4 m, 2 m]}}\n"
      "  - {material: sand, box: {min: [1 m, 0 m], max: [2 m, 1 m]}, replaces: clay}\n");
  EXPECT_EQ(particles.size(), 64u);
  EXPECT_EQ(count(particles, "sand"), 8);
  for (std::size_t p = 0; p < particles.size(); ++p)
    EXPECT_DOUBLE_EQ(particles.columns.data(particles.mass)[p], (particles.material[p] == 0 ? 2000 : 1000) * 0.125);
}

TEST(Fill, OverlapSaysWhereAndWhatToWrite) {
  const std::string message = error_of<2>(
      "  - {material: clay, box: {min: [0 m, 0 m], max: [3 m, 2 m]}}\n"
      "  - {material: sand, box: {min: [2 m, 0 m], max: [4 m, 1 m]}}\n");
  for (const char* word :
       {"fill.yaml:10", "overlap", "(2.25, 0.125) m", "'sand'", "'clay'", "fill.yaml:9", "replaces: clay"})
    EXPECT_NE(message.find(word), std::string::npos) << word << " in: " << message;
}

TEST(Fill, ABodyBetweenThePointsIsAnError) {
  const std::string message = error_of<2>("  - {material: clay, box: {min: [0.3 m, 0 m], max: [0.4 m, 2 m]}}\n");
  for (const char* word : {"fill.yaml:9", "'clay'", "no material points"})
    EXPECT_NE(message.find(word), std::string::npos) << word << " in: " << message;
}

}  // namespace
}  // namespace sluice
