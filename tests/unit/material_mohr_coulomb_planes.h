/// Mohr-Coulomb with tension cut-off as a general polyhedron: nine planes in the space of unsorted principal stresses.
/// An independent reference for the return map: no sorting, no regions, no closed forms, only Koiter's conditions.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "physics/materials/mohr_coulomb_return.h"

namespace sluice::reference {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// f = normal . s - limit <= 0; plastic strain flows along `flow`.
struct Plane {
  Vector3d normal, flow;
  double limit;
};

class Polyhedron {
 public:
  explicit Polyhedron(const MohrCoulombParameters& p) {
    const double n = std::sin(p.friction_angle), m = std::sin(p.dilation_angle);
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        if (i == j) continue;
        Plane plane{Vector3d::Zero(), Vector3d::Zero(), 2 * p.cohesion * std::cos(p.friction_angle)};
        plane.normal[i] = 1 + n;
        plane.normal[j] = -(1 - n);
        plane.flow[i] = 1 + m;
        plane.flow[j] = -(1 - m);
        planes.push_back(plane);
      }
    }
    if (std::isfinite(p.tension_cutoff)) {
      for (int i = 0; i < 3; ++i) planes.push_back({Vector3d::Unit(i), Vector3d::Unit(i), p.tension_cutoff});
    }
    stiffness = Matrix3d::Constant(p.elasticity.lambda) + 2 * p.elasticity.shear * Matrix3d::Identity();
  }

  double worst(const Vector3d& s) const {
    double value = -INFINITY;
    for (const Plane& plane : planes) value = std::max(value, plane.normal.dot(s) - plane.limit);
    return value;
  }

  /// Multipliers of the given planes that bring `trial` onto all of them; false if they depend on each other.
  bool solve(const std::vector<int>& active, const Vector3d& trial, Eigen::VectorXd& multipliers) const {
    const int n = static_cast<int>(active.size());
    Eigen::MatrixXd matrix(n, n);
    Eigen::VectorXd right(n);
    for (int i = 0; i < n; ++i) {
      const Plane& a = planes[active[i]];
      right[i] = a.normal.dot(trial) - a.limit;
      for (int j = 0; j < n; ++j) matrix(i, j) = a.normal.dot(stiffness * planes[active[j]].flow);
    }
    const Eigen::FullPivLU<Eigen::MatrixXd> factor(matrix / stiffness(0, 0));
    if (!factor.isInvertible()) return false;
    multipliers = factor.solve(right) / stiffness(0, 0);
    return true;
  }

  Vector3d returned(const std::vector<int>& active, const Vector3d& trial, const Eigen::VectorXd& multipliers) const {
    Vector3d s = trial;
    for (std::size_t i = 0; i < active.size(); ++i) s -= multipliers[i] * (stiffness * planes[active[i]].flow);
    return s;
  }

  /// All stresses that satisfy Koiter's conditions for this trial: every set of up to three planes is tried.
  std::vector<Vector3d> solutions(const Vector3d& trial, double stress_tolerance) const {
    if (worst(trial) <= 0) return {trial};
    std::vector<Vector3d> found;
    const int n = static_cast<int>(planes.size());
    const auto consider = [&](const std::vector<int>& active) {
      Eigen::VectorXd multipliers;
      if (!solve(active, trial, multipliers)) return;
      if (multipliers.minCoeff() * stiffness(0, 0) < -stress_tolerance) return;
      const Vector3d s = returned(active, trial, multipliers);
      if (worst(s) <= stress_tolerance) found.push_back(s);
    };
    for (int i = 0; i < n; ++i) {
      consider({i});
      for (int j = i + 1; j < n; ++j) {
        consider({i, j});
        for (int k = j + 1; k < n; ++k) consider({i, j, k});
      }
    }
    return found;
  }

  std::vector<Plane> planes;
  Matrix3d stiffness;
};

}  // namespace sluice::reference
