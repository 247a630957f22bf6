/// SparseCholesky against dense factorizations, exact discrete solutions, and matrices that it must refuse.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "solvers/sparse_cholesky.h"

namespace sluice {
namespace {

using Matrix = SparseCholesky::Matrix;
using Triplets = std::vector<Eigen::Triplet<double>>;

Matrix from_triplets(int size, const Triplets& triplets) {
  Matrix matrix(size, size);
  matrix.setFromTriplets(triplets.begin(), triplets.end());
  return matrix;
}

/// B Bᵀ + I with sparse random B: positive definite, smallest eigenvalue at least one.
Matrix random_positive_definite(int size, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> value(-1, 1);
  std::uniform_int_distribution<int> index(0, size - 1);
  Triplets triplets;
  for (int k = 0; k < 3 * size; ++k) triplets.emplace_back(index(random), index(random), value(random));
  const Matrix b = from_triplets(size, triplets);
  Matrix identity(size, size);
  identity.setIdentity();
  Matrix matrix = Matrix(b * b.transpose()) + identity;
  matrix.makeCompressed();
  return matrix;
}

Eigen::VectorXd random_vector(int size, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> value(-1, 1);
  return Eigen::VectorXd::NullaryExpr(size, [&] { return value(random); });
}

/// Five-point Laplacian (4 on the diagonal, -1 to the neighbours) on `cells` x `cells` unknowns. With `fixed`, the
/// values outside are zero; without, no flux crosses the border, and constants lie in the null space.
Matrix laplacian(int cells, bool fixed) {
  Triplets triplets;
  const auto unknown = [&](int i, int j) { return i + cells * j; };
  for (int j = 0; j < cells; ++j)
    for (int i = 0; i < cells; ++i)
      for (const auto& [di, dj] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
        const int ni = i + di, nj = j + dj;
        const bool inside = ni >= 0 && ni < cells && nj >= 0 && nj < cells;
        if (inside || fixed) triplets.emplace_back(unknown(i, j), unknown(i, j), 1.0);
        if (inside) triplets.emplace_back(unknown(i, j), unknown(ni, nj), -1.0);
      }
  return from_triplets(cells * cells, triplets);
}

TEST(SparseCholesky, EqualsDenseFactorization) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const int size = 20 * static_cast<int>(seed);
    const Matrix a = random_positive_definite(size, seed);
    const Eigen::VectorXd b = random_vector(size, seed + 100);
    SparseCholesky cholesky;
    cholesky.factorize(a);
    const Eigen::VectorXd dense = Eigen::MatrixXd(a).llt().solve(b);
    EXPECT_LT((cholesky.solve(b) - dense).norm(), 1e-12 * dense.norm()) << "seed " << seed;
  }
}

TEST(SparseCholesky, ReadsTheLowerTriangleOnly) {
  const Matrix full = random_positive_definite(40, 7);
  const Matrix lower = full.triangularView<Eigen::Lower>();
  const Eigen::VectorXd b = random_vector(40, 8);
  SparseCholesky of_full, of_lower;
  of_full.factorize(full);
  of_lower.factorize(lower);
  EXPECT_LT((of_full.solve(b) - of_lower.solve(b)).norm(), 1e-14 * b.norm());
}

// sin(pi x) sin(pi y), sampled at the nodes, is an eigenvector of the discrete Laplacian with zero values outside, and
// 8 sin²(pi h / 2) its eigenvalue: the discrete solution is known exactly. 150² unknowns take the path of dense blocks.
TEST(SparseCholesky, SolvesTheLaplacianExactlyForEveryOrdering) {
  constexpr int cells = 150;
  constexpr double h = 1.0 / (cells + 1), pi = std::numbers::pi;
  const double eigenvalue = 8 * std::pow(std::sin(pi * h / 2), 2);
  Eigen::VectorXd mode(cells * cells);
  for (int j = 0; j < cells; ++j)
    for (int i = 0; i < cells; ++i) mode[i + cells * j] = std::sin(pi * (i + 1) * h) * std::sin(pi * (j + 1) * h);

  std::vector<int> reversed(cells * cells);
  std::iota(reversed.rbegin(), reversed.rend(), 0);
  const Matrix a = laplacian(cells, true);
  for (const SparseCholeskyOptions& options : {SparseCholeskyOptions{},
                                               {.ordering = Ordering::nested_dissection, .permutation = {}},
                                               {.ordering = Ordering::natural, .permutation = {}},
                                               {.ordering = Ordering::given, .permutation = reversed}}) {
    SparseCholesky cholesky(options);
    cholesky.factorize(a);
    // The condition number is 4/(pi h)² = 1e4: round-off of 1e-16 grows to 1e-12 at most.
    EXPECT_LT((cholesky.solve(eigenvalue * mode) - mode).norm(), 1e-11 * mode.norm())
        << "ordering " << static_cast<int>(options.ordering);
  }
}

TEST(SparseCholesky, FillReducingOrderingsShrinkTheFactor) {
  const Matrix a = laplacian(80, true);
  std::vector<std::int64_t> nonzeros;
  for (const Ordering ordering : {Ordering::automatic, Ordering::nested_dissection, Ordering::natural}) {
    SparseCholesky cholesky({.ordering = ordering, .permutation = {}});
    cholesky.analyze(a);
    nonzeros.push_back(cholesky.statistics().factor_nonzeros);
  }
  // Natural order fills the band: 80² columns of 80 entries.
  EXPECT_NEAR(static_cast<double>(nonzeros[2]), 80.0 * 80 * 80, 0.1 * 80 * 80 * 80);
  EXPECT_LT(nonzeros[0], nonzeros[2] / 3);
  EXPECT_LT(nonzeros[1], nonzeros[2] / 3);
}

TEST(SparseCholesky, KeepsTheAnalysisWhileThePatternIsTheSame) {
  const Matrix a = laplacian(20, true);
  const Matrix twice = 2 * a;
  const Eigen::VectorXd b = random_vector(400, 3);
  SparseCholesky cholesky;
  EXPECT_TRUE(cholesky.analyze(a));
  EXPECT_FALSE(cholesky.analyze(twice));
  cholesky.factorize(a);
  const Eigen::VectorXd x = cholesky.solve(b);
  cholesky.factorize(twice);
  EXPECT_LT((2 * cholesky.solve(b) - x).norm(), 1e-13 * x.norm());
  EXPECT_EQ(cholesky.statistics().analyses, 1);
  EXPECT_EQ(cholesky.statistics().factorizations, 2);
  EXPECT_EQ(cholesky.statistics().solves, 2);
  EXPECT_GT(cholesky.statistics().flops, 0);

  // As many unknowns and entries, but elsewhere: another pattern.
  Triplets first{{0, 0, 2.0}, {1, 1, 2.0}, {2, 2, 2.0}, {1, 0, 1.0}}, second = first;
  second.back() = {2, 0, 1.0};
  cholesky.factorize(from_triplets(3, first));
  cholesky.factorize(from_triplets(3, second));
  EXPECT_EQ(cholesky.statistics().analyses, 3);
  const Eigen::Vector3d expected(1, 1, 1);
  EXPECT_LT((cholesky.solve(Eigen::Vector3d(3, 2, 3)) - expected).norm(), 1e-15);
}

// One step of refinement with the same factor brings the residual down to round-off. It is measured against b for the
// plain Laplacian, and against |A| |x| + |b|, component by component, where coefficients differ by 1e8, as at a stiff
// inclusion: there b alone is far smaller than the terms that cancel.
TEST(SparseCholesky, RefinementReachesRoundOff) {
  constexpr int size = 60 * 60;
  const Matrix plain = laplacian(60, true);
  Eigen::VectorXd scale = Eigen::VectorXd::Ones(size);
  for (int i = 0; i < size; i += 7) scale[i] = 1e4;
  Matrix contrast = scale.asDiagonal() * plain * scale.asDiagonal();
  contrast.makeCompressed();
  const Eigen::VectorXd b = random_vector(size, 5);
  for (const bool is_plain : {true, false}) {
    const Matrix& a = is_plain ? plain : contrast;
    SparseCholesky cholesky;
    cholesky.factorize(a);
    Eigen::VectorXd x = cholesky.solve(b);
    x += cholesky.solve(b - a * x);
    const Eigen::VectorXd residual = b - a * x, terms = a.cwiseAbs() * x.cwiseAbs() + b.cwiseAbs();
    EXPECT_LT((residual.array() / terms.array()).abs().maxCoeff(), 1e-15);
    if (is_plain) {
      EXPECT_LT(residual.norm(), 1e-12 * b.norm());
    }
  }
}

TEST(SparseCholesky, RefusesAnIndefiniteMatrixAndNamesTheColumn) {
  // Unknown 2 stands alone with a negative diagonal: no other column can be blamed.
  const Matrix a = from_triplets(4, {{0, 0, 2.0}, {1, 1, 2.0}, {1, 0, -1.0}, {2, 2, -3.0}, {3, 3, 1.0}});
  SparseCholesky cholesky;
  try {
    cholesky.factorize(a);
    FAIL() << "an indefinite matrix was factorized";
  } catch (const NotPositiveDefinite& error) {
    EXPECT_EQ(error.column(), 2);
    EXPECT_NE(std::string(error.what()).find("unknown 2 (its diagonal entry is -3)"), std::string::npos)
        << error.what();
  }
  // The analysis is still good for a definite matrix of the same pattern.
  Matrix repaired = a;
  repaired.coeffRef(2, 2) = 3.0;
  cholesky.factorize(repaired);
  EXPECT_EQ(cholesky.statistics().analyses, 1);
  EXPECT_NEAR(cholesky.solve(Eigen::Vector4d(0, 0, 6, 0))[2], 2.0, 1e-15);
}

TEST(SparseCholesky, RefusesIndefiniteMatricesOnEveryPath) {
  for (const int cells : {10, 150}) {  // single columns, dense blocks
    Matrix a = laplacian(cells, true);
    // Below the smallest eigenvalue every pivot is positive; above it, one is not.
    const double smallest = 8 * std::pow(std::sin(std::numbers::pi / (cells + 1) / 2), 2);
    Matrix identity(a.rows(), a.cols());
    identity.setIdentity();
    SparseCholesky cholesky;
    EXPECT_NO_THROW(cholesky.factorize(Matrix(a - 0.99 * smallest * identity)));
    EXPECT_THROW(cholesky.factorize(Matrix(a - 1.01 * smallest * identity)), NotPositiveDefinite);
  }
}

// With no fixed value anywhere the last pivot is zero but for round-off, of either sign.
TEST(SparseCholesky, RefusesSingularMatrices) {
  for (const Ordering ordering : {Ordering::automatic, Ordering::nested_dissection, Ordering::natural})
    for (const int cells : {2, 3, 10, 33, 100, 200}) {
      SparseCholesky cholesky({.ordering = ordering, .permutation = {}});
      EXPECT_THROW(cholesky.factorize(laplacian(cells, false)), NotPositiveDefinite)
          << cells << " cells, ordering " << static_cast<int>(ordering);
    }
}

// The same, held at a single point by a spring a million times softer than the rest: singular it is not.
TEST(SparseCholesky, AcceptsAMatrixHeldAtOnePoint) {
  for (const int cells : {2, 10, 100, 200}) {
    Matrix a = laplacian(cells, false);
    a.coeffRef(0, 0) += 1e-6;
    SparseCholesky cholesky;
    EXPECT_NO_THROW(cholesky.factorize(a)) << cells << " cells";
  }
}

TEST(SparseCholesky, RefusesValuesThatAreNotFinite) {
  Matrix a = laplacian(5, true);
  a.coeffRef(7, 7) = std::numeric_limits<double>::quiet_NaN();
  SparseCholesky cholesky;
  EXPECT_THROW(cholesky.factorize(a), NotPositiveDefinite);
}

TEST(SparseCholesky, CanBeMoved) {
  const Matrix a = laplacian(8, true);
  const Eigen::VectorXd b = random_vector(64, 1);
  SparseCholesky first;
  first.factorize(a);
  const Eigen::VectorXd x = first.solve(b);
  SparseCholesky second(std::move(first));
  EXPECT_EQ(second.solve(b), x);
  SparseCholesky third;
  third.factorize(laplacian(4, true));
  third = std::move(second);
  EXPECT_EQ(third.solve(b), x);
  EXPECT_EQ(third.statistics().factorizations, 1);
}

}  // namespace
}  // namespace sluice
