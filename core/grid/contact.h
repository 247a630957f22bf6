/// What the surface of a face or an obstacle does to the velocity of one node. docs/theory.md, sections 1 and 3.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/case/case.h"
#include "core/grid/geometry.h"
#include "core/grid/lane.h"

namespace sluice {

/// Velocity components of a node, and their change in this step, wherever the motion lanes keep them.
template <int Dim>
struct NodeMotion {
  Lane* lanes;
  double v(int a) const { return lanes[0][a]; }
  double change(int a) const { return Dim == 2 ? lanes[0][2 + a] : lanes[Dim - 2][a]; }
  Vector<Dim> velocity() const {
    Vector<Dim> all;
    for (int a = 0; a < Dim; ++a) all[a] = v(a);
    return all;
  }
  void set(int a, double value) const {
    const double change = value - lanes[0][a];
    lanes[0][a] = value;
    if constexpr (Dim == 2)
      lanes[0][2 + a] += change;
    else
      lanes[1][a] += change;
  }
};

/// How a node meets a surface.
template <int Dim>
struct Touch {
  Vector<Dim> out{};       ///< unit normal, out of the material
  Vector<Dim> velocity{};  ///< of the surface [m/s]
  bool friction = false;   ///< forces have acted: the tangential impulse is limited
  Vector<Dim> relief{};    ///< part of the velocity that presses without friction [m/s]
  double adhesion = 0;     ///< most of the speed that adhesion takes [m/s]
};

/// The velocity of a node relative to a surface, along it.
template <int Dim>
Vector<Dim> slip_of(const Touch<Dim>& touch, const NodeMotion<Dim>& node, double into) {
  Vector<Dim> slip;
  for (int a = 0; a < Dim; ++a) slip[a] = node.v(a) - touch.velocity[a] - into * touch.out[a];
  return slip;
}

/// The share of a slip that is left when `most` may be taken from its speed [m/s].
template <int Dim>
double share_left(const Vector<Dim>& slip, double most) {
  double squared = 0;
  for (const double component : slip) squared += component * component;
  const double speed = std::sqrt(squared);
  return speed > most ? 1 - most / speed : 0;
}

/// How fast a node comes towards a surface.
template <int Dim>
double speed_into(const Touch<Dim>& touch, const NodeMotion<Dim>& node) {
  double into = 0;
  for (int a = 0; a < Dim; ++a) into += (node.v(a) - touch.velocity[a]) * touch.out[a];
  return into;
}

/// Imposes the rule, which is not free. Friction: the normal impulse m (v - w) . n that the surface takes up limits the
/// tangential impulse; one that is being pulled gives none.
template <int Dim>
void impose_on_node(const FaceCase& rule, const Touch<Dim>& touch, const NodeMotion<Dim>& node) {
  const double into = speed_into(touch, node);
  if (rule.normal == FaceCase::Normal::contact && into <= 0) return;
  const Vector<Dim> slip = slip_of(touch, node, into);
  double keep = 1;
  if (rule.tangential == FaceCase::Tangential::fixed) {
    keep = 0;
  } else if (rule.tangential == FaceCase::Tangential::friction && touch.friction) {
    double pressing = into;
    for (int a = 0; a < Dim; ++a) pressing -= touch.relief[a] * touch.out[a];
    keep = share_left<Dim>(slip, rule.friction * std::max(0.0, pressing) + touch.adhesion);
  }
  for (int a = 0; a < Dim; ++a) node.set(a, touch.velocity[a] + keep * slip[a]);
}

/// A node beside a surface, with a share in what it touches: adhesion slows its slip, and nothing else.
template <int Dim>
void adhere_on_node(const Touch<Dim>& touch, const NodeMotion<Dim>& node) {
  const Vector<Dim> slip = slip_of(touch, node, speed_into(touch, node));
  const double taken = 1 - share_left<Dim>(slip, touch.adhesion);
  for (int a = 0; a < Dim; ++a) node.set(a, node.v(a) - taken * slip[a]);
}

/// Velocities of a surface at the two moments that a step asks for.
template <int Dim>
struct SurfaceVelocity {
  Vector<Dim> before{};  ///< in the middle of the last step [m/s]
  Vector<Dim> now{};     ///< in the middle of this one

  void evaluate(const FaceCase& rule, double time_before, double time_now) {
    for (std::size_t a = 0; a < rule.velocity.size(); ++a) {
      before[a] = rule.velocity[a].at(time_before);
      now[a] = rule.velocity[a].at(time_now);
    }
  }
};

/// Which velocities of the nodes are at hand.
enum class Moment {
  before,  ///< those that the particles brought along: the middle of the last step
  now,     ///< the new ones, from particles that have them already: no forces have acted since
  kicked,  ///< the new ones, after forces: friction acts
};

/// What further acts on the nodes of a block, node by node; null: nothing.
struct Beside {
  /// {x, y, (z)} [m/s]: a part of the velocity whose impulse on the wall gives no friction, that of pore water.
  const Lane* relief = nullptr;
  /// {x, y, (z)} [m/s per Pa]: the speed that a traction of 1 Pa takes, times the normal of the surface.
  const Lane* area = nullptr;
};

}  // namespace sluice
