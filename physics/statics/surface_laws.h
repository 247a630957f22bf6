/// SurfaceLaws: what faces and obstacles ask of the displacements of nodes in a step that goes from one balance of
/// forces to the next. docs/theory.md, eqs. (29f) and (29g).
///
/// What a surface holds whatever the forces are is given: it is no unknown. What depends on the forces, contact and
/// friction, and a normal that is no axis of the grid, is a law: an equation that takes the place of the balance of the
/// node. With r, the force that the surface has to supply for balance, the laws are exact: where material sticks, it
/// does not slip, and where it slips, it feels mu N.
#pragma once

#include <Eigen/SparseCore>
#include <limits>
#include <span>
#include <vector>

#include "physics/statics/grid_unknowns.h"

namespace sluice {

template <int Dim>
class SurfaceLaws {
 public:
  /// For a step of `dt` [s] from the time of the scene. `unknowns`: those of all nodes that particles reach, with
  /// Fixed::none. Forces that come to `impose` are `scale` times those of the step, 1 or more.
  SurfaceLaws(Scene<Dim>& scene, const Unknowns<Dim>& unknowns, double dt, double scale);

  /// Whether a component is given; its displacement in the step [m] and its velocity at the end [m/s].
  bool given(int unknown) const { return owner_[static_cast<std::size_t>(unknown)] >= 0; }
  double displacement(int unknown) const { return displacement_[static_cast<std::size_t>(unknown)]; }
  double velocity(int unknown) const { return velocity_[static_cast<std::size_t>(unknown)]; }
  bool any() const { return !laws_.empty(); }

  /// How steeply laws rise with the displacement, after the stiffnesses of the unknowns [N/m]; adds it to the lower
  /// triangle of a matrix of all unknowns, which then resembles the derivative of what `impose` makes.
  void stiffen(const Eigen::VectorXd& diagonal, std::vector<Eigen::Triplet<double>>& matrix);

  /// f: in, the forces r out of balance [N] at the displacements u [m]; out, what is zero where laws hold. Components
  /// that are given keep r. `loads` [N]: the part of the forces from outside that acts on the surface of the material,
  /// and gives no friction.
  void impose(std::span<const double> u, const Eigen::VectorXd& loads, std::span<double> f);

  /// After `impose`: forces of the material on the surfaces [N], obstacles first, then faces.
  const std::vector<Vector<Dim>>& forces() const { return force_; }
  /// After `impose`: gives nodes that lie on a surface, or stick to it, its velocity.
  void stop(std::span<double> velocity) const;

 private:
  struct Law {
    std::size_t first;  // the unknown of the first component of its node
    int owner;          // its surface
    const FaceCase* rule;
    bool touches;  // if not, the surface adheres only
    bool normal_given;
    bool dragged;     // along the surface, in some direction, by others
    Vector<Dim> out;  // unit normal, out of the material; where the normal is not given, in what is free
    double share;     // of the surface's normal that is in what is free
    Vector<Dim> displacement, velocity;
    double adhesion = 0;  // [N]
    double normal_stiffness = 0, stiffness = 0;
    bool closed = false, sticks = false;
  };
  void add(std::size_t first, int owner, const FaceCase& rule, bool touches, const Vector<Dim>& out, double area);
  void give(std::size_t unknown, int owner, double displacement, double velocity);
  void find(const Index<Dim>& node, std::size_t first, const Vector<Dim>& area);
  void reduce(Law& law);
  std::vector<Vector<Dim>> areas(const Unknowns<Dim>& unknowns);
  void impose(Law& law, std::span<const double> u, const Eigen::VectorXd& loads, std::span<double> f);
  Vector<Dim> rub(const Law& law, const Vector<Dim>& slip, double most);

  Scene<Dim>& scene_;
  double dt_, scale_;
  std::vector<int> owner_;  // by unknown: the surface that gives it, or -1
  std::vector<double> displacement_, velocity_;
  std::vector<Law> laws_;
  std::vector<Vector<Dim>> force_;
};

extern template class SurfaceLaws<2>;
extern template class SurfaceLaws<3>;

}  // namespace sluice
