/// Obstacles: rigid regions inside the grid, what they do to the velocity of the nodes in them, and the force on them.
///
/// A node is in an obstacle if its place is. It then has the rule of the surface, with the normal of the nearest point
/// of that surface: docs/theory.md, section 3. Which nodes these are is found once for each block, and anew when the
/// blocks change or an obstacle moves.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "core/grid/faces.h"

namespace sluice {

template <int Dim>
class Obstacles {
 public:
  /// `places`: where the nodes of each axis stand [m]. `support`: how far from its node a shape function goes, in
  /// cells. `low`: lower ends of the axes [m]; `period`: lengths of those that are periodic [m], 0 for the others.
  Obstacles(const std::vector<ObstacleCase>& obstacles, std::array<std::vector<double>, Dim> places, double support,
            const Vector<Dim>& low = {}, const Vector<Dim>& period = {});

  bool any() const { return !obstacles_.empty(); }
  bool any_friction() const;
  bool any_adhesion() const;

  /// Places at `time`, and velocities for a step whose velocities change from one time to the other [s].
  void begin_step(double time, double time_before, double time_now);

  /// Velocities that are given whatever the forces are, as Faces::fix; nodes without mass are left alone.
  void fix(const NodeBlock<Dim>& nodes, std::size_t block, const Lane* momentum, Lane* motion, Moment moment) {
    if (any()) impose(nodes, block, momentum, motion, moment, {});
  }
  /// The same after forces have acted, as Faces::fix_with_friction. The impulse on each obstacle over `kick` is kept as
  /// the force on it, in the place of the last one of this block.
  void fix_with_friction(const NodeBlock<Dim>& nodes, std::size_t block, const Lane* momentum, Lane* motion,
                         const Beside& beside, double kick);

  /// Makes room for so many blocks of nodes; forgets what is known of those that are there.
  void resize(std::size_t node_blocks);
  /// What an obstacle does to a node that it holds, or, with adhesion, one that its surface is close to.
  struct Hold {
    std::size_t obstacle;     ///< its number
    const FaceCase* surface;  ///< its rule
    bool inside;              ///< if not, the surface is within the support of the node, and adheres to it
    Vector<Dim> out;          ///< unit normal, out of the material
  };
  /// All that acts on a node, in the order in which it acts, with the obstacles where they are.
  std::vector<Hold> holds_on(const Index<Dim>& node) const;
  std::size_t count() const { return obstacles_.size(); }
  /// Forces of the material on the obstacles [N] of a step that finds them for all blocks at once.
  void set_forces(const std::vector<Vector<Dim>>& forces);

  /// Force of the material on the obstacles in the last step [N], by name and axis: NAME_force_x_N.
  std::vector<std::pair<std::string, double>> forces() const;

  /// The obstacle that holds a point, and where the point lies to it; null: none. The first of several.
  const ObstacleCase* at(const Vector<Dim>& x, SignedDistance* where) const;
  /// Whether the obstacles hold this component of a node where it is, as far as single components can be held: with
  /// friction all of them, else those along which the surface is not flat.
  bool holds(const Index<Dim>& node, int component) const;

 private:
  struct Obstacle {
    ObstacleCase definition;
    SurfaceVelocity<Dim> velocity;
    Vector<Dim> travel{};                       ///< since time 0 [m]
    std::array<std::vector<double>, 2> bounds;  ///< at time 0
  };
  /// A node that an obstacle acts on.
  struct Contact {
    std::int32_t node, obstacle;
    bool inside;      ///< if not, the surface is within its support, and adheres to it
    Vector<Dim> out;  ///< unit normal, out of the material
  };
  struct Block {
    std::vector<Contact> contacts;
    std::int64_t version = -1;  ///< of the places of the obstacles
  };
  void impose(const NodeBlock<Dim>& nodes, std::size_t block, const Lane* momentum, Lane* motion, Moment moment,
              const Beside& beside);
  const std::vector<Contact>& contacts(const NodeBlock<Dim>& nodes, std::size_t block);
  void find(const NodeBlock<Dim>& nodes, std::size_t number, std::vector<Contact>& contacts) const;
  bool near(const Obstacle& obstacle, const NodeBlock<Dim>& nodes, const Vector<Dim>& margin) const;
  std::array<Index<Dim>, 2> range(const NodeBlock<Dim>& nodes) const;
  Vector<Dim> place(const Index<Dim>& node) const;
  SignedDistance where(const Obstacle& obstacle, Vector<Dim> x) const;
  bool acts(const Obstacle& obstacle, const Vector<Dim>& x, bool* inside, Vector<Dim>* out) const;

  std::vector<Obstacle> obstacles_;
  std::array<std::vector<double>, Dim> places_;
  Vector<Dim> low_, period_;        ///< [m]
  Vector<Dim> support_{};           ///< of a shape function along each axis [m]
  double hair_ = 0;                 ///< a node this close to the surface is in the obstacle [m]
  std::int64_t version_ = 0;        ///< of the places of the obstacles
  std::vector<Block> blocks_;       ///< by block of nodes
  std::vector<Vector<Dim>> force_;  ///< by block and obstacle: impulse [N s] within a step, then force [N]
};

extern template class Obstacles<2>;
extern template class Obstacles<3>;

}  // namespace sluice
