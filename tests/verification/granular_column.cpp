/// Columns of dry grains that collapse on a rough bed. Sources:
///  - aluminium rods: Bui et al. (2008, IJNAMG 32:1537), the front stops 0.44 m from the wall;
///  - columns of sand and beads in a channel: the front advances by 1.2 a (Lube et al. 2005) to 1.8 a (Lajeunesse et
///  al.
///    2005) of the width for a = height / width = 1, and by 2.4 to 3.6 for a = 2; height of the deposit over the width
///    0.65 a^0.35 (Lajeunesse) to a^0.4 (Lube);
///  - cylinders of sand: by 1.24 a of the radius for a < 1.7 (Lube et al. 2004).
/// Tolerances: the spread of the experiments, which differ by the angle of friction and by what grains do that a
/// perfectly plastic continuum does not; 5 % for the rods.
#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/verification/scene_fixture.h"

namespace sluice {
namespace {

struct Column {
  double width, height, cell, friction_angle;
  int dimension = 2;  ///< 3: a quarter of a cylinder of radius `width`
};

struct Deposit {
  double front, height;     ///< of the outermost particles [m]
  double along_x, along_y;  ///< how far it reaches along the axes, of which y points up in 2-D [m]
  double kinetic;           ///< over the loss of potential energy since the start
};

/// The largest distance from the first (3-D: upright) axis, or the largest coordinate.
double farthest(const Particles& particles) {
  double most = 0;
  const auto x = particles.columns.values(particles.position, 0), y = particles.columns.values(particles.position, 1);
  for (std::size_t p = 0; p < particles.size(); ++p)
    most = std::max(most, particles.dimension == 3 ? std::hypot(x[p], y[p]) : x[p]);
  return most;
}

double farthest_along(const Particles& particles, int axis) {
  return std::ranges::max(particles.columns.values(particles.position, axis));
}

/// What is left of a column of grains `seconds` after it was set free.
Deposit deposit(const Column& c, double seconds) {
  const bool flat = c.dimension == 2;
  const auto cells = [&](double length) { return c.cell * std::ceil(length / c.cell - 1e-9); };
  const double reach = cells(flat ? c.width + 5 * c.height : c.width + 3 * c.height),
               top = cells(c.height + 2 * c.cell);
  const auto simulation = simulate(
      {.grid = flat ? fmt::format("{{min: [0 m, 0 m], max: [{:.9g} m, {:.9g} m], cell: {} m}}", reach, top, c.cell)
                    : fmt::format("{{min: [0 m, 0 m, 0 m], max: [{0:.9g} m, {0:.9g} m, {1:.9g} m], cell: {2} m}}",
                                  reach, top, c.cell),
       .material = fmt::format("{{model: mohr_coulomb, density: 1600 kg/m3, youngs_modulus: 1 MPa, poisson_ratio: 0.3, "
                               "friction_angle: {} deg, cohesion: 0 Pa}}",
                               c.friction_angle),
       .bodies =
           flat
               ? fmt::format("  - {{material: soil, box: {{min: [0 m, 0 m], max: [{} m, {} m]}}}}", c.width, c.height)
               : fmt::format(
                     "  - {{material: soil, particles_per_cell: 8, circle: {{centre: [0 m, 0 m], radius: {0} m}}, box: "
                     "{{min: [0 m, 0 m, 0 m], max: [{0} m, {0} m, {1} m]}}}}",
                     c.width, c.height),
       .gravity = flat ? "[0, -9.81 m/s2]" : "[0, 0, -9.81 m/s2]",
       .boundaries = flat ? "{bottom: fixed, left: roller}" : "{bottom: fixed, left: roller, front: roller}",
       .initial_stress = "{method: k0}",
       .scheme = {"quadratic_bspline", "apic", "usl", 1, {}},
       .outflow = "remove"});
  const double before = simulation->energies().at(2).second;
  simulation->advance_to(seconds);
  const auto energies = simulation->energies();
  const Particles& particles = simulation->particles();
  return {farthest(particles), farthest_along(particles, c.dimension - 1), farthest_along(particles, 0),
          farthest_along(particles, 1), energies.at(0).second / (before - energies.at(2).second)};
}

// Cells of 5 mm hold four rods. With finer ones a tail of one or two cells, less than the rods are thick, runs on; the
// surface above it is the same within 2 mm.
TEST(GranularColumn, RodsStopWhereTheyDidInTheExperiment) {
  const Deposit rods = deposit({0.2, 0.1, 0.005, 19.8}, 1.0);
  EXPECT_NEAR(rods.front / 0.44, 1, 0.05);
  EXPECT_NEAR(rods.height / 0.1, 1, 0.03);  // the shoulder at the wall does not move
  EXPECT_LT(rods.kinetic, 1e-4);
}

TEST(GranularColumn, RunoutAndHeightScaleWithTheAspect) {
  for (const double a : {1.0, 2.0}) {
    SCOPED_TRACE(a);
    const double width = 0.1;
    const Deposit sand = deposit({width, a * width, 0.005, 31}, 1.0);
    const double runout = sand.front / width - 1;
    EXPECT_GT(runout, a < 1.5 ? 1.2 * a : 2.4);
    EXPECT_LT(runout, a < 1.5 ? 1.8 * a : 3.6);
    EXPECT_GT(sand.height / width, 0.65 * std::pow(a, 0.35));
    EXPECT_LT(sand.height / width, std::pow(a, 0.4));
    EXPECT_LT(sand.kinetic, 1e-3);
  }
}

// The negative control: grains with half the friction, which no experiment had, run beyond all of them.
TEST(GranularColumn, WithLittleFrictionRunsTooFar) {
  EXPECT_GT(deposit({0.1, 0.1, 0.005, 15}, 1.0).front / 0.1 - 1, 1.8);
}

// Its front grows longer as it goes. Nothing tells x from y: the deposit is its own mirror image, to round-off.
TEST(GranularColumn, CylinderSpreadsLessThanAWallAndAlikeToBothSides) {
  const double h = 0.01;
  const Deposit wall = deposit({0.1, 0.1, h, 31}, 0.6), cylinder = deposit({0.1, 0.1, h, 31, 3}, 0.6);
  EXPECT_LT(cylinder.front, wall.front);
  EXPECT_GT(cylinder.front, 0.1 + 0.6 * 0.124);  // cells of a tenth of the radius leave the thin edge out
  EXPECT_LT(cylinder.front, 0.1 + 1.15 * 0.124);
  EXPECT_LT(cylinder.kinetic, 1e-3);
  EXPECT_NEAR(cylinder.along_x / cylinder.along_y, 1, 1e-9);
}

}  // namespace
}  // namespace sluice
