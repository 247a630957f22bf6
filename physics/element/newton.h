/// Newton's method for a handful of unknowns whose equations may have kinks and be dependent.
#pragma once

#include <Eigen/Dense>
#include <functional>

namespace sluice::element {

using Vector = Eigen::VectorXd;

struct NewtonOptions {
  double perturbation;  ///< of an unknown, for the columns of the Jacobian
  double tolerance;     ///< of the largest residual
  double acceptable;    ///< good enough where the residual falls no further; at least the tolerance
};

/// Solves residual(x) = 0 from `x`, which holds the best that was found in the end; true if that satisfies the options.
/// The Jacobian is numerical. Of the steps that solve the linear system as well as possible the shortest is taken,
/// since at failure stress does not depend on all of strain; steps are halved until the residual falls.
bool newton(const std::function<Vector(const Vector&)>& residual, Vector& x, const NewtonOptions& options);

}  // namespace sluice::element
