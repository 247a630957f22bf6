/// Bending: the first vibration of a cantilever. Source: the beam of Timoshenko, with the shear coefficient 5/6 (Cowper
/// 1966, for Poisson's ratio 0): its first frequency is 3.516 / L^2 sqrt(E I / rho A) for slender beams (Euler,
/// Bernoulli), and less by what shear and the inertia of rotation take.
#include <Eigen/Dense>
#include <numbers>

#include "core/grid/geometry.h"
#include "tests/verification/scene_fixture.h"

namespace sluice {
namespace {

constexpr double length = 8, depth = 1, modulus = 100, density = 1, middle = 1.5;

/// det of what must vanish at the free end, deflection and rotation being zero at the other: y = (w, phi, M, Q),
/// Q = kappa G A (w' - phi), M = E I phi', Q' = -rho A omega^2 w, M' = -Q - rho I omega^2 phi. Runge-Kutta.
double free_end(double omega) {
  const double inertia = depth * depth * depth / 12, shear = 5.0 / 6 * modulus / 2 * depth;
  Eigen::Matrix4d system = Eigen::Matrix4d::Zero();
  system(0, 1) = 1, system(0, 3) = 1 / shear;
  system(1, 2) = 1 / (modulus * inertia);
  system(2, 1) = -density * inertia * omega * omega, system(2, 3) = -1;
  system(3, 0) = -density * depth * omega * omega;
  constexpr int steps = 1000;
  const Eigen::Matrix4d a = system * (length / steps), a2 = a * a;
  const Eigen::Matrix4d step = Eigen::Matrix4d::Identity() + a + a2 / 2 + a2 * a / 6 + a2 * a2 / 24;
  Eigen::Matrix4d all = Eigen::Matrix4d::Identity();
  for (int i = 0; i < steps; ++i) all = (step * all).eval();
  return all.bottomRightCorner<2, 2>().determinant();
}

double slender_frequency() {
  return 3.5160152685 / (length * length) * std::sqrt(modulus * depth * depth / (12 * density));
}

/// The first root of free_end, by bisection.
double timoshenko_frequency() {
  double low = 0.5 * slender_frequency(), high = 1.1 * slender_frequency();
  const double sign = free_end(low);
  for (int i = 0; i < 60; ++i) (free_end((low + high) / 2) * sign > 0 ? low : high) = (low + high) / 2;
  return (low + high) / 2;
}

/// The first frequency, from the third zero of the share that the first mode has in the velocity. `h` is the cell.
double frequency(const Scheme& scheme, int dimension, double h, int per_axis) {
  const bool flat = dimension == 2;
  const double width = h;  // in 3-D: one cell between two rollers, which without Poisson's ratio is plane strain
  const auto simulation = simulate(
      {.grid = flat ? fmt::format("{{min: [0 m, 0 m], max: [9 m, 3 m], cell: {} m}}", h)
                    : fmt::format("{{min: [0 m, 0 m, 0 m], max: [9 m, {} m, 3 m], cell: {} m}}", width, h),
       .material = "{model: linear_elastic, density: 1 kg/m3, youngs_modulus: 100 Pa, poisson_ratio: 0}",
       .bodies = flat ? fmt::format("  - {{material: soil, box: {{min: [0 m, 1 m], max: [8 m, 2 m]}}, "
                                    "particles_per_cell: {}}}",
                                    power(per_axis, 2))
                      : fmt::format("  - {{material: soil, box: {{min: [0 m, 0 m, 1 m], max: [8 m, {} m, 2 m]}}, "
                                    "particles_per_cell: {}}}",
                                    width, power(per_axis, 3)),
       .boundaries = flat ? "{left: fixed}" : "{left: fixed, front: roller, back: roller}",
       .scheme = scheme});
  Particles& particles = simulation->particles();
  const int up = dimension - 1;
  const auto shape = [](double x) { return x * x * (6 * length * length - 4 * length * x + x * x) / 12288; };
  const auto slope = [](double x) { return x * (12 * length * length - 12 * length * x + 4 * x * x) / 12288; };
  const auto turned = [](double x) { return (12 * length * length - 24 * length * x + 12 * x * x) / 12288; };
  constexpr double v0 = 1e-3;
  const auto across = [up](const auto& x) { return x[static_cast<std::size_t>(up)] - middle; };
  set_column(particles, "velocity", up, [&](const auto& x) { return v0 * shape(x[0]); });
  set_column(particles, "velocity", 0, [&](const auto& x) { return -v0 * across(x) * slope(x[0]); });
  if (scheme.affine()) {
    set_column(particles, "affine_velocity", up * dimension, [&](const auto& x) { return v0 * slope(x[0]); });
    set_column(particles, "affine_velocity", up, [&](const auto& x) { return -v0 * slope(x[0]); });
    set_column(particles, "affine_velocity", 0, [&](const auto& x) { return -v0 * across(x) * turned(x[0]); });
  }
  const auto mode = by_id(particles, "velocity", up);
  double before = 1, time_before = 0;
  for (int zeros = 0;;) {
    const double dt = simulation->advance(1e6).dt, middle_time = simulation->time() - dt / 2;
    const double now = dot(by_id(particles, "velocity", up), mode);
    if ((now < 0) != (before < 0) && ++zeros == 3)
      return 1.25 * 2 * std::numbers::pi / (time_before + (middle_time - time_before) * before / (before - now));
    before = now, time_before = middle_time;
  }
}

// Slender beam, L / H = 8: shear and rotation take 2 %.
TEST(Timoshenko, IsSlenderBeamsLimit) {
  EXPECT_LT(timoshenko_frequency(), 0.99 * slender_frequency());
  EXPECT_GT(timoshenko_frequency(), 0.97 * slender_frequency());
}

class Cantilever : public ::testing::TestWithParam<std::string> {};

// Two cells, then four in the depth. Gates: 1.5 % of the frequency with four (measured: 0.2 % to 0.4 % above with
// functions on linear nodes, 0.9 % to 1.4 % below with B-splines, whose surface is a particle's width softer), and
// second order: a third of the error at least.
TEST_P(Cantilever, VibratesWithTheFrequencyOfTimoshenko) {
  const double exact = timoshenko_frequency();
  for (const char* transfer : {"flip", "tpic"}) {
    const Scheme scheme = {GetParam(), transfer, "usl", 1, {}};
    const double coarse = frequency(scheme, 2, 0.5, 2) / exact - 1, fine = frequency(scheme, 2, 0.25, 2) / exact - 1;
    EXPECT_LT(std::abs(fine), 0.015) << transfer;
    EXPECT_GT(coarse / fine, 3) << transfer;
  }
}

// In space, between two smooth faces, the plane is found again.
TEST_P(Cantilever, InSpaceAsInThePlane) {
  const Scheme scheme = {GetParam(), "tpic", "usl", 1, {}};
  EXPECT_NEAR(frequency(scheme, 3, 0.5, 2) / frequency(scheme, 2, 0.5, 2), 1, 1e-3);
}

INSTANTIATE_TEST_SUITE_P(Shapes, Cantilever,
                         ::testing::Values("linear", "ugimp", "quadratic_bspline", "cubic_bspline", "cpdi", "cpdi2"),
                         [](const auto& value) { return value.param; });

}  // namespace
}  // namespace sluice
