/// F15: particles exactly on cell edges, corners and the boundary of the domain. Source: half-open cells [x_i,
/// x_{i+1}); a stress-free body in uniform motion keeps its velocity and stays free of stress wherever its particles
/// stand.
#include "core/simulation/stages.h"
#include "tests/verification/moving_block.h"

namespace sluice {
namespace {

/// Tolerances: round-off, 1e-9 of the modulus and of the velocity; 1e-6 with linear functions, whose nodes may hold
/// any small share of a particle. A velocity missing on one node would strain its particles by dt v / h, 0.05 here.
void expect_undisturbed(const Simulation& simulation, double mass, double velocity, const Scheme& scheme) {
  const double tolerance = scheme.linear() ? 1e-6 : 1e-9;
  const Particles& particles = simulation.particles();
  EXPECT_LT(largest_stress(particles), tolerance * soft_modulus);
  EXPECT_DOUBLE_EQ(sum(by_id(particles, "mass")), mass);
  for (int a = 0; a < particles.dimension; ++a) {
    EXPECT_NEAR(total_momentum(particles, a), mass * velocity, 1e-12 * std::abs(mass * velocity));
    for (const double v : by_id(particles, "velocity", a)) EXPECT_NEAR(v, velocity, tolerance * std::abs(velocity));
  }
}

class CellEdges : public ::testing::TestWithParam<Scheme> {};

// Steps of exactly a twentieth of a cell: in the first and in the last of 21, the points stand on edges and corners,
// among them the last row and column, behind which the next nodes are empty.
TEST_P(CellEdges, MotionFromEdgeToEdge) {
  for (const int dimension : {2, 3})
    for (const double velocity : {1.0, -1.0}) {
      const auto simulation = moving_block(dimension, GetParam().with("time_step: 50 ms"), 5, velocity);
      const double mass = sum(by_id(simulation->particles(), "mass"));
      take_steps(*simulation, 22);
      SCOPED_TRACE(fmt::format("{}-D, {} m/s", dimension, velocity));
      expect_undisturbed(*simulation, mass, velocity, GetParam());
    }
}

// A hair below or above an edge is as good as on it: 1e-18 vanishes in round-off, 1e-15, 1e-13 and 1e-11 do not.
TEST_P(CellEdges, AHairFromTheEdge) {
  for (const double hair : {1e-18, 1e-15, 1e-13, 1e-11})
    for (const double side : {-1, 1}) {
      const auto simulation = moving_block(2, GetParam().with("time_step: 50 ms"), 5 + side * hair, 1);
      const double mass = sum(by_id(simulation->particles(), "mass"));
      take_steps(*simulation, 1);
      SCOPED_TRACE(fmt::format("{} from the edge", side * hair));
      expect_undisturbed(*simulation, mass, 1, GetParam());
    }
}

// On the boundary of the domain itself, 1e-18 outside of it, and leaving it. Outside by round-off is no outflow. CPDI
// sums over corners, whose round-off is some times larger.
TEST_P(CellEdges, OnTheBoundaryOfTheDomain) {
  for (const int dimension : {2, 3})
    for (const double corner : {0.0, -1e-18}) {
      const auto simulation = moving_block(dimension, GetParam().with("time_step: 50 ms"), corner, 1);
      const double mass = sum(by_id(simulation->particles(), "mass"));
      take_steps(*simulation, 10);
      SCOPED_TRACE(fmt::format("{}-D, corner at {}", dimension, corner));
      expect_undisturbed(*simulation, mass, 1, GetParam());
      EXPECT_NEAR(by_id(simulation->particles(), "position")[0], 0.5, GetParam().by_corners() ? 1e-13 : 1e-14);
    }
}

// A body at rest that fills the domain to its upper corner, points on the upper faces included: they belong to the last
// cells.
TEST_P(CellEdges, AtRestOnTheUpperCorner) {
  const auto simulation = moving_block(2, GetParam().with("time_step: 5 ms"), 15, 0);
  EXPECT_NO_THROW(take_steps(*simulation, 3));
  EXPECT_EQ(largest_stress(simulation->particles()), 0);
}

// The particles of a block may go one cell beyond it before they are sorted again. A point on the edge of a block that
// moves a tenth of a cell a step adds up to 0.9999999999999999 cells in ten steps, yet has gone a full cell and a hair.
TEST_P(CellEdges, NoParticleLeavesTheTileOfItsBlock) {
  const auto simulation =
      simulate({.grid = "{min: [0 m, 0 m], max: [32 m, 8 m], cell: 1 m}",
                .material = soft_soil,
                .bodies = "  - {material: soil, box: {min: [24 m, 2 m], max: [24.5 m, 2.5 m]}, velocity: [-1 m/s, 0]}",
                .scheme = GetParam().with("time_step: 100 ms")});
  set_column(simulation->particles(), "position", 0, [](const auto&) { return 24.0; });
  for (int i = 0; i < 40; ++i) {
    simulation->advance(1e6);
    Archive archive;
    simulation->store(archive);
    const double travelled = archive.reals.at("loop")[2];
    const double x = by_id(simulation->particles(), "position")[0];
    const auto first_cell = static_cast<double>(archive.integers.at("blocks")[0]);
    const bool sorted_first = travelled >= travel_allowance;  // before the next scatter
    ASSERT_TRUE(sorted_first || std::floor(x) >= first_cell - 1) << fmt::format("after step {}, x = {:.17g}", i + 1, x);
  }
}

INSTANTIATE_TEST_SUITE_P(Schemes, CellEdges, ::testing::ValuesIn(all_schemes()), scheme_name);

}  // namespace
}  // namespace sluice
