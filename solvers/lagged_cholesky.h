/// LaggedCholesky: solves a sequence of sparse, symmetric, positive definite systems whose values change a little from
/// one to the next on one pattern, as in the steps of a simulation.
///
///   LaggedCholesky solver;
///   solver.analyze(pattern);                 // whenever the pattern changes
///   solver.solve(values, b, x);              // each step; x: guess in, solution out
///
/// A factorization is much dearer than the solution of two triangular systems, and the factor of a matrix of some steps
/// ago is an excellent preconditioner for conjugate gradients. The factor is therefore kept, and renewed when that is
/// estimated to be cheaper (renewal_rule.h); conjugate gradients that come out dearer than expected are given up, and
/// go on with a new factor from where they are.
///
/// With Choice::counted the costs are numbers of operations, known from the analysis: the same systems give the same
/// bits on any run. With Choice::measured they are times of this machine.
///
/// The preconditioner is a copy of the factor in single precision (packed_factor.h), which is applied two to three
/// times as fast. After a factorization the same iteration serves as iterative refinement: it ends after two steps or
/// so. Should it not, because the matrix is worse conditioned than single precision bears, the factor itself takes
/// over.
///
/// Reference: M. R. Hestenes, E. Stiefel, Methods of conjugate gradients for solving linear systems, J. Res. Natl. Bur.
/// Stand. 49 (1952).
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "solvers/nested_dissection.h"
#include "solvers/packed_factor.h"
#include "solvers/renewal_rule.h"
#include "solvers/sliced_rows.h"
#include "solvers/sparse_cholesky.h"

namespace sluice {

struct LaggedCholeskyOptions {
  enum class Ordering {
    measured,           ///< the best of the following at the first analysis, kept for later ones: by counted work, or,
                        ///< with Choice::measured, by the time of a factorization and some solves
    minimum_degree,     ///< AMD
    nested_dissection,  ///< METIS
    given               ///< the order given to `analyze`; minimum_degree where that is empty
  };
  /// What decides when to factorize anew.
  enum class Choice {
    counted,   ///< counted operations: same bits on any run
    measured,  ///< measured times: best on an unusual machine; the last bits may differ from run to run
    direct     ///< every step
  };
  Ordering ordering = Ordering::measured;
  Choice choice = Choice::counted;
  int blas_threads = 1;  ///< as in SparseCholeskyOptions
  double relative_tolerance = 1e-9;
  int most_iterations = 100;  ///< with a lagged factor; then it is renewed
};

struct LaggedCholeskyStatistics {
  int analyses = 0;
  int factorizations = 0;
  int solves = 0;
  int iterations = 0;          ///< of conjugate gradients, all solves together
  double analyze_seconds = 0;  ///< wall-clock, all together; with all orderings that were tried
  double factorize_seconds = 0;
  double solve_seconds = 0;  ///< everything in `solve` but the factorizations
  std::int64_t unknowns = 0;
  std::int64_t matrix_nonzeros = 0;  ///< of the lower triangle
  std::int64_t factor_nonzeros = 0;
  std::string ordering;  ///< the one in use: "minimum degree", "nested dissection" or "given"
};

class LaggedCholesky {
 public:
  explicit LaggedCholesky(LaggedCholeskyOptions options = {});

  /// A new pattern: forgets the factor. `elimination_order`, for example nested_dissection() of the places of the
  /// unknowns, may be empty: a candidate for Ordering::given and Ordering::measured. No effect if neither has changed.
  void analyze(SymmetricPattern pattern, std::vector<int> elimination_order = {});

  struct Report {
    int iterations = 0;  ///< 0 where the guess was good enough
    bool factorized = false;
    /// False where round-off keeps the residual above what was asked for, whatever the preconditioner; x is the best
    /// that was reached, and the solution for most purposes.
    bool converged = true;
    double residual = 0;          ///< ||b - A x|| / ||b||
    double largest_residual = 0;  ///< max |b - A x|, in the unit of b
  };
  /// Solves A x = b; `values` in the order of pattern.row. x holds the guess, and then the solution. With r = b - A x
  /// and D the diagonal of A, stops when all hold:
  ///   ||r|| <= relative_tolerance ||b||,  max |r_i| <= largest_residual,
  ///   ||D^-1/2 r|| <= relative_tolerance ||D^-1/2 b||.
  /// The last, an estimate of the energy norm of the error, does not change with the scale of single unknowns: unknowns
  /// of small cut cells, whose rows are small, are as accurate as others. All are tested on the residual itself, or on
  /// the one that conjugate gradients carry along while round-off cannot tell them apart. Throws NotPositiveDefinite;
  /// the factor is forgotten then. Allocates nothing unless it factorizes.
  Report solve(std::span<const double> values, std::span<const double> b, std::span<double> x,
               double largest_residual = std::numeric_limits<double>::infinity());

  const LaggedCholeskyStatistics& statistics() const { return statistics_; }

  /// What the next solve needs to give the same bits as without the interruption.
  struct State {
    std::vector<double> factorized_values;  ///< the values behind the factor; empty if there is none
    std::vector<double> counters;           ///< what the choices of ordering and factorization rest on
  };
  State state() const;
  /// After `analyze` with the pattern and order of the interrupted run. Makes the factor again from its values.
  void restore(const State& state);

 private:
  enum class Outcome { converged, given_up, at_round_off };
  enum class Preconditioner { lagged, fresh, fresh_double };
  /// Of a residual or right-hand side r: ||r||, ||D^-1/2 r||, max |r_i|.
  struct Norms {
    double plain = 0, scaled = 0, largest = 0;
  };

  SparseCholesky analysed(LaggedCholeskyOptions::Ordering ordering, const SymmetricPattern& pattern) const;
  double measure(SparseCholesky& candidate) const;
  void use(LaggedCholeskyOptions::Ordering ordering, SparseCholesky cholesky);

  /// What norms are made of, before the roots are taken.
  struct Sums {
    double plain = 0, scaled = 0, largest = 0;
    bool positive = true;  ///< the diagonal, where that is asked for
  };
  /// Of z with r, A z, and A p of the last direction.
  struct Products {
    double residual = 0, image = 0, last_image = 0;
  };

  void invert_diagonal(std::span<const double> values, std::size_t begin, std::size_t end);
  Sums sums(std::span<const double> r, std::size_t begin, std::size_t end) const;
  template <class Body>
  Norms norms_after(std::span<const double> r, const Body& body);
  /// The largest ratio of a norm of r_ to what is allowed: converged at 1 and below.
  double distance() const;
  /// Whether what is allowed is so little that round-off counts.
  bool near_round_off() const;
  static Norms added_up(const std::vector<Sums>& shares);
  void set_residual(std::span<const double> b, std::span<const double> x, std::size_t begin, std::size_t end);
  double update_residual(std::span<const double> b, std::span<const double> x);

  Report solve_within(std::span<const double> values, std::span<const double> b, std::span<double> x,
                      double largest_residual);
  Norms measure_guess(std::span<const double> values, std::span<const double> b, std::span<const double> x);
  double start(std::span<const double> b, const Norms& size, std::span<double> x);
  double start_again(std::span<const double> b, const Norms& size, std::span<double> x);
  void factorize(std::span<const double> values);
  Products multiply_direction(bool again);
  Outcome iterate(std::span<const double> b, std::span<double> x, double distance, Preconditioner preconditioner,
                  int& iterations);

  LaggedCholeskyOptions options_;
  LaggedCholeskyStatistics statistics_;
  LaggedCholeskyOptions::Ordering ordering_;  // in use; Ordering::measured before the first analysis
  std::vector<int> elimination_order_;
  SparseCholesky cholesky_;
  PackedFactor packed_;
  std::vector<double> factorized_values_;  // empty if there is no factor
  RenewalRule rule_;
  Norms allowed_;                                                 // in the current solve
  Norms round_off_;                                               // of what round-off adds to a residual
  Norms norms_;                                                   // of r_
  SlicedRows rows_;                                               // of the current solve
  std::vector<Sums> shares_, sizes_;                              // of r_ and of b, by share
  std::vector<Products> products_;                                // by share
  std::vector<double> inverse_diagonal_, r_, z_, p_, q_, image_;  // q = A p, image = A z
};

}  // namespace sluice
