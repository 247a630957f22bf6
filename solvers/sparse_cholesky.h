/// SparseCholesky: solves A x = b for sparse, symmetric, positive definite A, by SuiteSparse CHOLMOD.
///
///   SparseCholesky cholesky;
///   cholesky.factorize(stiffness);
///   displacement = cholesky.solve(force);
///
/// The symbolic analysis (ordering and pattern of the factor) depends on the pattern of A alone. It is made once and
/// kept until a matrix of another pattern arrives; factorizing new values on a known pattern is the cheap path.
///
/// Reference: Y. Chen, T. A. Davis, W. W. Hager, S. Rajamanickam, Algorithm 887: CHOLMOD, supernodal sparse Cholesky
/// factorization and update/downdate, ACM Trans. Math. Softw. 35 (2008).
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <cstdint>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace sluice {

/// The matrix has no Cholesky factor, or none that can be told from round-off.
class NotPositiveDefinite : public std::runtime_error {
 public:
  NotPositiveDefinite(int column, const std::string& message) : std::runtime_error(message), column_(column) {}
  /// Row and column of A, from 0, at which the elimination failed. The fault lies in the unknowns that are connected to
  /// this one, not necessarily in this one.
  int column() const { return column_; }

 private:
  int column_;
};

/// Pattern of a symmetric matrix: its lower triangle, every diagonal entry included, in compressed columns with rows
/// ascending. The values of a matrix of this pattern are an array of numbers, one for each entry of `row`.
struct SymmetricPattern {
  std::vector<int> column_begin;  ///< where each column begins in `row`; one more entry holds the end of the last
  std::vector<int> row;
  int size() const { return column_begin.empty() ? 0 : static_cast<int>(column_begin.size()) - 1; }
  bool operator==(const SymmetricPattern&) const = default;
};

/// The order in which unknowns are eliminated; it decides how many entries the factor has.
enum class Ordering {
  automatic,          ///< approximate minimum degree; METIS too where the factor comes out very dense. Quick to find.
  minimum_degree,     ///< approximate minimum degree (AMD), whatever the factor becomes
  nested_dissection,  ///< METIS: slower to find; less work where n is large, above all in 3-D
  natural,            ///< the unknowns as they are numbered
  given               ///< `SparseCholeskyOptions::permutation`, for example dissection of a grid by its indices
};

struct SparseCholeskyOptions {
  Ordering ordering = Ordering::automatic;
  std::vector<int> permutation;  ///< for Ordering::given: permutation[k] is the unknown eliminated k-th
  /// Threads of the dense kernels (OpenBLAS). The default, one, keeps the last bits of the solution independent of the
  /// machine; more pay for n above about 1e5 in 2-D and 1e4 in 3-D.
  int blas_threads = 1;
  bool dense_blocks = false;  ///< gather columns in dense blocks even where single columns are less work (small n)
};

struct SparseCholeskyStatistics {
  int analyses = 0;
  int factorizations = 0;
  int solves = 0;
  double analyze_seconds = 0;  ///< wall-clock, all analyses together; likewise the next two
  double factorize_seconds = 0;
  double solve_seconds = 0;
  std::int64_t factor_nonzeros = 0;  ///< entries of the factor L, last analysis
  double flops = 0;                  ///< floating-point operations of one factorization, last analysis
  bool supernodal = false;           ///< last analysis chose dense blocks rather than single columns
};

class SparseCholesky {
 public:
  /// What CHOLMOD takes: columns compressed, int indices.
  using Matrix = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;

  explicit SparseCholesky(SparseCholeskyOptions options = {});
  ~SparseCholesky();
  SparseCholesky(SparseCholesky&&) noexcept;
  SparseCholesky& operator=(SparseCholesky&&) noexcept;

  /// Analyses the pattern of `matrix` unless it is that of the previous call; true if it did. The matrix is square,
  /// compressed, and either full or its lower triangle; the strict upper triangle is not read.
  bool analyze(const Matrix& matrix);
  bool analyze(SymmetricPattern pattern);

  /// Factorizes, after `analyze` where that is needed. Throws NotPositiveDefinite; then the analysis stays valid, and
  /// `solve` is not allowed until a factorization succeeds.
  void factorize(const Matrix& matrix);
  /// The same for the values of the analysed pattern, in its order.
  void factorize(std::span<const double> values);

  /// The solution of A x = b with the last factorized A; b has as many rows as A.
  Eigen::VectorXd solve(const Eigen::VectorXd& b);
  /// The same without allocating memory; x may be b.
  void solve(std::span<const double> b, std::span<double> x);

  /// What was analysed last. For an Eigen matrix that was full, both triangles.
  const SymmetricPattern& pattern() const;
  /// The order of elimination of the last analysis: unknown `elimination_order()[k]` is eliminated k-th.
  std::span<const int> elimination_order() const;

  /// CHOLMOD's factor L of dense blocks: block k has columns [first_column[k], first_column[k + 1]), rows
  /// row[first_row[k]...first_row[k + 1]), of which the first are its columns, and values by columns from
  /// first_value[k]. Rows and columns are in the order of elimination.
  struct DenseBlocks {
    std::span<const int> first_column, first_row, first_value, row;
    std::span<const double> value;
  };
  /// Of the last factorization, which had SparseCholeskyOptions::dense_blocks.
  DenseBlocks dense_blocks() const;

  const SparseCholeskyStatistics& statistics() const { return statistics_; }

 private:
  struct Factor;  // the CHOLMOD objects
  std::unique_ptr<Factor> factor_;
  SparseCholeskyOptions options_;
  SparseCholeskyStatistics statistics_;
};

}  // namespace sluice
