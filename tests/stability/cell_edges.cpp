/// F15: the control of tests/verification/cell_edges.cpp: linear functions that take points exactly on an edge as they
/// stand. docs/stability/f15_cell_edges.md.
#include "core/transfer/linear.h"
#include "tests/figures.h"
#include "tests/verification/moving_block.h"

namespace sluice {
namespace shape {

/// The program's linear functions, without the hair by which transfers keep points inside of their cell. Known to the
/// case files of this test program alone.
struct LinearOnEdges : Linear {
  static constexpr double hair = 0;
};

const bool linear_on_edges_registered =
    shape_registry<2>().add("linear_on_edges", {"Linear, points on edges as they stand: for the control of F15.", {}},
                            [] { return std::make_unique<ShapeKernelsOf<2, LinearOnEdges>>(); });

}  // namespace shape

namespace {

/// [s], and at 1 m/s in cells of 1 m as much of a cell: a binary fraction, so that points come to edges exactly.
constexpr double step = 0.0625;
const char* const timings[] = {"usf", "usl", "musl"};

Scheme scheme_of(const std::string& shape, const std::string& transfer, const std::string& timing) {
  return Scheme{.shape = shape, .transfer = transfer, .stress_update = timing}.with("time_step: 62.5 ms");
}

/// The largest stress over the modulus that a step makes in a block in even motion, half a cell apart, whose last row
/// and column stand `behind` an edge in it [cells]. With USF a step strains before it moves, but the first one does
/// not.
double stress_behind_edge(const Scheme& scheme, double behind, double velocity = 1) {
  const int steps = scheme.stress_update == "usf" ? 2 : 1;
  const auto simulation = moving_block(2, scheme, 5 + behind - (steps - 1) * step * velocity, velocity);
  take_steps(*simulation, steps);
  return largest_stress(simulation->particles()) / soft_modulus;
}

// The node behind the edge has no mass, hence no velocity: the points on the edge see dt v / h in each direction, as a
// compression or an extension after the sign of v. A hair of 1e-11 beside the edge is enough: then the node has a
// velocity. Tolerance: as in tests/verification/cell_edges.cpp, for nodes that hold any small share of a particle.
TEST(PointsOnEdges, AreStrainedByTheVelocityThatIsMissing) {
  for (const char* transfer : {"flip", "apic", "tpic"})
    for (const char* timing : timings)
      for (const double velocity : {1.0, -1.0}) {
        SCOPED_TRACE(fmt::format("{}, {}, {} m/s", transfer, timing, velocity));
        const Scheme failing = scheme_of("linear_on_edges", transfer, timing);
        EXPECT_NEAR(stress_behind_edge(failing, 0, velocity), step, 1e-6);
        EXPECT_LT(stress_behind_edge(failing, 1e-11, velocity), 1e-6);
        EXPECT_LT(stress_behind_edge(scheme_of("linear", transfer, timing), 0, velocity), 1e-6);
      }
}

// Over an edge and on to the next one: what was strained once stays strained, and swings; a block that is taken a hair
// inside goes on free of stress.
TEST(PointsOnEdges, DisturbTheMotionOfTheirBody) {
  FigureTable at("cell_edges_place", "shape,behind,stress"), over("cell_edges_motion", "shape,travelled,stress");
  for (const std::string shape : {"linear", "linear_on_edges"}) {
    const Scheme scheme = scheme_of(shape, "flip", "usl");
    for (int i = -8; i <= 8; ++i) at.row(shape, step * i, stress_behind_edge(scheme, step * i));
    const auto simulation = moving_block(2, scheme, 4.5, 1);  // on an edge after eight steps
    double largest = 0;
    for (int i = 0; i < 32; ++i) {
      take_steps(*simulation, 1);
      const double stress = largest_stress(simulation->particles()) / soft_modulus;
      over.row(shape, step * (i + 1), stress);
      largest = std::max(largest, stress);
    }
    if (shape == "linear") {
      EXPECT_LT(largest, 1e-6);
    } else {
      EXPECT_GT(largest, 0.99 * step);
    }
  }
}

}  // namespace
}  // namespace sluice
