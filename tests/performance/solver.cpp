#include "solver.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <string>
#include <vector>

#include "solvers/lagged_cholesky.h"
#include "solvers/stopwatch.h"
#include "tests/lattice_problem.h"

namespace {

using namespace sluice;

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

/// Median seconds over some repetitions of factorization and solution, after one that is not counted.
template <int Dim>
void compare_orderings(const LatticeProblem<Dim>& problem, int repetitions) {
  const std::vector<double> coefficient = DriftingCoefficients(problem.cells.size(), 0).at(0);
  const std::vector<double> values = problem.values(coefficient, 1e-3);
  std::vector<double> b(static_cast<std::size_t>(problem.size()), 1.0), x = b, inverse_diagonal = b;
  for (int i = 0; i < problem.size(); ++i)
    inverse_diagonal[static_cast<std::size_t>(i)] = 1 / values[problem.diagonal_slot(i)];
  const auto row = [&](const std::string& name, SparseCholeskyOptions options, double order_seconds) {
    SparseCholesky cholesky(std::move(options));
    cholesky.analyze(problem.pattern);
    std::vector<double> factorize, solve, packed_solve;
    PackedFactor packed;
    for (int i = 0; i <= repetitions; ++i) {
      const SparseCholeskyStatistics before = cholesky.statistics();
      cholesky.factorize(values);
      cholesky.solve(b, x);
      packed.copy(cholesky, inverse_diagonal);
      double packed_seconds = 0;
      {
        const Stopwatch stopwatch(packed_seconds);
        packed.solve(b, 1, x);
      }
      if (i == 0) continue;
      packed_solve.push_back(packed_seconds);
      factorize.push_back(cholesky.statistics().factorize_seconds - before.factorize_seconds);
      solve.push_back(cholesky.statistics().solve_seconds - before.solve_seconds);
    }
    const SparseCholeskyStatistics& s = cholesky.statistics();
    fmt::print("  {:<4}{:>9}  {:<16}{:>11.1f}{:>11.2f}{:>11.1f}{:>11.1f}{:>11.2f}{:>11.2f}\n", fmt::format("{}-D", Dim),
               problem.size(), name, static_cast<double>(s.factor_nonzeros) / 1e5, s.flops / 1e9,
               1e3 * (s.analyze_seconds + order_seconds), 1e3 * median(factorize), 1e3 * median(solve),
               1e3 * median(packed_solve));
  };
  double seconds = 0;
  std::vector<int> order;
  {
    const Stopwatch stopwatch(seconds);
    order = nested_dissection<Dim>(problem.places);
  }
  row("minimum degree", {.ordering = Ordering::minimum_degree, .permutation = {}, .dense_blocks = true}, 0);
  row("METIS", {.ordering = Ordering::nested_dissection, .permutation = {}, .dense_blocks = true}, 0);
  row("geometric", {.ordering = Ordering::given, .permutation = order, .dense_blocks = true}, seconds);
}

/// The same drifting systems for a solver that factorizes every step and one that keeps its factor, in turns; each has
/// its last solution for a guess.
template <int Dim>
void replay(const LatticeProblem<Dim>& problem, double drift, int steps) {
  LaggedCholesky direct({.choice = LaggedCholeskyOptions::Choice::direct}), counted,
      measured({.choice = LaggedCholeskyOptions::Choice::measured});
  const std::array<LaggedCholesky*, 3> solvers = {&direct, &counted, &measured};
  const DriftingCoefficients coefficients(problem.cells.size(), drift);
  std::vector<double> b(static_cast<std::size_t>(problem.size()), 1.0);
  std::array<std::vector<double>, 3> x;
  x.fill(std::vector<double>(b.size(), 0.0));
  for (LaggedCholesky* solver : solvers) solver->analyze(problem.pattern, nested_dissection<Dim>(problem.places));
  for (int step = 0; step < steps; ++step) {
    const std::vector<double> values = problem.values(coefficients.at(step), 1e-3);
    for (std::size_t i = 0; i < solvers.size(); ++i) solvers[i]->solve(values, b, x[i]);
  }
  const auto seconds = [&](const LaggedCholesky& solver) {
    return (solver.statistics().factorize_seconds + solver.statistics().solve_seconds) / steps;
  };
  fmt::print("  {:<4}{:>9}{:>8}  {:<18}{:>12.2f}", fmt::format("{}-D", Dim), problem.size(), drift,
             direct.statistics().ordering, 1e3 * seconds(direct));
  for (const LaggedCholesky* solver : {&counted, &measured}) {
    const LaggedCholeskyStatistics& s = solver->statistics();
    fmt::print("{:>10.2f}{:>7.2f}{:>8.1f}{:>6.1f}", 1e3 * seconds(*solver), seconds(direct) / seconds(*solver),
               static_cast<double>(steps) / s.factorizations, static_cast<double>(s.iterations) / steps);
  }
  fmt::print("\n");
}

}  // namespace

void measure_solvers(bool smoke) {
  std::setvbuf(stdout, nullptr, _IOLBF, 0);  // long rows come late
  const std::vector<int> planes = smoke ? std::vector{20} : std::vector{74, 149, 299, 599};
  const std::vector<int> cubes = smoke ? std::vector{6} : std::vector{19, 31};
  const auto plane = [](int cells) {
    LatticeProblem<2> problem({cells, cells});
    problem.fix_bottom();
    return problem;
  };
  const auto cube = [](int cells) {
    LatticeProblem<3> problem({cells, cells, cells});
    problem.fix_bottom();
    return problem;
  };
  const auto repetitions = [&](int size) { return smoke ? 1 : size < 50000 ? 9 : 3; };
  fmt::print("One system, one thread. Entries of the factor in 10^5, its operations in 10^9, times in ms\n");
  fmt::print("  {:<4}{:>9}  {:<16}{:>11}{:>11}{:>11}{:>11}{:>11}{:>11}\n", "", "unknowns", "order", "entries",
             "operations", "analyze", "factorize", "solve", "packed");
  for (const int cells : planes) compare_orderings(plane(cells), repetitions(cells * cells));
  for (const int cells : cubes) compare_orderings(cube(cells), repetitions(cells * cells * cells));

  fmt::print(
      "\nSequences. Time of a step in ms with a factorization in each, and with a kept factor: counted and measured"
      " choice,\n  each with its speed-up, steps to a factorization, iterations a step\n");
  fmt::print("  {:<4}{:>9}{:>8}  {:<18}{:>12}{:>31}{:>31}\n", "", "unknowns", "drift", "order", "always", "counted",
             "measured");
  const auto steps = [&](int size) {
    return smoke ? 3 : size < 10000 ? 100 : size < 50000 ? 40 : size < 200000 ? 20 : 8;
  };
  for (const double drift : {1e-3, 1e-2}) {
    for (const int cells : planes) replay(plane(cells), drift, steps(cells * cells));
    for (const int cells : cubes) replay(cube(cells), drift, cells > 20 ? steps(100000) : steps(20000));
  }
}
