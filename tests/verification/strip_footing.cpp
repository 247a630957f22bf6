/// A rigid strip footing pressed into weightless undrained clay. Source: Prandtl (1920): whatever the roughness of the
/// footing, it carries N_c = 2 + pi times the undrained strength, in plane strain and without change of volume.
#include <numbers>

#include "tests/verification/scene_fixture.h"

namespace sluice {
namespace {

constexpr double strength = 10e3, exact = 2 + std::numbers::pi;

struct Footing {
  std::string shape = "cubic_bspline";
  double cell = 0.25;
  bool rough = true, f_bar = true;
  std::string transfer = "apic";
  bool implicit = false;  ///< in 14 steps from equilibrium to equilibrium
  double slowness = 1;    ///< how many times slower it sinks
};

/// Mean pressure under the footing, over the strength, when it has gone down by 0.5 to 0.6 % of its width.
///
/// One half of it. The last node that the footing holds lies half a cell inside its edge, so that its smeared edge, the
/// integral of the sum of the functions that it holds, is where the edge is: nodes of quadratic B-splines stand in the
/// middles of cells, others on their edges. The footing starts slowly and then sinks with 2 cm/s: inertia is rho v^2 =
/// 1 Pa, and shear waves cross the clay 20 times.
double bearing_factor(const Footing& footing) {
  const double half_width = 1 + (footing.shape == "quadratic_bspline" ? 0 : footing.cell / 2),
               end = 0.7 * footing.slowness;
  SceneText scene{
      .grid = fmt::format("{{min: [0 m, 0 m], max: [4 m, 2.5 m], cell: {} m}}", footing.cell),
      .material =
          "{model: von_mises, density: 2000 kg/m3, youngs_modulus: 20 MPa, poisson_ratio: 0.49, strength: 10 kPa}",
      .bodies = "  - {material: soil, box: {min: [0 m, 0 m], max: [4 m, 2 m]}}",
      .boundaries = "{left: roller, right: roller, bottom: fixed}",
      .scheme = Scheme{.shape = footing.shape, .transfer = footing.transfer}.with(
          fmt::format("f_bar: {}{}", footing.f_bar,
                      footing.implicit ? ", integration: implicit_static, tolerance: 1e-4, time_step: 50 ms" : ""))};
  scene.more = fmt::format(
      "obstacles: {{footing: {{box: {{min: [-1 m, 2 m], max: [{} m, 3 m]}}, normal: fixed, tangential: {}, "
      "velocity: [0, [[0 s, 0 m/s], [{} s, {} m/s]]]}}}}\n",
      half_width, footing.rough ? "fixed" : "free", 0.3 * footing.slowness, -0.02 / footing.slowness);
  const auto simulation = simulate(scene);
  simulation->advance_to(end - 0.1 * footing.slowness);
  double impulse = 0;
  while (simulation->time() < end) {
    const double dt = simulation->advance(end).dt;
    for (const auto& [name, force] : simulation->step_numbers())
      if (name == "footing_force_y_N") impulse += dt * force;
  }
  return impulse / (0.1 * footing.slowness) / (half_width * strength);
}

// Measured on cells of an eighth of the half-width: 0.5 % (cubic, rough), 1.1 % (uGIMP, rough), 2.2 % (uGIMP, smooth).
// The error falls with the cell; where two cells lead, 1 %.
TEST(StripFooting, CarriesWhatPrandtlFound) {
  for (const Footing& footing : {Footing{"cubic_bspline"}, Footing{"ugimp"}, Footing{"ugimp", 0.25, false}}) {
    SCOPED_TRACE(fmt::format("{}, {}", footing.shape, footing.rough ? "rough" : "smooth"));
    const double coarse = bearing_factor(footing);
    const double fine = bearing_factor({footing.shape, footing.cell / 2, footing.rough});
    EXPECT_NEAR(coarse / exact, 1, 0.05);
    EXPECT_NEAR(fine / exact, 1, 0.03);
    EXPECT_NEAR((2 * fine - coarse) / exact, 1, 0.015);
  }
}

// A smooth footing on cubic B-splines: the clay slips in a layer as thick as their support, and the error is larger,
// but falls with the cell as well.
TEST(StripFooting, CarriesThatOnAnyShapeFunctionsWhereCellsAreSmall) {
  const double coarse = bearing_factor({"cubic_bspline", 0.25, false}),
               fine = bearing_factor({"cubic_bspline", 0.125, false});
  EXPECT_NEAR((2 * fine - coarse) / exact, 1, 0.03);
}

// Quadratic B-splines: on cells whose means are shared from node to node the factor is 6 % short on cells of an eighth,
// and tends to the exact one with the cell. With the cells of the grid it was 4.2, and fell as the footing sank
// (tests/verification/f_bar.cpp says why).
TEST(StripFooting, CarriesThatOnQuadraticBSplinesAsCellsGoToZero) {
  const double coarse = bearing_factor({"quadratic_bspline"}), fine = bearing_factor({"quadratic_bspline", 0.125});
  EXPECT_NEAR(fine / exact, 1, 0.08);
  EXPECT_NEAR((2 * fine - coarse) / exact, 1, 0.015);
}

// The same in implicit steps: the error is of first order in the cell, and the extrapolated factor within 1 % of
// Prandtl's on all shape functions (gate 1.5 %), even where single grids are far from it.
TEST(StripFooting, CarriesThatInImplicitSteps) {
  for (const Footing& footing : {Footing{"cubic_bspline"}, Footing{"ugimp"}, Footing{"ugimp", 0.25, false},
                                 Footing{"cpdi2"}, Footing{"quadratic_bspline"}}) {
    SCOPED_TRACE(fmt::format("{}, {}", footing.shape, footing.rough ? "rough" : "smooth"));
    Footing implicit = footing;
    implicit.transfer = "flip";
    implicit.implicit = true;
    const double coarse = bearing_factor(implicit);
    implicit.cell /= 2;
    const double fine = bearing_factor(implicit);
    EXPECT_LT(std::abs(fine / exact - 1), std::abs(coarse / exact - 1));
    EXPECT_NEAR((2 * fine - coarse) / exact, 1, 0.015);
  }
}

// What implicit steps find is what explicit ones tend to as the footing sinks slowly, on the same grid: with FLIP at a
// tenth of the speed to 0.3 %. At full speed APIC, which damps what it does not resolve, adds a sixth to the strength
// of the coarse grid; that it comes close to Prandtl there is chance.
TEST(StripFooting, CarriesInSlowExplicitStepsWhatItDoesInImplicitOnes) {
  const double implicit = bearing_factor({.transfer = "flip", .implicit = true});
  EXPECT_NEAR(bearing_factor({.transfer = "flip", .slowness = 10}) / implicit, 1, 0.01);
  EXPECT_GT(bearing_factor({}) / implicit, 1.1);
}

TEST(StripFooting, LocksWithoutFBarInImplicitSteps) {
  EXPECT_GT(bearing_factor({.shape = "ugimp", .f_bar = false, .transfer = "flip", .implicit = true}) / exact, 1.3);
}

// Control: without F-bar the clay cannot flow at constant volume, and carries far too much.
TEST(StripFooting, LocksWithoutFBar) { EXPECT_GT(bearing_factor({.shape = "ugimp", .f_bar = false}) / exact, 1.3); }

}  // namespace
}  // namespace sluice
