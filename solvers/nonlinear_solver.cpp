#include "solvers/nonlinear_solver.h"

#include <kinsol/kinsol.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_spgmr.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <new>

namespace sluice {

namespace {

void require(bool good) {
  if (!good) throw std::bad_alloc();
}

std::span<double> values(N_Vector vector) {
  return {N_VGetArrayPointer(vector), static_cast<std::size_t>(N_VGetLength(vector))};
}

/// What the functions that KINSOL calls share: evaluates F, keeps the best u, and says when to stop.
class Watch {
 public:
  Watch(const NonlinearProblem& problem, const NonlinearOptions& options, std::span<double> u)
      : problem_(problem), options_(options), best_(u), residual_(u.size()) {}

  bool converged() const { return state_ == State::converged; }
  bool ended() const { return converged() || state_ == State::given_up; }
  std::exception_ptr exception() const { return exception_; }
  NonlinearReport& report() { return report_; }
  const NonlinearProblem& problem() const { return problem_; }

  /// A further iteration of at most so many evaluations.
  void start(int most, int patience) {
    state_ = State::going;
    end_ = report_.evaluations + most;
    patience_ = patience;
    last_gain_ = report_.evaluations;
  }

  /// F(u) in `f`; 0 to go on, as KINSOL wants it.
  int evaluate(std::span<const double> u, std::span<double> f) {
    if (state_ == State::converged || state_ == State::given_up) return -1;
    if (report_.evaluations >= end_) return stop(State::given_up);
    ++report_.evaluations;
    bool defined = std::all_of(u.begin(), u.end(), [](double x) { return std::isfinite(x); });
    try {
      defined = defined && problem_.residual(u, f);
    } catch (...) {  // no exception may pass through C
      exception_ = std::current_exception();
      return stop(State::given_up);
    }
    const double size = defined ? largest(f) / options_.scale : NAN;
    if (!std::isfinite(size)) {
      state_ = State::undefined;
      return 1;  // the line search takes a shorter step
    }
    state_ = State::going;
    note(u, size);
    if (size <= options_.tolerance) return stop(State::converged);
    return report_.evaluations - last_gain_ > patience_ ? stop(State::given_up) : 0;
  }

  /// u - A^-1 F(u), for the Picard iteration.
  int fixed_point(std::span<const double> u, std::span<double> image) {
    const int flag = evaluate(u, residual_);
    if (flag != 0) return -1;
    problem_.precondition(residual_, residual_);
    for (std::size_t i = 0; i < u.size(); ++i) image[i] = u[i] - residual_[i];
    return 0;
  }

 private:
  enum class State { going, converged, given_up, undefined };
  static double largest(std::span<const double> f) {
    double size = 0;
    for (const double x : f) size = std::isnan(x) ? NAN : std::max(size, std::abs(x));
    return size;
  }
  int stop(State state) {
    state_ = state;
    return -1;
  }
  void note(std::span<const double> u, double size) {
    if (size < 0.9 * gained_) {
      gained_ = size;
      last_gain_ = report_.evaluations;
    }
    if (any_ && size >= report_.residual) return;
    any_ = true;
    report_.residual = size;
    std::ranges::copy(u, best_.begin());
  }

  const NonlinearProblem& problem_;
  const NonlinearOptions& options_;
  std::span<double> best_;
  std::vector<double> residual_;
  NonlinearReport report_;
  State state_ = State::going;
  int end_ = 0, last_gain_ = 0, patience_ = 0;
  double gained_ = std::numeric_limits<double>::infinity();  // the residual of the last gain
  bool any_ = false;
  std::exception_ptr exception_;
};

int picard_function(N_Vector u, N_Vector image, void* data) {
  return static_cast<Watch*>(data)->fixed_point(values(u), values(image));
}
int newton_function(N_Vector u, N_Vector f, void* data) {
  return static_cast<Watch*>(data)->evaluate(values(u), values(f));
}
int precondition(N_Vector, N_Vector, N_Vector, N_Vector, N_Vector v, void* data) {
  static_cast<Watch*>(data)->problem().precondition(values(v), values(v));
  return 0;
}

/// The objects of KINSOL, which are freed in the opposite order.
class Kinsol {
 public:
  explicit Kinsol(std::size_t size) {
    require(SUNContext_Create(nullptr, &context_) == 0);
    u_ = vector(size);
    u_scale_ = vector(size);
    f_scale_ = vector(size);
    memory_ = KINCreate(context_);
    require(memory_ != nullptr);
    KINSetErrHandlerFn(
        memory_, [](int, const char*, const char*, char*, void*) {}, nullptr);  // we report it
  }
  ~Kinsol() {
    KINFree(&memory_);
    if (linear_ != nullptr) SUNLinSolFree(linear_);
    for (N_Vector v : {u_, u_scale_, f_scale_}) N_VDestroy(v);
    SUNContext_Free(&context_);
  }
  Kinsol(const Kinsol&) = delete;
  Kinsol& operator=(const Kinsol&) = delete;

  void picard(Watch& watch, const NonlinearOptions& options) {
    KINSetMAA(memory_, options.memory);
    start(picard_function, watch);
    solve(KIN_FP, 1, 1);
  }

  void newton(Watch& watch, const NonlinearOptions& options) {
    start(newton_function, watch);
    linear_ = SUNLinSol_SPGMR(u_, SUN_PREC_RIGHT, options.krylov_dimension, context_);
    require(linear_ != nullptr);
    require(KINSetLinearSolver(memory_, linear_, nullptr) == 0);
    KINSetPreconditioner(memory_, nullptr, precondition);
    KINSetMaxNewtonStep(memory_, 1e30);
    solve(KIN_LINESEARCH, 1 / options.step, 1 / options.scale);
  }

  std::span<double> u() { return values(u_); }

 private:
  N_Vector vector(std::size_t size) {
    const N_Vector v = N_VNew_Serial(static_cast<sunindextype>(size), context_);
    require(v != nullptr);
    return v;
  }
  void start(KINSysFn function, Watch& watch) {
    KINSetUserData(memory_, &watch);
    require(KINInit(memory_, function, u_) == 0);
    KINSetNumMaxIters(memory_, 1'000'000);  // the watch counts evaluations
    KINSetFuncNormTol(memory_, 1e-200);     // and knows when it is done
    KINSetScaledStepTol(memory_, 1e-14);
  }
  void solve(int strategy, double u_scale, double f_scale) {
    N_VConst(u_scale, u_scale_);
    N_VConst(f_scale, f_scale_);
    KINSol(memory_, u_, strategy, u_scale_, f_scale_);
  }

  SUNContext context_ = nullptr;
  N_Vector u_ = nullptr, u_scale_ = nullptr, f_scale_ = nullptr;
  void* memory_ = nullptr;
  SUNLinearSolver linear_ = nullptr;
};

}  // namespace

NonlinearReport solve_nonlinear(const NonlinearProblem& problem, std::span<double> u, const NonlinearOptions& options) {
  if (u.empty()) return {.converged = true};
  Watch watch(problem, options, u);
  // From the best that is known. KINSOL also ends by itself: where its history has become linearly dependent, or a step
  // is lost in round-off.
  const auto attempt = [&](const auto& method) {
    Kinsol kinsol(u.size());
    std::ranges::copy(u, kinsol.u().begin());
    method(kinsol);
    if (watch.exception()) std::rethrow_exception(watch.exception());
  };
  NonlinearReport& report = watch.report();
  if (options.most_picard > 0) {
    watch.start(options.most_picard, options.patience);
    double before = std::numeric_limits<double>::infinity();
    do {  // with a history that begins anew
      before = report.evaluations > 0 ? report.residual : before;
      attempt([&](Kinsol& kinsol) { kinsol.picard(watch, options); });
    } while (!watch.ended() && report.residual < before);
  }
  if (!watch.converged() && options.most_newton > 0) {
    report.by_newton = true;
    watch.start(options.most_newton, std::max(options.patience, 4 * options.krylov_dimension));
    attempt([&](Kinsol& kinsol) { kinsol.newton(watch, options); });
  }
  report.converged = watch.converged();
  return report;
}

}  // namespace sluice
