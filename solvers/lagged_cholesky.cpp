#include "solvers/lagged_cholesky.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>

#include "core/parallel/multitarget.h"
#include "core/parallel/parallel.h"
#include "solvers/stopwatch.h"

namespace sluice {
namespace {

using Options = LaggedCholeskyOptions;

/// Operations of different kinds in one unit, nanoseconds of a machine of 2025; iterations are shared by threads, of
/// which two are assumed (a factorization is not). On one core it is 0.8 and 3 for an iteration, within a fifth of what
/// `sluice_performance --solver` measured from 5600 to 360,000 unknowns in 2-D and 3-D, before the blocks of the packed
/// factor were inverted: that has made an iteration cheaper and a factorization dearer, each by about a third. They
/// weigh a factorization against an iteration; no result depends on them but by the choice when to factorize.
RenewalRule::Costs counted_costs(const SparseCholeskyStatistics& factor, std::size_t matrix_nonzeros) {
  const double entries = static_cast<double>(factor.factor_nonzeros), nonzeros = static_cast<double>(matrix_nonzeros);
  return {.renewal = 0.022 * factor.flops + 8 * entries + 70 * nonzeros, .iteration = 0.5 * entries + 2 * nonzeros};
}

/// A number of solves to weigh against one factorization when orderings are compared.
constexpr int typical_solves = 10;
/// An order that takes longer to find than another must save a tenth of the work: it is found anew for every pattern.
constexpr double saving = 0.9;

/// Loops over unknowns are cut in shares of at most this many, which threads may take; sums over a share are added up
/// in the order of the shares, so that the bits do not depend on the number of threads.
constexpr std::size_t largest_share = 1024;
/// Loops over fewer unknowns are not worth waking the other threads.
constexpr std::size_t worth_sharing = 2 * largest_share;

constexpr std::size_t rounded_up(std::size_t number, std::size_t unit) { return (number + unit - 1) / unit * unit; }

/// How many unknowns a share has: the same in all but the last, in a number of shares that few threads divide evenly.
std::size_t share_size(std::size_t count) {
  constexpr std::size_t threads = 4;
  const std::size_t shares = rounded_up(count / largest_share + 1, threads);
  return rounded_up(count / shares + 1, SlicedRows::lanes);
}

/// Calls body(begin, end, number of the share).
template <class Body>
void for_shares(std::size_t count, const Body& body) {
  const std::size_t size = share_size(count);
  if (count >= worth_sharing) {
    parallel_shares(count, size, body);
    return;
  }
  for (std::size_t s = 0; s * size < count; ++s) body(s * size, std::min(count, (s + 1) * size), s);
}

/// Four sums instead of one, which the processor can form side by side; the order is fixed, and so are the bits.
SLUICE_MULTITARGET double dot(const double* a, const double* b, std::size_t count) {
  std::array<double, 4> sum{};
  const std::size_t blocks = count / 4 * 4;
  for (std::size_t i = 0; i < blocks; i += 4)
    for (std::size_t lane = 0; lane < 4; ++lane) sum[lane] += a[i + lane] * b[i + lane];
  for (std::size_t i = blocks; i < count; ++i) sum[i - blocks] += a[i] * b[i];
  return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

/// The next direction, p = z + beta p with q = A p from A z, and a step along it.
SLUICE_MULTITARGET void advance(std::size_t count, double beta, double alpha, const double* __restrict z,
                                const double* __restrict image, double* __restrict p, double* __restrict q,
                                double* __restrict x, double* __restrict r) {
#pragma omp simd
  for (std::size_t k = 0; k < count; ++k) {
    p[k] = z[k] + beta * p[k];
    q[k] = image[k] + beta * q[k];
    x[k] += alpha * p[k];
    r[k] -= alpha * q[k];
  }
}

sluice::Ordering ordering_of_cholesky(Options::Ordering ordering) {
  return ordering == Options::Ordering::given               ? sluice::Ordering::given
         : ordering == Options::Ordering::nested_dissection ? sluice::Ordering::nested_dissection
                                                            : sluice::Ordering::minimum_degree;
}

std::string name_of(Options::Ordering ordering) {
  return ordering == Options::Ordering::given               ? "given"
         : ordering == Options::Ordering::nested_dissection ? "nested dissection"
                                                            : "minimum degree";
}

}  // namespace

LaggedCholesky::LaggedCholesky(LaggedCholeskyOptions options) : options_(options), ordering_(options.ordering) {
  assert(options_.relative_tolerance > 0 && options_.most_iterations >= 1);
}

// ---------------------------------------------------------------------------------------------------------------------
// Analysis
// ---------------------------------------------------------------------------------------------------------------------

void LaggedCholesky::analyze(SymmetricPattern pattern, std::vector<int> elimination_order) {
  assert(elimination_order.empty() || elimination_order.size() == static_cast<std::size_t>(pattern.size()));
  if (statistics_.analyses > 0 && pattern == cholesky_.pattern() && elimination_order == elimination_order_) return;
  const Stopwatch stopwatch(statistics_.analyze_seconds);
  elimination_order_ = std::move(elimination_order);
  ++statistics_.analyses;
  if (ordering_ != Options::Ordering::measured || pattern.size() == 0) {
    use(ordering_, analysed(ordering_, pattern));
    return;
  }
  double least = std::numeric_limits<double>::infinity();
  for (const auto ordering :
       // the quickest to find first
       {Options::Ordering::given, Options::Ordering::minimum_degree, Options::Ordering::nested_dissection}) {
    if (ordering == Options::Ordering::given && elimination_order_.empty()) continue;
    SparseCholesky candidate = analysed(ordering, pattern);
    const double work = measure(candidate);
    if (work < saving * least) {
      least = work;
      use(ordering, std::move(candidate));
    }
  }
}

SparseCholesky LaggedCholesky::analysed(Options::Ordering ordering, const SymmetricPattern& pattern) const {
  const bool given = ordering == Options::Ordering::given && !elimination_order_.empty();
  SparseCholesky cholesky({.ordering = given ? sluice::Ordering::given : ordering_of_cholesky(ordering),
                           .permutation = given ? elimination_order_ : std::vector<int>(),
                           .blas_threads = options_.blas_threads,
                           .dense_blocks = true});
  if (pattern.size() > 0) cholesky.analyze(pattern);
  return cholesky;
}

/// The work of a factorization and some solves, counted or measured.
double LaggedCholesky::measure(SparseCholesky& candidate) const {
  const SymmetricPattern& pattern = candidate.pattern();
  if (options_.choice != Options::Choice::measured) {
    const RenewalRule::Costs costs = counted_costs(candidate.statistics(), pattern.row.size());
    return costs.renewal + typical_solves * costs.iteration;
  }
  // Times do not depend on the values: any positive definite matrix will do, here a diagonally dominant one.
  std::vector<double> values(pattern.row.size(), -1.0), x(static_cast<std::size_t>(pattern.size()), 1.0);
  std::vector<double> neighbours(x.size(), 0.0);
  for (const int row : pattern.row) neighbours[static_cast<std::size_t>(row)] += 1;
  for (std::size_t i = 0; i < x.size(); ++i)
    values[static_cast<std::size_t>(pattern.column_begin[i])] =
        neighbours[i] + pattern.column_begin[i + 1] - pattern.column_begin[i];
  candidate.factorize(values);
  candidate.solve(x, x);
  return candidate.statistics().factorize_seconds + typical_solves * candidate.statistics().solve_seconds;
}

void LaggedCholesky::use(Options::Ordering ordering, SparseCholesky cholesky) {
  cholesky_ = std::move(cholesky);
  ordering_ = ordering;
  factorized_values_.clear();
  const SymmetricPattern& pattern = cholesky_.pattern();
  rule_ = RenewalRule(counted_costs(cholesky_.statistics(), pattern.row.size()));
  rows_ = SlicedRows(pattern);
  for (auto* vector : {&inverse_diagonal_, &r_, &z_, &p_, &q_, &image_})
    vector->resize(static_cast<std::size_t>(pattern.size()));
  const std::size_t unit = share_size(r_.size());
  shares_.resize((r_.size() + unit - 1) / unit);
  sizes_.resize(shares_.size());
  products_.resize(shares_.size());
  statistics_.unknowns = pattern.size();
  statistics_.matrix_nonzeros = static_cast<std::int64_t>(pattern.row.size());
  statistics_.factor_nonzeros = cholesky_.statistics().factor_nonzeros;
  statistics_.ordering =
      name_of(ordering == Options::Ordering::given && elimination_order_.empty() ? Options::Ordering::minimum_degree
                                                                                 : ordering);
}

// ---------------------------------------------------------------------------------------------------------------------
// Norms
// ---------------------------------------------------------------------------------------------------------------------

void LaggedCholesky::invert_diagonal(std::span<const double> values, std::size_t begin, std::size_t end) {
  const std::vector<int>& column_begin = cholesky_.pattern().column_begin;
  for (std::size_t i = begin; i < end; ++i)
    inverse_diagonal_[i] = 1 / values[static_cast<std::size_t>(column_begin[i])];
}

LaggedCholesky::Sums LaggedCholesky::sums(std::span<const double> r, std::size_t begin, std::size_t end) const {
  std::array<double, 4> plain{}, scaled{}, largest{};
  const auto add = [&](std::size_t i, std::size_t lane) {
    const double square = r[i] * r[i];
    plain[lane] += square;
    scaled[lane] += square * inverse_diagonal_[i];
    largest[lane] = std::max(largest[lane], std::abs(r[i]));
  };
  const std::size_t blocks = begin + (end - begin) / 4 * 4;
  for (std::size_t i = begin; i < blocks; i += 4)
    for (std::size_t lane = 0; lane < 4; ++lane) add(i + lane, lane);
  for (std::size_t i = blocks; i < end; ++i) add(i, i - blocks);
  const auto sum = [](const std::array<double, 4>& s) { return (s[0] + s[1]) + (s[2] + s[3]); };
  return {sum(plain), sum(scaled), *std::max_element(largest.begin(), largest.end())};
}

LaggedCholesky::Norms LaggedCholesky::added_up(const std::vector<Sums>& shares) {
  Sums all;
  for (const Sums& share : shares) {
    all.plain += share.plain, all.scaled += share.scaled;
    all.largest = std::max(all.largest, share.largest);
  }
  return {std::sqrt(all.plain), std::sqrt(all.scaled), all.largest};
}

/// Calls body(begin, end, share) for all shares of the unknowns, and returns the norms of `r` after it.
template <class Body>
LaggedCholesky::Norms LaggedCholesky::norms_after(std::span<const double> r, const Body& body) {
  for_shares(r.size(), [&](std::size_t begin, std::size_t end, std::size_t share) {
    body(begin, end, share);
    shares_[share] = sums(r, begin, end);
  });
  return added_up(shares_);
}

double LaggedCholesky::distance() const {
  return std::max({norms_.plain / allowed_.plain, norms_.scaled / allowed_.scaled, norms_.largest / allowed_.largest});
}

bool LaggedCholesky::near_round_off() const {
  return round_off_.plain > allowed_.plain || round_off_.scaled > allowed_.scaled ||
         round_off_.largest > allowed_.largest;
}

/// r = b - A x on a share of the rows.
void LaggedCholesky::set_residual(std::span<const double> b, std::span<const double> x, std::size_t begin,
                                  std::size_t end) {
  rows_.multiply(x, r_, begin, end);
  for (std::size_t i = begin; i < end; ++i) r_[i] = b[i] - r_[i];
}

/// r = b - A x; returns the distance.
double LaggedCholesky::update_residual(std::span<const double> b, std::span<const double> x) {
  norms_ = norms_after(r_, [&](std::size_t begin, std::size_t end, std::size_t) { set_residual(b, x, begin, end); });
  return distance();
}

/// What a solve begins with, in one pass: the rows, the diagonal inverted, the residual of the guess, and its norms.
/// Returns those of b.
LaggedCholesky::Norms LaggedCholesky::measure_guess(std::span<const double> values, std::span<const double> b,
                                                    std::span<const double> x) {
  norms_ = norms_after(r_, [&](std::size_t begin, std::size_t end, std::size_t share) {
    invert_diagonal(values, begin, end);
    rows_.set(values, begin, end);
    set_residual(b, x, begin, end);
    sizes_[share] = sums(b, begin, end);
    sizes_[share].positive =
        std::all_of(inverse_diagonal_.begin() + static_cast<std::ptrdiff_t>(begin),
                    inverse_diagonal_.begin() + static_cast<std::ptrdiff_t>(end), [](double d) { return d > 0; });
  });
  return added_up(sizes_);
}

// ---------------------------------------------------------------------------------------------------------------------
// Solution
// ---------------------------------------------------------------------------------------------------------------------

LaggedCholesky::Report LaggedCholesky::solve(std::span<const double> values, std::span<const double> b,
                                             std::span<double> x, double largest_residual) {
  assert(values.size() == cholesky_.pattern().row.size() && b.size() == r_.size() && x.size() == r_.size());
  double seconds = 0;
  const double factorize_before = statistics_.factorize_seconds;
  Report report;
  {
    const Stopwatch stopwatch(seconds);
    report = solve_within(values, b, x, largest_residual);
  }
  statistics_.solve_seconds += seconds - (statistics_.factorize_seconds - factorize_before);
  statistics_.iterations += report.iterations;
  ++statistics_.solves;
  return report;
}

LaggedCholesky::Report LaggedCholesky::solve_within(std::span<const double> values, std::span<const double> b,
                                                    std::span<double> x, double largest_residual) {
  const Norms size = measure_guess(values, b, x);
  // Such a matrix is not positive definite: factorizing it throws, and says why.
  if (!std::ranges::all_of(sizes_, [](const Sums& share) { return share.positive; })) factorize(values);
  if (size.plain == 0) {
    std::fill(x.begin(), x.end(), 0.0);
    return {};
  }
  const double tolerance = options_.relative_tolerance;
  // Some hundred times what an iteration or two add to the difference between the residual carried along and b - A x.
  constexpr double noise = 1e-13;
  round_off_ = {.plain = noise * size.plain, .scaled = noise * size.scaled, .largest = noise * size.largest};
  allowed_ = {.plain = tolerance * size.plain, .scaled = tolerance * size.scaled, .largest = largest_residual};
  Report report;
  double distance = start(b, size, x);
  if (!(distance <= 1) || options_.choice == Options::Choice::direct) {
    bool renew = factorized_values_.empty() || rule_.renew();
    if (!renew) {
      const Outcome outcome = iterate(b, x, distance, Preconditioner::lagged, report.iterations);
      report.converged = outcome == Outcome::converged;
      renew = outcome == Outcome::given_up;
      if (!renew) rule_.aged(report.iterations);
    }
    if (renew) {
      const int before = report.iterations;
      factorize(values);
      report.factorized = true;
      if (before > 0) distance = start_again(b, size, x);
      for (const auto preconditioner : {Preconditioner::fresh, Preconditioner::fresh_double}) {
        const Outcome outcome = iterate(b, x, distance, preconditioner, report.iterations);
        report.converged = outcome == Outcome::converged;
        if (outcome != Outcome::given_up) break;
        distance = start_again(b, size, x);
      }
      rule_.renewed(before, report.iterations - before);
    }
  } else if (!factorized_values_.empty()) {
    rule_.aged(0);
  }
  report.residual = norms_.plain / size.plain;
  report.largest_residual = norms_.largest;
  return report;
}

/// Takes zero for the guess where that is better; returns the distance.
double LaggedCholesky::start(std::span<const double> b, const Norms& size, std::span<double> x) {
  if (norms_.plain <= size.plain) return distance();
  std::fill(x.begin(), x.end(), 0.0);
  std::copy(b.begin(), b.end(), r_.begin());
  norms_ = size;
  return distance();
}

double LaggedCholesky::start_again(std::span<const double> b, const Norms& size, std::span<double> x) {
  update_residual(b, x);
  return start(b, size, x);
}

void LaggedCholesky::factorize(std::span<const double> values) {
  double seconds = 0;
  factorized_values_.clear();  // no factor, should the matrix be refused
  {
    const Stopwatch stopwatch(seconds);
    cholesky_.factorize(values);
    invert_diagonal(values, 0, inverse_diagonal_.size());
    packed_.copy(cholesky_, inverse_diagonal_);
  }
  statistics_.factorize_seconds += seconds;
  ++statistics_.factorizations;
  if (options_.choice != Options::Choice::direct) factorized_values_.assign(values.begin(), values.end());
  if (options_.choice == Options::Choice::measured) {
    RenewalRule::Costs costs = rule_.costs();
    costs.renewal += (1e9 * seconds - costs.renewal) / 2;
    rule_.set_costs(costs);
  }
}

/// A z, and the products of z with r, with A z and, if there is one, with A p of the last direction p. They give the
/// curvature along the next direction, z + beta p, before that is formed: all else of an iteration is then one loop (in
/// the spirit of Chronopoulos & Gear 1989, who drop the last product, which is known where z is orthogonal to the last
/// residual; a factor in single precision makes that no more than nearly true).
LaggedCholesky::Products LaggedCholesky::multiply_direction(bool again) {
  for_shares(z_.size(), [&](std::size_t begin, std::size_t end, std::size_t share) {
    rows_.multiply(z_, image_, begin, end);
    const auto with_z = [&](const std::vector<double>& v) {
      return dot(z_.data() + begin, v.data() + begin, end - begin);
    };
    products_[share] = {with_z(r_), with_z(image_), again ? with_z(q_) : 0};
  });
  Products all;
  for (const Products& share : products_) {
    all.residual += share.residual;
    all.image += share.image;
    all.last_image += share.last_image;
  }
  return all;
}

/// Preconditioned conjugate gradients from the residual r_ of x, which is `distance` from the goal; adds to
/// `iterations`. With a fresh factor this is iterative refinement, and goes on until round-off stops it; with a lagged
/// one, until that is expected to be dearer than a factorization.
LaggedCholesky::Outcome LaggedCholesky::iterate(std::span<const double> b, std::span<double> x, double distance,
                                                Preconditioner preconditioner, int& iterations) {
  constexpr int most_refinements = 20;
  const bool fresh = preconditioner != Preconditioner::lagged;
  const double first = distance;
  double true_distance = distance, last_rho = 0, curvature = 0;
  for (int i = 1; i <= (fresh ? most_refinements : options_.most_iterations); ++i) {
    if (preconditioner == Preconditioner::fresh_double)
      cholesky_.solve(r_, z_);
    else
      packed_.solve(r_, norms_.scaled, z_);
    const bool again = last_rho > 0;  // a direction after another
    const Products with_z = multiply_direction(again);
    const double rho = with_z.residual, beta = again ? rho / last_rho : 0;
    curvature = with_z.image + beta * (2 * with_z.last_image + beta * curvature);  // p A p
    if (!(rho > 0 && curvature > 0)) break;  // not positive definite, or at the end of what numbers resolve
    ++iterations;
    const double alpha = rho / curvature;
    norms_ = norms_after(r_, [&](std::size_t begin, std::size_t end, std::size_t) {
      if (!again)
        for (auto* last : {&p_, &q_}) std::fill_n(last->data() + begin, end - begin, 0.0);
      advance(end - begin, beta, alpha, z_.data() + begin, image_.data() + begin, p_.data() + begin, q_.data() + begin,
              x.data() + begin, r_.data() + begin);
    });
    last_rho = rho;
    distance = this->distance();
    if (distance <= 1) {
      if (i <= 2 && !near_round_off()) return Outcome::converged;
      // The residual carried along drifts away from b - A x by round-off.
      distance = update_residual(b, x);
      if (distance <= 1) return Outcome::converged;
      if (!(distance < true_distance / 2)) return Outcome::at_round_off;
      true_distance = distance, last_rho = 0;
    } else if (!fresh && rule_.give_up(i, first, distance)) {
      return Outcome::given_up;
    }
  }
  return update_residual(b, x) <= 1 ? Outcome::converged : Outcome::given_up;
}

// ---------------------------------------------------------------------------------------------------------------------
// Checkpoints
// ---------------------------------------------------------------------------------------------------------------------

LaggedCholesky::State LaggedCholesky::state() const {
  State state{.factorized_values = factorized_values_, .counters = {static_cast<double>(ordering_)}};
  const RenewalRule::Counters counters = rule_.counters();
  state.counters.insert(state.counters.end(), counters.begin(), counters.end());
  return state;
}

void LaggedCholesky::restore(const State& state) {
  RenewalRule::Counters counters{};
  assert(state.counters.size() == counters.size() + 1 && statistics_.analyses > 0);
  const auto ordering = static_cast<Options::Ordering>(static_cast<int>(state.counters[0]));
  if (ordering != ordering_) {
    const Stopwatch stopwatch(statistics_.analyze_seconds);
    use(ordering, analysed(ordering, cholesky_.pattern()));
  }
  if (!state.factorized_values.empty()) factorize(state.factorized_values);
  std::copy(state.counters.begin() + 1, state.counters.end(), counters.begin());
  rule_.restore(counters);
}

}  // namespace sluice
