#include "physics/element/newton.h"

#include <cmath>

namespace sluice::element {

namespace {

Eigen::MatrixXd jacobian(const std::function<Vector(const Vector&)>& residual, const Vector& x, const Vector& at_x,
                         double perturbation) {
  Eigen::MatrixXd columns(at_x.size(), x.size());
  for (Eigen::Index j = 0; j < x.size(); ++j) {
    Vector moved = x;
    moved[j] += perturbation;
    columns.col(j) = (residual(moved) - at_x) / perturbation;
  }
  return columns;
}

}  // namespace

bool newton(const std::function<Vector(const Vector&)>& residual, Vector& x, const NewtonOptions& options) {
  if (x.size() == 0) return true;
  Vector r = residual(x);
  double size = r.lpNorm<Eigen::Infinity>();
  for (int iteration = 0; iteration < 40 && size > options.tolerance; ++iteration) {
    const Eigen::MatrixXd matrix = jacobian(residual, x, r, options.perturbation);
    if (!matrix.allFinite()) return false;
    Eigen::JacobiSVD<Eigen::MatrixXd> decomposition(matrix, Eigen::ComputeThinU | Eigen::ComputeThinV);
    decomposition.setThreshold(1e-6);  // below it a singular value is the error of the differences
    const Vector step = decomposition.solve(-r);
    double share = 1;
    bool falls = false;
    for (int halving = 0; halving < 12 && !falls; ++halving, share *= 0.5) {
      const Vector trial = x + share * step;
      const Vector there = residual(trial);
      const double left = there.lpNorm<Eigen::Infinity>();
      falls = left < (1 - 1e-3 * share) * size;  // false for NaN, too
      if (!falls) continue;
      x = trial, r = there, size = left;
    }
    if (!falls) break;
  }
  return size <= options.acceptable;
}

}  // namespace sluice::element
