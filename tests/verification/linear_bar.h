/// Linear theory of a bar in the material point method: the matrix of one step for small displacements, about particles
/// that stay where they are. Wall, free end, lumping and time integration are in it as the equations (14)-(22) of
/// theory.md have them. What a scheme damps and how late it is are thereby known without a free number.
#pragma once

#include <Eigen/Dense>

#include "core/transfer/shape_kernels.h"
#include "tests/verification/scene_fixture.h"

namespace sluice {

/// A bar of unit density along the first axis. Either fixed at x = 0 and free at x = length, two particles in the width
/// of a cell, vibrating from the velocity v0 sin(k x) on; or of particles anywhere, held by nothing, of which is asked
/// whether it is stable.
class LinearBar {
 public:
  using Matrix = Eigen::MatrixXd;
  using Vector = Eigen::VectorXd;

  LinearBar(const Scheme& scheme, int xpic_order, double length, double modulus, double h, double dt)
      : scheme_(scheme), order_(xpic_order), modulus_(modulus), dt_(dt), h_(h) {
    place_ = Vector::LinSpaced(std::lround(2 * length / h), h / 4, length - h / 4);
    sum_stencils(static_cast<int>(std::lround(27 / h)), 2);
    step_ = matrix();
    state_ = Vector::Zero(step_.rows());
  }
  /// `per_cell` particles in the width of a cell of unit size, in a grid of so many cells.
  LinearBar(const Scheme& scheme, int xpic_order, const Vector& place, int per_cell, int cells, double modulus,
            double dt)
      : scheme_(scheme), order_(xpic_order), held_(false), modulus_(modulus), dt_(dt), h_(1), place_(place) {
    sum_stencils(cells, per_cell);
    step_ = matrix();
  }

  /// By how much the fastest growing motion grows in a step; 1 where none does.
  double growth() const { return Eigen::EigenSolver<Matrix>(step_, false).eigenvalues().cwiseAbs().maxCoeff(); }

  /// Returns the energy, which is kinetic.
  double start(double v0, double k) {
    const auto n = place_.size();
    mode_ = (k * place_).array().sin();
    state_.head(n) = v0 * mode_;
    if (scheme_.affine()) state_.tail(n) = v0 * k * (k * place_).array().cos();
    const double initial_energy = energy();
    // USF strains over the step before, of which there is none: what the first step will add must not be there.
    if (scheme_.stress_update == "usf") state_.segment(n, n) = -modulus_ * dt_ * slope_ * (held(carried()) * state_);
    return initial_energy;
  }
  void advance() { state_ = step_ * state_; }
  /// Share of the mode in the velocities, and the energy.
  double amplitude() const { return state_.head(place_.size()).dot(mode_) / mode_.squaredNorm(); }
  double energy() const {
    const auto n = place_.size();
    return 0.25 * h_ * (state_.head(n).squaredNorm() + state_.segment(n, n).squaredNorm() / modulus_);
  }

 private:
  /// Values, slopes and APIC's weights, and the inverse masses of the nodes; a row a particle, a column a node.
  void sum_stencils(int cells, int per_cell) {
    const auto shape = shape_registry<2>().find(scheme_.shape, {})();
    const GridGeometry<2> grid{{0, 0}, {cells * h_, h_}, {h_, h_}, {cells, 1}};
    const int nodes = cells + shape->reach();
    wall_ = shape->outside();
    value_ = slope_ = moment_ = distance_ = Matrix::Zero(place_.size(), nodes);
    std::array<double, domain_capacity<2>> domain{};
    shape->fill_domain(grid, 1.0 / per_cell, domain);
    for (Eigen::Index p = 0; p < place_.size(); ++p) {
      const Stencil<2> s = shape->stencil(grid, {place_[p], h_ / 4}, domain);
      for (std::size_t n = 0; n < static_cast<std::size_t>(s.count); ++n) {
        value_(p, s.node[n][0]) += s.value[n];
        slope_(p, s.node[n][0]) += s.gradient[n][0];
      }
      for (int i = 0; i < nodes; ++i) distance_(p, i) = shape->node_position(grid, 0, i) - place_[p];
      moment_.row(p) = value_.row(p).cwiseProduct(distance_.row(p));
      moment_.row(p) /= moment_.row(p).dot(distance_.row(p));
    }
    const Vector mass = value_.colwise().sum().transpose();
    inverse_mass_ = mass.unaryExpr([](double m) { return m > 0 ? 1 / m : 0; });
    // Very light nodes take no force, unless it comes to them as momentum.
    const double least = scheme_.affine() && scheme_.stress_update != "usf" ? 0 : shape->negligible_weight();
    accelerated_ = mass.unaryExpr([&](double m) { return m > least ? 1 / m : 0; });
  }

  Matrix held(Matrix nodes) const {
    if (held_) nodes.row(wall_).setZero();
    return nodes;
  }

  /// The velocity of the nodes from the state of the particles: velocity, stress and, of affine transfers, the affine
  /// velocity.
  Matrix carried() const {
    const Eigen::Index n = place_.size();
    Matrix nodes = Matrix::Zero(value_.cols(), n * (scheme_.affine() ? 3 : 2));
    nodes.leftCols(n) = inverse_mass_.asDiagonal() * value_.transpose();
    if (scheme_.affine()) nodes.rightCols(n) = inverse_mass_.asDiagonal() * value_.cwiseProduct(distance_).transpose();
    return nodes;
  }

  Matrix matrix() const {
    const Matrix carried = this->carried();
    const Eigen::Index n = place_.size(), size = carried.cols();
    Matrix velocity = Matrix::Zero(n, size), stress = velocity;
    velocity.leftCols(n).setIdentity();
    stress.middleCols(n, n).setIdentity();
    if (scheme_.stress_update == "usf") stress += modulus_ * dt_ * slope_ * held(carried);
    const Matrix moved = held(carried - dt_ * accelerated_.asDiagonal() * slope_.transpose() * stress);
    Matrix after = Matrix::Zero(size, size);
    after.topRows(n) = value_ * moved;
    if (scheme_.transfer == "flip") after.topRows(n) += velocity - value_ * carried;
    if (scheme_.transfer == "xpic") after.topLeftCorner(n, n) += value_ * correction(carried.leftCols(n));
    if (scheme_.affine()) after.bottomRows(n) = (scheme_.transfer == "tpic" ? slope_ : moment_) * moved;
    if (scheme_.stress_update == "usl") stress += modulus_ * dt_ * slope_ * moved;
    if (scheme_.stress_update == "musl") stress += modulus_ * dt_ * slope_ * held(carried * after);
    after.middleRows(n, n) = stress;
    return after;
  }

  /// w of (20b).
  Matrix correction(const Matrix& to_nodes) const {
    Matrix u = held(to_nodes), w = -u;
    double binomial = 1;
    for (int k = 1; k <= order_; ++k) {
      binomial *= static_cast<double>(order_ - k + 1) / k;
      w += (k % 2 == 1 ? 1 : -1) * binomial * u;
      u = held(to_nodes * (value_ * u));
    }
    return w;
  }

  Scheme scheme_;
  int order_, wall_ = 0;
  bool held_ = true;
  double modulus_, dt_, h_;
  Vector place_, mode_, inverse_mass_, accelerated_, state_;
  Matrix value_, slope_, moment_, distance_, step_;
};

}  // namespace sluice
