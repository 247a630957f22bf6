/// NonlinearSolver on problems whose solutions are known, without any soil.
#include "solvers/nonlinear_solver.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <stdexcept>
#include <vector>

namespace sluice {
namespace {

/// -y'' = lambda exp(y) on (0, 1), y(0) = y(1) = 0 (Bratu), by differences of second order on n inner points. F is
/// residual times h^2; A that of y'' alone.
struct Bratu {
  double lambda;
  std::size_t n;
  double h() const { return 1.0 / static_cast<double>(n + 1); }

  bool residual(std::span<const double> y, std::span<double> f) const {
    for (std::size_t i = 0; i < n; ++i) {
      const double left = i > 0 ? y[i - 1] : 0, right = i + 1 < n ? y[i + 1] : 0;
      f[i] = 2 * y[i] - left - right - h() * h() * lambda * std::exp(y[i]);
    }
    return true;
  }
  /// Elimination in a tridiagonal matrix (Thomas).
  void precondition(std::span<const double> r, std::span<double> x) const {
    std::vector<double> upper(n), right(n);
    for (std::size_t i = 0; i < n; ++i) {
      const double pivot = 2 + (i > 0 ? upper[i - 1] : 0);
      upper[i] = -1 / pivot;
      right[i] = (r[i] + (i > 0 ? right[i - 1] : 0)) / pivot;
    }
    for (std::size_t i = n; i-- > 0;) x[i] = right[i] - (i + 1 < n ? upper[i] * x[i + 1] : 0);
  }
  NonlinearProblem problem() const {
    return {[this](auto y, auto f) { return residual(y, f); }, [this](auto r, auto x) { precondition(r, x); }};
  }
};

/// y(1/2) of the lower branch: 2 ln cosh(t / 4) with t = sqrt(2 lambda) cosh(t / 4). A solution exists up to lambda =
/// 3.5138 (Bratu 1914).
double bratu_in_the_middle(double lambda) {
  double t = 0;
  for (int i = 0; i < 2000; ++i) t = std::sqrt(2 * lambda) * std::cosh(t / 4);
  return 2 * std::log(std::cosh(t / 4));
}

/// Picard alone, Newton alone, both.
std::vector<NonlinearOptions> ways() {
  NonlinearOptions picard{.tolerance = 1e-12}, newton = picard;
  picard.most_newton = 0;
  newton.most_picard = 0;
  return {picard, newton, {.tolerance = 1e-12}};
}

// The tolerance of 2e-5 is the error of the differences, h^2 / 12 times the fourth derivative, which is less than 10.
TEST(NonlinearSolver, FindsTheSolutionOfBratusEquation) {
  for (const double lambda : {1.0, 3.0}) {
    const Bratu bratu{lambda, 199};
    for (const NonlinearOptions& options : ways()) {
      std::vector<double> y(bratu.n, 0.0);
      const NonlinearReport report = solve_nonlinear(bratu.problem(), y, options);
      EXPECT_TRUE(report.converged);
      EXPECT_LE(report.residual, 1e-12);
      EXPECT_EQ(report.by_newton, options.most_picard == 0);
      EXPECT_NEAR(y[bratu.n / 2], bratu_in_the_middle(lambda), 2e-5 * lambda) << lambda;
    }
  }
}

// Anderson acceleration pays: without it each iteration leaves 2/3 of the error, close to the largest lambda; with it
// less than half as many are needed.
TEST(NonlinearSolver, NeedsFewerEvaluationsWithAcceleration) {
  const Bratu bratu{3.4, 99};
  NonlinearOptions options{.tolerance = 1e-10, .most_newton = 0};
  std::vector<double> y(bratu.n, 0.0);
  const NonlinearReport fast = solve_nonlinear(bratu.problem(), y, options);
  options.memory = 0;
  std::ranges::fill(y, 0.0);
  const NonlinearReport slow = solve_nonlinear(bratu.problem(), y, options);
  EXPECT_TRUE(fast.converged);
  EXPECT_TRUE(slow.converged);
  EXPECT_LT(2 * fast.evaluations, slow.evaluations);
}

// The negative control: beyond the largest lambda there is no solution, and none is reported; u and residual belong
// together, and the evaluations are bounded.
TEST(NonlinearSolver, SaysThatThereIsNoSolution) {
  const Bratu bratu{3.7, 99};
  for (const NonlinearOptions& options : ways()) {
    std::vector<double> y(bratu.n, 0.0), f(bratu.n);
    const NonlinearReport report = solve_nonlinear(bratu.problem(), y, options);
    EXPECT_FALSE(report.converged);
    EXPECT_LE(report.evaluations, options.most_picard + options.most_newton);
    bratu.residual(y, f);
    double largest = 0;
    for (const double x : f) largest = std::max(largest, std::abs(x));
    EXPECT_EQ(report.residual, largest);
    EXPECT_GT(largest, 1e-8);
  }
}

/// Two springs in a row that yield: force k u up to the strength s, and k / 100 beyond. F has a kink.
double yielding(double u, double k, double s) { return u * k < s ? k * u : s + 0.01 * k * (u - s / k); }

// Exact: both carry the load, so each stretch follows from the law by hand.
TEST(NonlinearSolver, PassesKinks) {
  const NonlinearProblem problem{[](auto u, auto f) {
                                   const double first = yielding(u[0], 10, 2), second = yielding(u[1] - u[0], 5, 4);
                                   f[0] = first - second;
                                   f[1] = second - 3;
                                   return true;
                                 },
                                 [](auto r, auto x) {
                                   const double sum = r[0] + r[1];  // of the elastic chain
                                   x[1] = sum / 10 + r[1] / 5;
                                   x[0] = sum / 10;
                                 }};
  for (const NonlinearOptions& options : ways()) {
    std::array<double, 2> u{};
    ASSERT_TRUE(solve_nonlinear(problem, u, options).converged);
    EXPECT_NEAR(u[0], 0.2 + 1 / 0.1, 1e-9);  // 2 elastic, 1 more with a stiffness of 0.1
    EXPECT_NEAR(u[1] - u[0], 0.6, 1e-9);
  }
}

// A matrix that is exact needs one step; a guess that is the solution needs none.
TEST(NonlinearSolver, IsLinearAlgebraForLinearProblems) {
  const NonlinearProblem problem{[](auto u, auto f) { return f[0] = 4 * u[0] - 8, true; },
                                 [](auto r, auto x) { x[0] = r[0] / 4; }};
  std::array<double, 1> u{};
  EXPECT_EQ(solve_nonlinear(problem, u, {}).evaluations, 2);
  EXPECT_EQ(u[0], 2);
  EXPECT_EQ(solve_nonlinear(problem, u, {}).evaluations, 1);
}

// A is far too soft (a factor of 20), so that the Picard iteration without memory diverges; Newton's method does it.
TEST(NonlinearSolver, TakesNewtonWherePicardDiverges) {
  const NonlinearProblem problem{[](auto u, auto f) { return f[0] = 20 * u[0] + std::sin(u[0]) - 40, true; },
                                 [](auto r, auto x) { x[0] = r[0]; }};
  std::array<double, 1> u{};
  const NonlinearReport report = solve_nonlinear(problem, u, {.tolerance = 1e-10, .memory = 0});
  EXPECT_TRUE(report.converged && report.by_newton);
  EXPECT_NEAR(20 * u[0] + std::sin(u[0]), 40, 1e-9);
}

// Where F is not defined, the line search of Newton's method takes a shorter step: sqrt(u) = 0.1 from 4.
TEST(NonlinearSolver, StaysWhereTheFunctionIsDefined) {
  const NonlinearProblem problem{[](auto u, auto f) {
                                   if (u[0] < 0) return false;
                                   f[0] = std::sqrt(u[0]) - 0.1;
                                   return true;
                                 },
                                 [](auto r, auto x) { x[0] = 8 * r[0]; }};
  std::array<double, 1> u{4};
  ASSERT_TRUE(solve_nonlinear(problem, u, {.tolerance = 1e-10}).converged);
  EXPECT_NEAR(u[0], 0.01, 1e-9);
}

TEST(NonlinearSolver, LetsExceptionsThrough) {
  const NonlinearProblem problem{[](auto, auto) -> bool { throw std::runtime_error("no"); }, [](auto, auto) {}};
  std::array<double, 1> u{};
  EXPECT_THROW(solve_nonlinear(problem, u, {}), std::runtime_error);
}

TEST(NonlinearSolver, HasNothingToDoWithoutUnknowns) {
  const NonlinearProblem problem{[](auto, auto) { return true; }, [](auto, auto) {}};
  EXPECT_TRUE(solve_nonlinear(problem, {}, {}).converged);
}

}  // namespace
}  // namespace sluice
