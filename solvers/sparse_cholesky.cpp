#include "solvers/sparse_cholesky.h"

#include <cblas.h>
#include <cholmod.h>
#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <chrono>
#include <cmath>
#include <limits>
#include <new>
#include <utility>

namespace sluice {
namespace {

/// Adds the time between its construction and its end to `total` [s].
class Stopwatch {
 public:
  explicit Stopwatch(double& total) : total_(total) {}
  ~Stopwatch() { total_ += std::chrono::duration<double>(Clock::now() - start_).count(); }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  using Clock = std::chrono::steady_clock;
  double& total_;
  Clock::time_point start_ = Clock::now();
};

/// OpenBLAS has one number of threads for the whole program: sets it, and restores it at its end.
class BlasThreads {
 public:
  explicit BlasThreads(int threads) : previous_(openblas_get_num_threads()) { openblas_set_num_threads(threads); }
  ~BlasThreads() { openblas_set_num_threads(previous_); }
  BlasThreads(const BlasThreads&) = delete;
  BlasThreads& operator=(const BlasThreads&) = delete;

 private:
  int previous_;
};

/// CHOLMOD's view of the lower triangle of `matrix`, with no copy. CHOLMOD does not write to it.
cholmod_sparse view_lower(const SparseCholesky::Matrix& matrix) {
  cholmod_sparse view{};
  view.nrow = static_cast<std::size_t>(matrix.rows());
  view.ncol = static_cast<std::size_t>(matrix.cols());
  view.nzmax = static_cast<std::size_t>(matrix.nonZeros());
  view.p = const_cast<int*>(matrix.outerIndexPtr());
  view.i = const_cast<int*>(matrix.innerIndexPtr());
  view.x = const_cast<double*>(matrix.valuePtr());
  view.stype = -1;
  view.itype = CHOLMOD_INT;
  view.xtype = CHOLMOD_REAL;
  view.dtype = CHOLMOD_DOUBLE;
  view.sorted = 1;
  view.packed = 1;
  return view;
}

cholmod_dense view_column(const Eigen::VectorXd& vector) {
  cholmod_dense view{};
  view.nrow = view.nzmax = view.d = static_cast<std::size_t>(vector.size());
  view.ncol = 1;
  view.x = const_cast<double*>(vector.data());
  view.xtype = CHOLMOD_REAL;
  view.dtype = CHOLMOD_DOUBLE;
  return view;
}

void require_success(const cholmod_common& common, const char* action) {
  if (common.status == CHOLMOD_OUT_OF_MEMORY) throw std::bad_alloc();
  if (common.status < CHOLMOD_OK)
    throw std::runtime_error(fmt::format("CHOLMOD could not {} the matrix: status {}{}", action, common.status,
                                         common.status == CHOLMOD_TOO_LARGE ? ", too large for int indices" : ""));
}

/// The diagonal of the factor L (A = L Lᵀ), in the order of elimination.
std::vector<double> factor_diagonal(const cholmod_factor& factor) {
  const auto* x = static_cast<const double*>(factor.x);
  std::vector<double> diagonal(factor.n);
  if (factor.is_super != 0) {
    const auto* first_column = static_cast<const int*>(factor.super);
    const auto* first_row = static_cast<const int*>(factor.pi);
    const auto* first_value = static_cast<const int*>(factor.px);
    for (std::size_t block = 0; block < factor.nsuper; ++block) {
      const int rows = first_row[block + 1] - first_row[block];
      for (int column = first_column[block]; column < first_column[block + 1]; ++column) {
        const auto offset = static_cast<std::ptrdiff_t>(column - first_column[block]) * (rows + 1);
        diagonal[static_cast<std::size_t>(column)] = x[first_value[block] + offset];
      }
    }
  } else {
    const auto* start = static_cast<const int*>(factor.p);
    for (std::size_t column = 0; column < factor.n; ++column) diagonal[column] = x[start[column]];
  }
  return diagonal;
}

[[noreturn]] void throw_not_positive_definite(int column, double diagonal, const std::string& what) {
  throw NotPositiveDefinite(
      column,
      fmt::format("the matrix is not positive definite: {} at unknown {} (its diagonal entry is {:g}). Either a "
                  "diagonal entry or a coefficient is not positive, or this unknown and those connected to it "
                  "are held by nothing, so that they can move without resistance",
                  what, column, diagonal));
}

}  // namespace

struct SparseCholesky::Factor {
  struct Finish {
    void operator()(cholmod_common* common) const {
      cholmod_finish(common);
      delete common;
    }
  };
  struct Free {
    cholmod_common* common;
    void operator()(cholmod_factor* factor) const { cholmod_free_factor(&factor, common); }
    void operator()(cholmod_dense* vector) const { cholmod_free_dense(&vector, common); }
  };

  Factor();
  void choose_ordering(const SparseCholeskyOptions& options);
  bool has_pattern(const Matrix& matrix) const;
  void keep_pattern(const Matrix& matrix);
  /// Unknown that is eliminated at `position`.
  int unknown(std::size_t position) const { return static_cast<const int*>(lower->Perm)[position]; }
  void require_positive_pivots(const Matrix& matrix) const;

  std::unique_ptr<cholmod_common, Finish> common;
  std::unique_ptr<cholmod_factor, Free> lower;  // declared after `common`, which it needs to be freed
  std::vector<int> outer, inner;                // pattern of the analysed matrix
  bool factorized = false;
};

SparseCholesky::Factor::Factor() : common(new cholmod_common), lower(nullptr, Free{common.get()}) {
  cholmod_start(common.get());
  common->print = 0;
  // L Lᵀ, because CHOLMOD's L D Lᵀ, its default for sparse factors, accepts negative pivots.
  common->final_ll = 1;
}

void SparseCholesky::Factor::choose_ordering(const SparseCholeskyOptions& options) {
  if (options.ordering == Ordering::automatic) return;
  common->nmethods = 1;
  common->method[0].ordering = options.ordering == Ordering::nested_dissection ? CHOLMOD_METIS
                               : options.ordering == Ordering::natural         ? CHOLMOD_NATURAL
                                                                               : CHOLMOD_GIVEN;
}

bool SparseCholesky::Factor::has_pattern(const Matrix& matrix) const {
  const auto columns = static_cast<std::size_t>(matrix.cols()), entries = static_cast<std::size_t>(matrix.nonZeros());
  return lower && outer.size() == columns + 1 && inner.size() == entries &&
         std::equal(outer.begin(), outer.end(), matrix.outerIndexPtr()) &&
         std::equal(inner.begin(), inner.end(), matrix.innerIndexPtr());
}

void SparseCholesky::Factor::keep_pattern(const Matrix& matrix) {
  outer.assign(matrix.outerIndexPtr(), matrix.outerIndexPtr() + matrix.cols() + 1);
  inner.assign(matrix.innerIndexPtr(), matrix.innerIndexPtr() + matrix.nonZeros());
}

/// A singular matrix often passes the factorization with a pivot that is nothing but round-off. A pivot is the diagonal
/// entry less a sum of squares, whose round-off is at most n epsilon times that entry (N. J. Higham, Accuracy and
/// Stability of Numerical Algorithms, 2nd ed. 2002, theorem 10.3): a pivot below it says nothing. The converse fails:
/// with coefficients of very different size a singular matrix can still pass.
void SparseCholesky::Factor::require_positive_pivots(const Matrix& matrix) const {
  const Eigen::VectorXd diagonal = matrix.diagonal();
  if (common->status == CHOLMOD_NOT_POSDEF) {
    const int column = unknown(lower->minor);
    throw_not_positive_definite(column, diagonal[column], "the pivot is not positive");
  }
  const std::vector<double> factor = factor_diagonal(*lower);
  const double round_off = std::numeric_limits<double>::epsilon() * static_cast<double>(diagonal.size());
  for (std::size_t position = 0; position < factor.size(); ++position) {
    const int column = unknown(position);
    const double pivot = factor[position] * factor[position];
    if (!(pivot > round_off * diagonal[column]) || !std::isfinite(pivot))
      throw_not_positive_definite(column, diagonal[column], fmt::format("the pivot {:g} is round-off", pivot));
  }
}

SparseCholesky::SparseCholesky(SparseCholeskyOptions options)
    : factor_(std::make_unique<Factor>()), options_(std::move(options)) {
  assert(options_.blas_threads >= 1);
  factor_->choose_ordering(options_);
}

SparseCholesky::~SparseCholesky() = default;
SparseCholesky::SparseCholesky(SparseCholesky&&) noexcept = default;
SparseCholesky& SparseCholesky::operator=(SparseCholesky&&) noexcept = default;

bool SparseCholesky::analyze(const Matrix& matrix) {
  assert(matrix.rows() == matrix.cols() && matrix.rows() > 0 && matrix.isCompressed());
  if (factor_->has_pattern(matrix)) return false;
  const Stopwatch stopwatch(statistics_.analyze_seconds);
  const bool given = options_.ordering == Ordering::given;
  assert(!given || options_.permutation.size() == static_cast<std::size_t>(matrix.rows()));

  cholmod_common* common = factor_->common.get();
  cholmod_sparse view = view_lower(matrix);
  factor_->factorized = false;
  factor_->lower.reset(cholmod_analyze_p(&view, given ? options_.permutation.data() : nullptr, nullptr, 0, common));
  require_success(*common, "analyse");
  factor_->keep_pattern(matrix);
  ++statistics_.analyses;
  statistics_.factor_nonzeros = static_cast<std::int64_t>(common->lnz);
  statistics_.flops = common->fl;
  statistics_.supernodal = factor_->lower->is_super != 0;
  return true;
}

void SparseCholesky::factorize(const Matrix& matrix) {
  analyze(matrix);
  const Stopwatch stopwatch(statistics_.factorize_seconds);
  const BlasThreads threads(options_.blas_threads);
  cholmod_common* common = factor_->common.get();
  cholmod_sparse view = view_lower(matrix);
  factor_->factorized = false;
  cholmod_factorize(&view, factor_->lower.get(), common);
  require_success(*common, "factorize");
  ++statistics_.factorizations;
  factor_->require_positive_pivots(matrix);
  factor_->factorized = true;
}

Eigen::VectorXd SparseCholesky::solve(const Eigen::VectorXd& b) {
  assert(factor_->factorized && b.size() == static_cast<Eigen::Index>(factor_->lower->n));
  const Stopwatch stopwatch(statistics_.solve_seconds);
  const BlasThreads threads(options_.blas_threads);
  cholmod_common* common = factor_->common.get();
  cholmod_dense view = view_column(b);
  const std::unique_ptr<cholmod_dense, Factor::Free> x(cholmod_solve(CHOLMOD_A, factor_->lower.get(), &view, common),
                                                       Factor::Free{common});
  require_success(*common, "solve with");
  ++statistics_.solves;
  return Eigen::Map<const Eigen::VectorXd>(static_cast<const double*>(x->x), b.size());
}

}  // namespace sluice
