/// Pressure from outside: the field, and the forces that it makes on the nodes with and without water in the pores.
#include "physics/loads/external_pressure.h"

#include <gtest/gtest.h>

#include <random>

#include "core/particles/fill.h"
#include "core/simulation/stages.h"
#include "physics/two_phase/pore_water.h"

namespace sluice {
namespace {

constexpr double weight = 9810;  // of water [N/m3]

GridGeometry<2> grid() {
  GridGeometry<2> g;
  g.max = {10, 10};
  g.cell = {0.5, 0.5};
  g.cells = {20, 20};
  return g;
}

ExternalPressure<2> loads(std::vector<SurfaceLoad> loads) { return {std::move(loads), {}, weight, grid()}; }
ExternalPressure<2> ponds(std::vector<Pond> ponds) { return {{}, std::move(ponds), weight, grid()}; }

Region box(double x0, double z0, double x1, double z1) { return {{Box{{x0, z0}, {x1, z1}}}}; }

TEST(ExternalPressure, IsNoneWithoutLoadsAndPonds) {
  EXPECT_FALSE(loads({}).any());
  EXPECT_EQ(loads({}).at({1, 2}, 3), 0);
}

TEST(ExternalPressure, OfALoadFollowsItsTable) {
  const auto field = loads({{Table{{0, 2}, {0, 10}}, {}, 0}});
  EXPECT_TRUE(field.any());
  EXPECT_EQ(field.at({5, 5}, 1), 5);
  EXPECT_EQ(field.at({1, 9}, 7), 10);
  EXPECT_EQ(field.of_ponds({1, 9}, 7), 0);  // there is no water in it
}

TEST(ExternalPressure, OfLoadsAndPondsAddsUp) {
  const ExternalPressure<2> field({{Table::constant(10), {}, 0}, {Table::constant(5), box(0, 0, 4, 10), 0}},
                                  {{Table::constant(6), {}, 0}}, weight, grid());
  EXPECT_DOUBLE_EQ(field.at({2, 5}, 0), 15 + weight);
  EXPECT_DOUBLE_EQ(field.at({6, 5}, 0), 10 + weight);
  EXPECT_DOUBLE_EQ(field.of_ponds({2, 5}, 0), weight);
}

TEST(ExternalPressure, FadesLinearlyOutsideOfTheRegion) {
  const auto field = loads({{Table::constant(100), box(2, 2, 6, 6), 2}});
  EXPECT_EQ(field.at({4, 4}, 0), 100);
  EXPECT_DOUBLE_EQ(field.at({7, 4}, 0), 50);
  EXPECT_DOUBLE_EQ(field.at({4, 0.5}, 0), 25);
  EXPECT_DOUBLE_EQ(field.at({6.6, 6.8}, 0), 50);  // 1 m from the corner
  EXPECT_EQ(field.at({8.5, 4}, 0), 0);
}

// Outside of an intersection what counts are the parts that do not hold the point, not the surface of one that does.
TEST(ExternalPressure, FadesOutsideOfAnIntersection) {
  const Region slab{{Box{{2, 2}, {6, 6}}, HalfSpace{{0, 4}, {0, 1}}}};
  const auto field = loads({{Table::constant(100), slab, 2}});
  EXPECT_DOUBLE_EQ(field.at({7, 3.9}, 0), 50);
  EXPECT_DOUBLE_EQ(field.at({4, 5.5}, 0), 25);
  EXPECT_EQ(field.at({8.5, 4}, 0), 0);
}

TEST(ExternalPressure, OfAPondIsHydrostaticBelowItsLevelAndNothingAbove) {
  const auto field = ponds({{Table{{0, 10}, {4, 8}}, {}, 0}});
  EXPECT_DOUBLE_EQ(field.at({1, 3}, 0), weight);
  EXPECT_DOUBLE_EQ(field.of_ponds({1, 3}, 5), 3 * weight);
  EXPECT_EQ(field.at({1, 4.5}, 0), 0);
}

// Particles find the pressure between the vertices: there it is exact at the vertices, and everywhere where the field
// is linear in each cell. Tolerance: round-off of 1e5 Pa over cells of 0.5 m.
TEST(ExternalPressure, IsLoadedAtTheVerticesAroundABlock) {
  const auto field = ponds({{Table::constant(9.5), {}, 0}});
  const GridGeometry<2> g = grid();
  for (const Index<2> first_cell : {Index<2>{0, 0}, Index<2>{8, 16}}) {
    VertexTile<2> tile;
    field.load(first_cell, 0, tile);
    std::mt19937 generator(7);
    std::uniform_real_distribution<double> uniform(-1, block_width<2> + 1);
    std::vector<double> x(200), z(200), value(200), slope_x(200), slope_z(200);
    for (std::size_t p = 0; p < x.size(); ++p) {
      x[p] = std::clamp(0.5 * (first_cell[0] + uniform(generator)), 0.0, 10.0);
      z[p] = std::clamp(0.5 * (first_cell[1] + uniform(generator)), 0.0, 10.0);
    }
    interpolate<2>(tile, {&g, first_cell, 0, 200, {x.data(), z.data()}},
                   {value.data(), {slope_x.data(), slope_z.data()}});
    for (std::size_t p = 0; p < x.size(); ++p) {
      ASSERT_NEAR(value[p], field.at({x[p], z[p]}, 0), 1e-9) << x[p] << ", " << z[p];
      ASSERT_NEAR(slope_x[p], 0, 1e-9);
      ASSERT_NEAR(slope_z[p], z[p] < 9.5 ? -weight : 0, 1e-9) << x[p] << ", " << z[p];
    }
  }
}

// ---- forces on the nodes ----

/// A block of saturated soil in the middle of a grid, with what PoreWater adds to its particles.
struct Block {
  Case definition;
  WaterCase water;
  Materials<2> materials;
  PoreWater<2> pores;
  Scene<2> scene;

  static std::string text(const std::string& more) {
    return "schema: 1\nphysics: two_phase\nend_time: 1 s\n"
           "grid: {min: [0 m, 0 m], max: [10 m, 10 m], cell: 0.5 m}\ngravity: [0, -9.81 m/s2]\n"
           "materials: {soil: {model: linear_elastic, density: 1600 kg/m3, youngs_modulus: 1 MPa,\n"
           "                   water: {porosity: 0.4, permeability: 1e-4 m/s}}}\n"
           "bodies: [{material: soil, box: {min: [3 m, 3 m], max: [7.3 m, 6.1 m]}}]\n" +
           more;
  }

  explicit Block(const std::string& more)
      : definition(parse_case(text(more), "block.yaml")),
        water(read_water(definition)),
        materials(without_pores(definition)),
        pores(water, read_pore_spaces(definition, water, {false}), materials),
        scene(definition) {
    pores.declare(scene.particles, true);
    fill_bodies<2>(
        definition, scene.grid, [](int) { return 1600.0; }, scene.particles);
    pores.fill(scene);
    pores.set_initial_pressure(scene);
    activate_blocks(scene);
  }

  /// Calls visit(force, mass) for each node.
  template <class Visit>
  void forces(const ExternalPressure<2>& outside, const Visit& visit) {
    scatter(scene, ScatterWhat::momentum);
    for (std::size_t b = 0; b < scene.blocks.particle_blocks().size(); ++b)
      pores.scatter_forces(scene, b, scene.blocks.particle_blocks()[b], outside, ScatterWhat::force);
    for (std::size_t b = 0; b < scene.blocks.node_blocks().size(); ++b) {
      scene.nodes.collect_momentum(scene.blocks, b);
      scene.nodes.collect_force(scene.blocks, b);
      for (std::size_t n = 0; n < static_cast<std::size_t>(block_nodes<2>); ++n) {
        const Lane force = scene.nodes.force(b)[n], mass = scene.nodes.momentum(b)[n];
        visit(Vector<2>{force[1], force[2]}, mass[0]);
      }
    }
  }
};

// An identity: tolerance round-off of forces of the order of pressure times h, 5e3 N.
TEST(ExternalPressure, OfTheSameSizeAsThePorePressureMovesNothing) {
  Block block("water: {initial: {method: uniform, pressure: 10 kPa}}\n");
  const ExternalPressure<2> outside({{Table::constant(10e3), {}, 0}}, {}, weight, grid());
  block.forces(outside, [](const Vector<2>& force, double) {
    EXPECT_NEAR(force[0], 0, 1e-8);
    EXPECT_NEAR(force[1], 0, 1e-8);
  });
}

// A negative control of the above: without the pressure from outside the surface is pushed outwards.
TEST(ExternalPressure, IsMissedWhereItIsLeftOut) {
  Block block("water: {initial: {method: uniform, pressure: 10 kPa}}\n");
  double largest = 0;
  block.forces(loads({}), [&](const Vector<2>& force, double) { largest = std::max(largest, std::abs(force[0])); });
  EXPECT_GT(largest, 1e3);
}

// Archimedes: the water around the block carries the weight of as much water as the block displaces; on each node the
// share of the particles there, so that no part of the block is strained by it when its pores are in equilibrium.
TEST(ExternalPressure, OfAPondBuoysASubmergedBlock) {
  Block block("water: {initial: {method: hydrostatic, level: 9 m}}\n");
  const double saturated = 1600 + 0.4 * 1000;
  double buoyancy = 0, displaced = 0;
  block.forces(ponds({{Table::constant(9), {}, 0}}), [&](const Vector<2>& force, double mass) {
    EXPECT_NEAR(force[0], 0, 1e-7);
    EXPECT_NEAR(force[1], weight * mass / saturated, 1e-6 * weight);
    buoyancy += force[1];
    displaced += mass / saturated;
  });
  EXPECT_NEAR(displaced, 4.25 * 3, 1e-9);  // the lattice within 4.3 m by 3.1 m
  EXPECT_NEAR(buoyancy, weight * displaced, 1e-6 * weight);
}

// The same whatever pressure the pores have: the resultant of what acts on the surface is that of the outside alone.
TEST(ExternalPressure, HasTheResultantOfTheDisplacedWaterWhateverIsInThePores) {
  Block block("");
  Vector<2> resultant{};
  block.forces(ponds({{Table::constant(9), {}, 0}}), [&](const Vector<2>& force, double) {
    resultant[0] += force[0];
    resultant[1] += force[1];
  });
  EXPECT_NEAR(resultant[0], 0, 1e-6 * weight);
  EXPECT_NEAR(resultant[1], weight * 4.25 * 3, 1e-6 * weight);
}

}  // namespace
}  // namespace sluice
