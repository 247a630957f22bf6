/// NonlinearSolver: F(u) = 0 for a function whose derivative resembles a matrix that has been factorized, by SUNDIALS
/// KINSOL.
///
/// Two iterations, tried in this order:
///   picard   u <- u - A^-1 F(u), the modified Newton method with one matrix for all, with Anderson acceleration: the
///            next u is the best combination of the last few. Converges from afar where A is stiffer than F'.
///   newton   Newton's method with GMRES, preconditioned with A^-1; products F' v are differences of F. Quick near
///            the solution where F' is far from A.
///
/// Both stop when max |F_i| <= tolerance * scale, which is tested whenever F is evaluated, and give up when `patience`
/// evaluations have not brought the best residual down by a tenth. The same problem gives the same bits on any number
/// of threads if F does: KINSOL sums on one.
///
/// References: A. C. Hindmarsh et al., SUNDIALS, ACM Trans. Math. Softw. 31 (2005); D. G. Anderson, Iterative
/// procedures for nonlinear integral equations, J. ACM 12 (1965); H. F. Walker, P. Ni, SIAM J. Numer. Anal. 49 (2011).
#pragma once

#include <functional>
#include <span>
#include <vector>

namespace sluice {

struct NonlinearProblem {
  /// f = F(u); false where F is not defined, for example because u is out of any reason.
  std::function<bool(std::span<const double> u, std::span<double> f)> residual;
  /// x = A^-1 r. x may be r.
  std::function<void(std::span<const double> r, std::span<double> x)> precondition;
};

struct NonlinearOptions {
  double tolerance = 1e-6;  ///< of max |F_i| over `scale`
  double scale = 1;         ///< size of the terms in F, in its unit
  double step = 1;          ///< size of u where F begins to change, in its unit: for differences of F
  int memory = 10;          ///< of Anderson acceleration; 0: none
  int most_picard = 400;    ///< evaluations of F; 0: no Picard iteration
  int most_newton = 1000;   ///< the same, products included; 0: no Newton's method
  int patience = 100;       ///< evaluations
  int krylov_dimension = 40;
};

struct NonlinearReport {
  bool converged = false;
  int evaluations = 0;     ///< of F
  double residual = 0;     ///< max |F_i| / scale of the u that is returned
  bool by_newton = false;  ///< the Picard iteration did not do
};

/// u: guess in; out: the solution, or the best that was found. Throws std::bad_alloc.
NonlinearReport solve_nonlinear(const NonlinearProblem& problem, std::span<double> u, const NonlinearOptions& options);

}  // namespace sluice
