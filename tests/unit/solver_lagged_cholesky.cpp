/// LaggedCholesky against SparseCholesky on sequences of diffusion operators, and its choices: when it factorizes, when
/// it stops, what it refuses, what a checkpoint restores.
#include "solvers/lagged_cholesky.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "tests/lattice_problem.h"

namespace sluice {
namespace {

using Options = LaggedCholeskyOptions;
using Vector = std::vector<double>;

Vector random_vector(int size, unsigned seed) {
  std::mt19937 random(seed);
  Vector result(static_cast<std::size_t>(size));
  for (double& x : result) x = 2 * std::generate_canonical<double, 32>(random) - 1;
  return result;
}

double norm(const Vector& v) { return Eigen::Map<const Eigen::VectorXd>(v.data(), static_cast<long>(v.size())).norm(); }

double difference(const Vector& a, const Vector& b) {
  Vector d(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) d[i] = a[i] - b[i];
  return norm(d);
}

Vector residual(const SymmetricPattern& pattern, const Vector& values, const Vector& x, Vector b) {
  for (std::size_t j = 0; j < x.size(); ++j)
    for (int k = pattern.column_begin[j]; k < pattern.column_begin[j + 1]; ++k) {
      const auto i = static_cast<std::size_t>(pattern.row[static_cast<std::size_t>(k)]);
      const double a = values[static_cast<std::size_t>(k)];
      b[i] -= a * x[j];
      if (i != j) b[j] -= a * x[i];
    }
  return b;
}

Vector solve_directly(const SymmetricPattern& pattern, const Vector& values, const Vector& b) {
  SparseCholesky cholesky;
  cholesky.analyze(pattern);
  cholesky.factorize(values);
  Vector x(b.size());
  cholesky.solve(b, x);
  return x;
}

/// 40 x 30 cells, the bottom fixed.
LatticeProblem<2> plane() {
  LatticeProblem<2> problem({40, 30});
  problem.fix_bottom();
  return problem;
}

template <int Dim>
void expect_sequence_solved(LatticeProblem<Dim> problem, Options options) {
  problem.fix_bottom();
  LaggedCholesky solver(options);
  solver.analyze(problem.pattern, nested_dissection<Dim>(problem.places));
  const DriftingCoefficients coefficients(problem.cells.size(), 1e-2);
  const Vector b = random_vector(problem.size(), 1);
  Vector x(b.size(), 0.0);
  for (int step = 0; step < 20; ++step) {
    const Vector values = problem.values(coefficients.at(step), 1e-3);
    const auto report = solver.solve(values, b, x);
    EXPECT_TRUE(report.converged);
    EXPECT_LE(norm(residual(problem.pattern, values, x, b)),
              1.001 * LaggedCholeskyOptions().relative_tolerance * norm(b))
        << "step " << step;
    // The condition number is below 1e4, which turns the residual of 1e-10 into an error of 1e-6 at most.
    const Vector direct = solve_directly(problem.pattern, values, b);
    EXPECT_LT(difference(x, direct), 1e-6 * norm(direct)) << "step " << step;
  }
}

TEST(LaggedCholesky, SolvesDriftingSystemsAsDirectSolutionsDo) {
  for (const auto choice : {Options::Choice::counted, Options::Choice::measured, Options::Choice::direct})
    for (const auto ordering : {Options::Ordering::measured, Options::Ordering::minimum_degree,
                                Options::Ordering::nested_dissection, Options::Ordering::given}) {
      SCOPED_TRACE("choice " + std::to_string(static_cast<int>(choice)) + ", ordering " +
                   std::to_string(static_cast<int>(ordering)));
      expect_sequence_solved<2>(LatticeProblem<2>({40, 30}), {.ordering = ordering, .choice = choice});
      expect_sequence_solved<3>(LatticeProblem<3>({9, 8, 7}), {.ordering = ordering, .choice = choice});
    }
}

/// Factorizations in 30 steps.
int factorizations(double drift, Options::Choice choice) {
  const LatticeProblem<2> problem = plane();
  LaggedCholesky solver({.choice = choice, .relative_tolerance = 1e-10});
  solver.analyze(problem.pattern);
  const DriftingCoefficients coefficients(problem.cells.size(), drift);
  const Vector b = random_vector(problem.size(), 1);
  Vector x(b.size(), 0.0);
  for (int step = 0; step < 30; ++step) solver.solve(problem.values(coefficients.at(step), 0), b, x);
  EXPECT_EQ(solver.statistics().solves, 30);
  return solver.statistics().factorizations;
}

// With a drift of 1e-6 the factor of the first step is off by 3e-5 in the last: three iterations or so from a guess
// that is nearly right. With a drift of one, coefficients of neighbouring steps have nothing to do with each other, and
// conjugate gradients would need dozens of iterations; the lagged factor may be tried in vain a few times, which still
// ends in a factorization.
TEST(LaggedCholesky, KeepsTheFactorWhileItServes) {
  EXPECT_EQ(factorizations(0, Options::Choice::counted), 1);
  EXPECT_LE(factorizations(1e-6, Options::Choice::counted), 2);
  EXPECT_GE(factorizations(1, Options::Choice::counted), 27);
  EXPECT_EQ(factorizations(0, Options::Choice::direct), 30);
}

TEST(LaggedCholesky, LeavesAGoodGuessAlone) {
  const LatticeProblem<2> problem = plane();
  const Vector values = problem.values(DriftingCoefficients(problem.cells.size(), 0).at(0), 0);
  const Vector b = random_vector(problem.size(), 1);
  LaggedCholesky solver;
  solver.analyze(problem.pattern);
  Vector x(b.size(), 0.0);
  solver.solve(values, b, x);
  const Vector before = x;
  EXPECT_EQ(solver.solve(values, b, x).iterations, 0);
  EXPECT_EQ(x, before);
}

TEST(LaggedCholesky, TakesNoHarmFromABadGuess) {
  const LatticeProblem<2> problem = plane();
  const Vector values = problem.values(DriftingCoefficients(problem.cells.size(), 0).at(0), 0);
  const Vector b = random_vector(problem.size(), 1);
  LaggedCholesky solver;
  solver.analyze(problem.pattern);
  for (const double guess : {1e20, std::numeric_limits<double>::quiet_NaN()}) {
    Vector x(b.size(), guess);
    EXPECT_TRUE(solver.solve(values, b, x).converged);
    EXPECT_LE(norm(residual(problem.pattern, values, x, b)),
              1.001 * LaggedCholeskyOptions().relative_tolerance * norm(b));
  }
  Vector x(b.size(), 1.0);
  solver.solve(values, Vector(b.size(), 0.0), x);
  EXPECT_EQ(norm(x), 0);
}

// The relative test alone would be met at once, with largest residuals of 1e-2.
TEST(LaggedCholesky, StopsAtTheLargestResidualToo) {
  const LatticeProblem<2> problem = plane();
  const DriftingCoefficients coefficients(problem.cells.size(), 1e-2);
  const Vector b = random_vector(problem.size(), 1);
  for (const double largest : {1e-3, 1e-6, 1e-9}) {
    LaggedCholesky solver({.relative_tolerance = 0.1});
    solver.analyze(problem.pattern);
    Vector x(b.size(), 0.0);
    for (int step = 0; step < 5; ++step) {
      const Vector values = problem.values(coefficients.at(step), 0);
      const auto report = solver.solve(values, b, x, largest);
      double found = 0;
      for (const double r : residual(problem.pattern, values, x, b)) found = std::max(found, std::abs(r));
      EXPECT_LE(found, 1.001 * largest);  // round-off of 1e-15 aside
      EXPECT_NEAR(report.largest_residual, found, 1e-13);
    }
  }
}

// A residual of 1e-30 is beyond round-off: the solver says so, returns what it has, and does not factorize in vain.
TEST(LaggedCholesky, SaysWhenRoundOffKeepsItFromTheGoal) {
  const LatticeProblem<2> problem = plane();
  const DriftingCoefficients coefficients(problem.cells.size(), 1e-3);
  const Vector b = random_vector(problem.size(), 1);
  LaggedCholesky solver;
  solver.analyze(problem.pattern);
  Vector x(b.size(), 0.0);
  for (int step = 0; step < 3; ++step) {
    const auto report = solver.solve(problem.values(coefficients.at(step), 0), b, x, 1e-30);
    EXPECT_FALSE(report.converged);
    EXPECT_LT(report.residual, 1e-13);
    EXPECT_LE(report.iterations, 40);
  }
  EXPECT_EQ(solver.statistics().factorizations, 1);
}

/// Solutions of steps [from, to), one after the other in one array.
Vector run(LaggedCholesky& solver, const LatticeProblem<2>& problem, Vector& x, int from, int to) {
  const DriftingCoefficients coefficients(problem.cells.size(), 3e-2);
  const Vector b = random_vector(problem.size(), 1);
  Vector all;
  for (int step = from; step < to; ++step) {
    solver.solve(problem.values(coefficients.at(step), 0), b, x);
    all.insert(all.end(), x.begin(), x.end());
  }
  return all;
}

TEST(LaggedCholesky, GoesOnFromACheckpointWithTheSameBits) {
  const LatticeProblem<2> problem = plane();
  const std::vector<int> order = nested_dissection<2>(problem.places);
  for (const int interruption : {0, 1, 2, 5, 9}) {
    LaggedCholesky whole, second;
    whole.analyze(problem.pattern, order);
    Vector x(static_cast<std::size_t>(problem.size()), 0.0);
    run(whole, problem, x, 0, interruption);
    const LaggedCholesky::State state = whole.state();
    Vector x_second = x;
    const Vector expected = run(whole, problem, x, interruption, 20);
    EXPECT_GT(whole.statistics().factorizations, 1);  // the choices matter

    second.analyze(problem.pattern, order);
    second.restore(state);
    EXPECT_EQ(run(second, problem, x_second, interruption, 20), expected) << "after step " << interruption;
  }
}

// The order is chosen at the first analysis. A run that goes on from a checkpoint has its first analysis later, where
// another order might look best; it must use the one of the interrupted run.
TEST(LaggedCholesky, ACheckpointKeepsTheOrder) {
  const LatticeProblem<2> problem = plane();
  LaggedCholesky first({.ordering = Options::Ordering::nested_dissection}), second;
  std::vector<int> natural(static_cast<std::size_t>(problem.size()));
  std::iota(natural.begin(), natural.end(), 0);
  first.analyze(problem.pattern, natural);
  second.analyze(problem.pattern, natural);
  Vector x(static_cast<std::size_t>(problem.size()), 0.0);
  run(first, problem, x, 0, 1);
  second.restore(first.state());
  EXPECT_EQ(second.statistics().ordering, "nested dissection");
  EXPECT_EQ(second.statistics().factor_nonzeros, first.statistics().factor_nonzeros);
}

TEST(LaggedCholesky, FollowsAChangeOfPattern) {
  LaggedCholesky solver;
  int analyses = 0;
  for (const int cells : {10, 14, 10}) {
    LatticeProblem<2> problem({cells, 12});
    problem.fix_bottom();
    const Vector values = problem.values(Vector(problem.cells.size(), 1.0), 0);
    const Vector b = random_vector(problem.size(), 1);
    solver.analyze(problem.pattern);
    EXPECT_EQ(solver.statistics().analyses, ++analyses);
    solver.analyze(problem.pattern);
    EXPECT_EQ(solver.statistics().analyses, analyses);
    EXPECT_EQ(solver.statistics().unknowns, problem.size());
    Vector x(b.size(), 0.0);
    EXPECT_TRUE(solver.solve(values, b, x).factorized);
    EXPECT_LE(norm(residual(problem.pattern, values, x, b)),
              1.001 * LaggedCholeskyOptions().relative_tolerance * norm(b));
  }
}

TEST(LaggedCholesky, SolvesNothing) {
  LaggedCholesky solver;
  solver.analyze({.column_begin = {0}, .row = {}});
  EXPECT_EQ(solver.solve({}, {}, {}).iterations, 0);
  EXPECT_EQ(solver.statistics().unknowns, 0);
}

/// The column that the solver names when it refuses; -1 if it does not.
int refused_column(LaggedCholesky& solver, const Vector& values, const Vector& b) {
  Vector x(b.size(), 0.0);
  try {
    solver.solve(values, b, x);
  } catch (const NotPositiveDefinite& error) {
    return error.column();
  }
  return -1;
}

TEST(LaggedCholesky, RefusesMatricesThatAreNotPositiveDefinite) {
  const LatticeProblem<2> problem = plane();
  const Vector good = problem.values(Vector(problem.cells.size(), 1.0), 0);
  const Vector b = random_vector(problem.size(), 1);
  const int unknown = 500;
  for (const bool with_factor : {false, true})
    for (const double diagonal : {-1.0, 0.0, std::numeric_limits<double>::quiet_NaN()}) {
      LaggedCholesky solver;
      solver.analyze(problem.pattern);
      if (with_factor) {
        EXPECT_EQ(refused_column(solver, good, b), -1);
      }
      Vector bad = good;
      // Without neighbours the fault is in this unknown alone.
      for (std::size_t j = 0; j < b.size(); ++j)
        for (int k = problem.pattern.column_begin[j]; k < problem.pattern.column_begin[j + 1]; ++k)
          if (static_cast<int>(j) == unknown || problem.pattern.row[static_cast<std::size_t>(k)] == unknown)
            bad[static_cast<std::size_t>(k)] = 0;
      bad[problem.diagonal_slot(unknown)] = diagonal;
      EXPECT_EQ(refused_column(solver, bad, b), unknown) << "diagonal " << diagonal;
      EXPECT_EQ(refused_column(solver, good, b), -1);  // and works again
    }
}

// Negative coefficients in one corner with positive diagonals elsewhere: conjugate gradients meet a direction of
// negative curvature, and the factorization that follows names an unknown there.
TEST(LaggedCholesky, FindsIndefiniteMatricesInTheCourseOfIterations) {
  const LatticeProblem<2> problem = plane();
  Vector values = problem.values(Vector(problem.cells.size(), 1.0), 0);
  const Vector b = random_vector(problem.size(), 1);
  LaggedCholesky solver;
  solver.analyze(problem.pattern);
  EXPECT_EQ(refused_column(solver, values, b), -1);
  for (int node = 600; node < 700; ++node) values[problem.diagonal_slot(node)] *= 0.1;
  EXPECT_GE(refused_column(solver, values, b), 0);
}

// Behind a gap of two cells, all the way up, lies an island with no fixed value, held by a storage of 1e-6 of the
// coefficients. Its load can go nowhere but into storage: the sum of storage times solution is the load.
TEST(LaggedCholesky, SolvesFreeIslands) {
  LatticeProblem<2> problem = plane();
  constexpr double storage = 1e-6;
  const auto column = [&](std::size_t node) { return problem.places[node][0]; };
  Vector coefficient(problem.cells.size(), 1.0);
  for (std::size_t c = 0; c < coefficient.size(); ++c) {
    const int i = column(static_cast<std::size_t>(problem.cells[c][0]));
    if (i == 20 || i == 21) coefficient[c] = 0;
  }
  Vector b = random_vector(problem.size(), 1), x(b.size(), 0.0);
  for (std::size_t node = 0; node < b.size(); ++node) {
    if (column(node) >= 20) problem.fixed[node] = 0;
    if (column(node) == 21) b[node] *= storage;  // nodes that nothing holds but their storage
  }
  LaggedCholesky solver;
  solver.analyze(problem.pattern);
  EXPECT_TRUE(solver.solve(problem.values(coefficient, storage), b, x).converged);
  const Vector stored = problem.values(Vector(coefficient.size(), 0.0), storage);
  double load = 0, taken = 0;
  for (std::size_t node = 0; node < b.size(); ++node)
    if (column(node) >= 22) load += b[node], taken += stored[problem.diagonal_slot(static_cast<int>(node))] * x[node];
  // A residual of 1e-10 ||b|| changes the sum by sqrt(n) = 36 times that at most; ||b|| is 20, and the load above 1.
  EXPECT_GT(std::abs(load), 1);
  EXPECT_NEAR(taken, load, 1e-7 * std::abs(load));
}

// Cells that a body fills to 1e-8 scale the unknown that only they support. Its row is small, and so is its load: a
// test on plain norms would not see it. Its solution must be as accurate as the others: here relative to the direct
// one, with the residual's 1e-10 times the condition number 1e4 of the scaled matrix.
TEST(LaggedCholesky, SolvesBadlyScaledCutCells) {
  const LatticeProblem<2> problem = plane();
  const DriftingCoefficients coefficients(problem.cells.size(), 1e-2);
  const int top = 30;
  Vector b = random_vector(problem.size(), 1), x(b.size(), 0.0);
  for (std::size_t node = 0; node < b.size(); ++node)
    if (problem.places[node][1] == top) b[node] *= 1e-8;
  LaggedCholesky solver;
  solver.analyze(problem.pattern);
  for (int step = 0; step < 10; ++step) {
    Vector coefficient = coefficients.at(step);
    for (std::size_t c = 0; c < coefficient.size(); ++c)
      if (problem.places[static_cast<std::size_t>(problem.cells[c][0])][1] == top - 1) coefficient[c] *= 1e-8;
    const Vector values = problem.values(coefficient, 0);
    const Vector direct = solve_directly(problem.pattern, values, b);
    EXPECT_TRUE(solver.solve(values, b, x).converged);
    for (std::size_t node = 0; node < b.size(); ++node)
      EXPECT_NEAR(x[node], direct[node], 1e-6 * norm(direct) / std::sqrt(static_cast<double>(b.size())));
  }
}

// Held by a storage of 1e-12 alone, the condition number is far beyond single precision, whose copy of the factor is
// off by 1e-7: a few iterations more, the same solution. The load sums to zero, or round-off would drown the tolerance.
TEST(LaggedCholesky, SolvesWhatSinglePrecisionCannotHold) {
  LatticeProblem<2> problem({40, 30});
  const Vector values = problem.values(Vector(problem.cells.size(), 1.0), 1e-12);
  Vector b = random_vector(problem.size(), 1), x(b.size(), 0.0);
  const double mean = std::accumulate(b.begin(), b.end(), 0.0) / static_cast<double>(b.size());
  for (double& load : b) load -= mean;
  LaggedCholesky solver;
  solver.analyze(problem.pattern);
  const auto report = solver.solve(values, b, x);
  EXPECT_TRUE(report.converged);
  EXPECT_LE(report.iterations, 10);
  EXPECT_LE(norm(residual(problem.pattern, values, x, b)),
            1.001 * LaggedCholeskyOptions().relative_tolerance * norm(b));
}

// Seven digits of the factor, times the condition number of 1e3, leave three digits at least. Scaling the matrix by
// powers of two changes nothing, even beyond the range of single precision.
TEST(PackedFactor, SolvesToSinglePrecision) {
  const LatticeProblem<2> problem = plane();
  for (const double factor : {1.0, 0x1p-200, 0x1p200}) {
    Vector values = problem.values(Vector(problem.cells.size(), 1.0), 1e-2);
    for (double& value : values) value *= factor;
    Vector b = random_vector(problem.size(), 1), x(b.size()), inverse_diagonal(b.size());
    for (std::size_t i = 0; i < b.size(); ++i)
      inverse_diagonal[i] = 1 / values[problem.diagonal_slot(static_cast<int>(i))];
    SparseCholesky cholesky({.permutation = {}, .dense_blocks = true});
    cholesky.analyze(problem.pattern);
    cholesky.factorize(values);
    PackedFactor packed;
    packed.copy(cholesky, inverse_diagonal);
    packed.solve(b, 1 / std::sqrt(factor), x);
    Vector direct(b.size());
    cholesky.solve(b, direct);
    EXPECT_LT(difference(x, direct), 1e-4 * norm(direct));
    EXPECT_GT(difference(x, direct), 1e-9 * norm(direct));
  }
}

template <int Dim>
std::int64_t fill(const LatticeProblem<Dim>& problem, Ordering ordering) {
  SparseCholesky cholesky({.ordering = ordering, .permutation = nested_dissection<Dim>(problem.places)});
  cholesky.analyze(problem.pattern);
  return cholesky.statistics().factor_nonzeros;
}

// METIS searches the graph for its separators, geometry takes straight lines: near each other on a rectangle.
TEST(NestedDissection, FillsLittleMoreThanMetis) {
  const LatticeProblem<2> square({99, 99});
  EXPECT_LT(static_cast<double>(fill(square, Ordering::given)),
            1.2 * static_cast<double>(fill(square, Ordering::nested_dissection)));
  const LatticeProblem<3> cube({15, 15, 15});
  EXPECT_LT(static_cast<double>(fill(cube, Ordering::given)),
            1.2 * static_cast<double>(fill(cube, Ordering::nested_dissection)));
}

template <int Dim>
void expect_permutation(const std::vector<std::array<int, Dim>>& places) {
  std::vector<int> order = nested_dissection<Dim>(places), expected(places.size());
  std::iota(expected.begin(), expected.end(), 0);
  std::sort(order.begin(), order.end());
  EXPECT_EQ(order, expected);
}

TEST(NestedDissection, IsAPermutationOfAnyPlaces) {
  expect_permutation<2>({});
  expect_permutation<1>({{3}, {1}, {2}});
  expect_permutation<2>(LatticeProblem<2>({40, 3}).places);
  expect_permutation<3>(LatticeProblem<3>({7, 8, 9}).places);
  // Scattered, with gaps, negative coordinates, and all on one line.
  std::mt19937 random(1);
  std::vector<std::array<int, 2>> scattered, line;
  for (int i = 0; i < 3000; ++i) {
    scattered.push_back({static_cast<int>(random() % 100000) - 50000, static_cast<int>(random() % 7)});
    line.push_back({5, -3 * i});
  }
  expect_permutation<2>(scattered);
  expect_permutation<2>(line);
}

}  // namespace
}  // namespace sluice
