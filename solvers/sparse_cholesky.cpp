#include "solvers/sparse_cholesky.h"

#include <cblas.h>
#include <cholmod.h>
#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <new>
#include <utility>

#include "solvers/stopwatch.h"

// Of the OpenMP library inside CHOLMOD; declared here because omp.h of another compiler may belong to another library.
extern "C" {
int omp_get_max_active_levels();
void omp_set_max_active_levels(int levels);
}

namespace sluice {
namespace {

/// Threads of the libraries, until its end. OpenBLAS has one number of threads for the whole program. CHOLMOD opens an
/// OpenMP region of four threads for every block of the factor: blocks are so small that it waits for threads most of
/// the time, and takes up to four times as long as one thread alone. No level of active regions means one thread.
class LibraryThreads {
 public:
  explicit LibraryThreads(int blas) : blas_(openblas_get_num_threads()), openmp_levels_(omp_get_max_active_levels()) {
    openblas_set_num_threads(blas);
    omp_set_max_active_levels(0);
  }
  ~LibraryThreads() {
    openblas_set_num_threads(blas_);
    omp_set_max_active_levels(openmp_levels_);
  }
  LibraryThreads(const LibraryThreads&) = delete;
  LibraryThreads& operator=(const LibraryThreads&) = delete;

 private:
  int blas_, openmp_levels_;
};

/// CHOLMOD's view of a matrix of which it reads the lower triangle, with no copy. CHOLMOD does not write to it.
cholmod_sparse view_lower(const SymmetricPattern& pattern, const double* values) {
  cholmod_sparse view{};
  view.nrow = view.ncol = static_cast<std::size_t>(pattern.size());
  view.nzmax = pattern.row.size();
  view.p = const_cast<int*>(pattern.column_begin.data());
  view.i = const_cast<int*>(pattern.row.data());
  view.x = const_cast<double*>(values);
  view.stype = -1;
  view.itype = CHOLMOD_INT;
  view.xtype = values != nullptr ? CHOLMOD_REAL : CHOLMOD_PATTERN;
  view.dtype = CHOLMOD_DOUBLE;
  view.sorted = 1;
  view.packed = 1;
  return view;
}

cholmod_dense view_column(std::span<const double> vector) {
  cholmod_dense view{};
  view.nrow = view.nzmax = view.d = vector.size();
  view.ncol = 1;
  view.x = const_cast<double*>(vector.data());
  view.xtype = CHOLMOD_REAL;
  view.dtype = CHOLMOD_DOUBLE;
  return view;
}

std::vector<double> matrix_diagonal(const SymmetricPattern& pattern, std::span<const double> values) {
  std::vector<double> diagonal(static_cast<std::size_t>(pattern.size()), 0.0);
  for (int column = 0; column < pattern.size(); ++column) {
    const auto c = static_cast<std::size_t>(column);
    const auto begin = pattern.row.begin() + pattern.column_begin[c],
               end = pattern.row.begin() + pattern.column_begin[c + 1];
    const auto entry = std::lower_bound(begin, end, column);
    if (entry != end && *entry == column) diagonal[c] = values[static_cast<std::size_t>(entry - pattern.row.begin())];
  }
  return diagonal;
}

void require_success(const cholmod_common& common, const char* action) {
  if (common.status == CHOLMOD_OUT_OF_MEMORY) throw std::bad_alloc();
  if (common.status < CHOLMOD_OK)
    throw std::runtime_error(fmt::format("CHOLMOD could not {} the matrix: status {}{}", action, common.status,
                                         common.status == CHOLMOD_TOO_LARGE ? ", too large for int indices" : ""));
}

SparseCholesky::DenseBlocks view_blocks(const cholmod_factor& factor) {
  const auto ints = [](void* begin, std::size_t size) { return std::span(static_cast<const int*>(begin), size); };
  return {.first_column = ints(factor.super, factor.nsuper + 1),
          .first_row = ints(factor.pi, factor.nsuper + 1),
          .first_value = ints(factor.px, factor.nsuper + 1),
          .row = ints(factor.s, factor.ssize),
          .value = std::span(static_cast<const double*>(factor.x), factor.xsize)};
}

/// The diagonal of the factor L (A = L Lᵀ), in the order of elimination.
std::vector<double> factor_diagonal(const cholmod_factor& factor) {
  std::vector<double> diagonal(factor.n);
  if (factor.is_super != 0) {
    const auto [first_column, first_row, first_value, row, value] = view_blocks(factor);
    for (std::size_t block = 0; block < factor.nsuper; ++block) {
      const int rows = first_row[block + 1] - first_row[block];
      for (int column = first_column[block]; column < first_column[block + 1]; ++column) {
        const int entry = first_value[block] + (column - first_column[block]) * (rows + 1);
        diagonal[static_cast<std::size_t>(column)] = value[static_cast<std::size_t>(entry)];
      }
    }
  } else {
    const auto* x = static_cast<const double*>(factor.x);
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
  };

  Factor();
  void set_up(const SparseCholeskyOptions& options);
  bool has_pattern(const Matrix& matrix) const;
  /// Unknown that is eliminated at `position`.
  int unknown(std::size_t position) const { return static_cast<const int*>(lower->Perm)[position]; }
  void require_positive_pivots(std::span<const double> values) const;
  ~Factor();

  std::unique_ptr<cholmod_common, Finish> common;
  std::unique_ptr<cholmod_factor, Free> lower;  // declared after `common`, which it needs to be freed
  SymmetricPattern pattern;                     // of the analysed matrix
  bool factorized = false;
  // Solution and work space of `solve`, allocated by CHOLMOD at the first and kept.
  cholmod_dense* solution = nullptr;
  cholmod_dense* permuted = nullptr;
  cholmod_dense* work = nullptr;
};

SparseCholesky::Factor::~Factor() {
  for (cholmod_dense* vector : {solution, permuted, work}) cholmod_free_dense(&vector, common.get());
}

SparseCholesky::Factor::Factor() : common(new cholmod_common), lower(nullptr, Free{common.get()}) {
  cholmod_start(common.get());
  common->print = 0;
  // L Lᵀ, because CHOLMOD's L D Lᵀ, its default for sparse factors, accepts negative pivots.
  common->final_ll = 1;
}

void SparseCholesky::Factor::set_up(const SparseCholeskyOptions& options) {
  if (options.dense_blocks) common->supernodal = CHOLMOD_SUPERNODAL;
  if (options.ordering == Ordering::automatic) return;
  common->nmethods = 1;
  common->method[0].ordering = options.ordering == Ordering::minimum_degree      ? CHOLMOD_AMD
                               : options.ordering == Ordering::nested_dissection ? CHOLMOD_METIS
                               : options.ordering == Ordering::natural           ? CHOLMOD_NATURAL
                                                                                 : CHOLMOD_GIVEN;
}

bool SparseCholesky::Factor::has_pattern(const Matrix& matrix) const {
  const auto columns = static_cast<std::size_t>(matrix.cols()), entries = static_cast<std::size_t>(matrix.nonZeros());
  return lower && pattern.column_begin.size() == columns + 1 && pattern.row.size() == entries &&
         std::equal(pattern.column_begin.begin(), pattern.column_begin.end(), matrix.outerIndexPtr()) &&
         std::equal(pattern.row.begin(), pattern.row.end(), matrix.innerIndexPtr());
}

/// A singular matrix often passes the factorization with a pivot that is nothing but round-off. A pivot is the diagonal
/// entry less a sum of squares, whose round-off is at most n epsilon times that entry (N. J. Higham, Accuracy and
/// Stability of Numerical Algorithms, 2nd ed. 2002, theorem 10.3): a pivot below it says nothing. The converse fails:
/// with coefficients of very different size a singular matrix can still pass.
void SparseCholesky::Factor::require_positive_pivots(std::span<const double> values) const {
  const std::vector<double> diagonal = matrix_diagonal(pattern, values);
  const auto at = [&](int column) { return diagonal[static_cast<std::size_t>(column)]; };
  if (common->status == CHOLMOD_NOT_POSDEF) {
    const int column = unknown(lower->minor);
    throw_not_positive_definite(column, at(column), "the pivot is not positive");
  }
  const std::vector<double> factor = factor_diagonal(*lower);
  const double round_off = std::numeric_limits<double>::epsilon() * static_cast<double>(diagonal.size());
  for (std::size_t position = 0; position < factor.size(); ++position) {
    const int column = unknown(position);
    const double pivot = factor[position] * factor[position];
    if (!(pivot > round_off * at(column)) || !std::isfinite(pivot))
      throw_not_positive_definite(column, at(column), fmt::format("the pivot {:g} is round-off", pivot));
  }
}

SparseCholesky::SparseCholesky(SparseCholeskyOptions options)
    : factor_(std::make_unique<Factor>()), options_(std::move(options)) {
  assert(options_.blas_threads >= 1);
  factor_->set_up(options_);
}

SparseCholesky::~SparseCholesky() = default;
SparseCholesky::SparseCholesky(SparseCholesky&&) noexcept = default;
SparseCholesky& SparseCholesky::operator=(SparseCholesky&&) noexcept = default;

bool SparseCholesky::analyze(const Matrix& matrix) {
  assert(matrix.rows() == matrix.cols() && matrix.rows() > 0 && matrix.isCompressed());
  if (factor_->has_pattern(matrix)) return false;
  return analyze({.column_begin = {matrix.outerIndexPtr(), matrix.outerIndexPtr() + matrix.cols() + 1},
                  .row = {matrix.innerIndexPtr(), matrix.innerIndexPtr() + matrix.nonZeros()}});
}

bool SparseCholesky::analyze(SymmetricPattern pattern) {
  assert(pattern.size() > 0 && pattern.row.size() == static_cast<std::size_t>(pattern.column_begin.back()));
  if (factor_->lower && factor_->pattern == pattern) return false;
  const Stopwatch stopwatch(statistics_.analyze_seconds);
  const bool given = options_.ordering == Ordering::given;
  assert(!given || options_.permutation.size() == static_cast<std::size_t>(pattern.size()));

  cholmod_common* common = factor_->common.get();
  factor_->pattern = std::move(pattern);
  cholmod_sparse view = view_lower(factor_->pattern, nullptr);
  factor_->factorized = false;
  factor_->lower.reset(cholmod_analyze_p(&view, given ? options_.permutation.data() : nullptr, nullptr, 0, common));
  require_success(*common, "analyse");
  ++statistics_.analyses;
  statistics_.factor_nonzeros = static_cast<std::int64_t>(common->lnz);
  statistics_.flops = common->fl;
  statistics_.supernodal = factor_->lower->is_super != 0;
  return true;
}

void SparseCholesky::factorize(const Matrix& matrix) {
  analyze(matrix);
  factorize(std::span(matrix.valuePtr(), static_cast<std::size_t>(matrix.nonZeros())));
}

void SparseCholesky::factorize(std::span<const double> values) {
  assert(factor_->lower && values.size() == factor_->pattern.row.size());
  const Stopwatch stopwatch(statistics_.factorize_seconds);
  const LibraryThreads threads(options_.blas_threads);
  cholmod_common* common = factor_->common.get();
  cholmod_sparse view = view_lower(factor_->pattern, values.data());
  factor_->factorized = false;
  cholmod_factorize(&view, factor_->lower.get(), common);
  require_success(*common, "factorize");
  ++statistics_.factorizations;
  factor_->require_positive_pivots(values);
  factor_->factorized = true;
}

Eigen::VectorXd SparseCholesky::solve(const Eigen::VectorXd& b) {
  Eigen::VectorXd x(b.size());
  const auto size = static_cast<std::size_t>(b.size());
  solve(std::span(b.data(), size), std::span(x.data(), size));
  return x;
}

void SparseCholesky::solve(std::span<const double> b, std::span<double> x) {
  assert(factor_->factorized && b.size() == factor_->lower->n && x.size() == b.size());
  const Stopwatch stopwatch(statistics_.solve_seconds);
  const LibraryThreads threads(options_.blas_threads);
  cholmod_dense view = view_column(b);
  cholmod_solve2(CHOLMOD_A, factor_->lower.get(), &view, nullptr, &factor_->solution, nullptr, &factor_->permuted,
                 &factor_->work, factor_->common.get());
  require_success(*factor_->common, "solve with");
  ++statistics_.solves;
  std::copy_n(static_cast<const double*>(factor_->solution->x), x.size(), x.begin());
}

const SymmetricPattern& SparseCholesky::pattern() const { return factor_->pattern; }

std::span<const int> SparseCholesky::elimination_order() const {
  return {static_cast<const int*>(factor_->lower->Perm), factor_->lower->n};
}

SparseCholesky::DenseBlocks SparseCholesky::dense_blocks() const {
  assert(factor_->factorized && statistics_.supernodal);
  return view_blocks(*factor_->lower);
}

}  // namespace sluice
