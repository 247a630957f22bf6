/// Controls that the program cannot be made to run, for it has no switch for the failure: the scheme of the failure by
/// itself, in a few lines. docs/stability.
#include <gtest/gtest.h>

#include <Eigen/Dense>

namespace sluice {
namespace {

// F14: Euler steps, velocity first, put a body in free fall g dt t / 2 too low, whatever the step is. The remedy, half
// of the first kick: tests/verification/free_fall.cpp, where the error is round-off.
TEST(Control, EulerStepsFallTooFar) {
  constexpr double g = 9.81, dt = 4e-3;
  double v = 0, fallen = 0, t = 0;
  for (int i = 0; i < 250; ++i) v += g * dt, fallen += v * dt, t += dt;
  EXPECT_NEAR(fallen - g * t * t / 2, g * dt * t / 2, 1e-12);
}

/// Flow through a rigid column of unit height, over k times the gradient, after the pressure on its base has risen to 1
/// in a hundred steps: increments of the pressure, steady in each step. What is given to the increment at the base is
/// that of the pressure there, or nothing.
double flow(bool increment_given) {
  constexpr int cells = 20, steps = 100;
  Eigen::MatrixXd laplacian = Eigen::MatrixXd::Zero(cells + 1, cells + 1);
  for (int i = 1; i < cells; ++i) laplacian.row(i).segment(i - 1, 3) << -1, 2, -1;
  laplacian(0, 0) = laplacian(cells, cells) = 1;  // given at the base; zero at the top
  Eigen::VectorXd p = Eigen::VectorXd::Zero(cells + 1);
  const Eigen::PartialPivLU<Eigen::MatrixXd> solver(laplacian);
  for (int step = 0; step < steps; ++step) {
    Eigen::VectorXd supply = -laplacian * p;
    supply[0] = increment_given ? 1.0 / steps : 0;
    supply[cells] = 0;
    p += solver.solve(supply);
  }
  return p[cells - 1] * cells;
}

// F19: with increments of the pressure whose value at a face with a given pressure is zero, that pressure never comes
// in, and no water flows. The remedy, with the program: Faces.PressureThatRisesDrivesSteadyFlow.
TEST(Control, NoIncrementOnAFaceMeansNoFlow) {
  EXPECT_NEAR(flow(true), 1, 1e-12);
  EXPECT_EQ(flow(false), 0);
}

}  // namespace
}  // namespace sluice
