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
    if (any()) impose(nodes, block, momentum, motion, moment, {}, 0);
  }
  /// The same after forces have acted, as Faces::fix_with_friction. The impulse on each obstacle over `kick` is added
  /// to the force on it.
  void fix_with_friction(const NodeBlock<Dim>& nodes, std::size_t block, const Lane* momentum, Lane* motion,
                         const Beside& beside, double kick) {
    if (any()) impose(nodes, block, momentum, motion, Moment::kicked, beside, kick);
  }
  /// To be called before: the force on the obstacles from a block is what the pressure of a fluid there does.
  void start_force(std::size_t block);

  /// A fluid in the pores does not pass the surfaces: its velocity relative to the material, in the motion of the nodes
  /// in the obstacles, loses what is normal to them, at rest or moving.
  void close(const NodeBlock<Dim>& nodes, std::size_t block, Lane* motion);

  // ---- the pressure of a fluid on the surfaces, docs/theory.md, eq. (49a) ----

  /// A node whose support a surface reaches, or that lies in an obstacle.
  struct Near {
    std::int32_t node, obstacle;  ///< the nearest one
    std::array<bool, Dim> bound;  ///< by axis: whether the surface acts along it; not on a face of the grid that gives
    std::array<bool, Dim> held;   ///< by axis: on a face of the grid that is fixed at rest
    Vector<Dim> normal{};         ///< of the nearest surface, out of the obstacle
    Vector<Dim> traction{};       ///< force of the fluid's pressure on the surface, taken back from the node [N]
  };
  /// On which faces of the grid nodes are: to be called before any surroundings are asked for.
  void note_faces(const Faces<Dim>& faces);
  /// Those of a block. Each block is to be asked for by one thread at a time.
  const std::vector<Near>& surroundings(const NodeBlock<Dim>& nodes, std::size_t block);
  Vector<Dim> velocity(int obstacle) const { return obstacles_[static_cast<std::size_t>(obstacle)].velocity.now; }
  /// Adds to the forces of the nodes around the surfaces the traction -sum V grad(N q) of a pressure q, `slopes` being
  /// {., sum V N grad q} and `spread` {0, -sum V q grad N}. With `again` it takes the place of the last one.
  void press(const NodeBlock<Dim>& nodes, std::size_t block, const Lane* slopes, const Lane* spread, Lane* force,
             bool again);
  /// Adds the velocities that these tractions give within `kick` to `relief`, which Beside has.
  void add_relief(std::size_t block, const Lane* momentum, double kick, Lane* relief) const;

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

  /// Changes whenever an obstacle has moved.
  std::int64_t version() const { return version_; }
  /// From the nearest surface, negative inside, and whose it is; of no use where there are no obstacles.
  SignedDistance nearest(const Vector<Dim>& x, const ObstacleCase** whose = nullptr) const;
  /// Whether the box around an obstacle reaches the box between two points.
  bool reach(const Vector<Dim>& low, const Vector<Dim>& high) const;
  /// Whether a node is one of the surroundings, and bound along an axis.
  bool surround(const Index<Dim>& node, int axis) const;

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
    std::vector<Near> near;
    std::int64_t near_version = -1;
  };
  void impose(const NodeBlock<Dim>& nodes, std::size_t block, const Lane* momentum, Lane* motion, Moment moment,
              const Beside& beside, double kick);
  const std::vector<Contact>& contacts(const NodeBlock<Dim>& nodes, std::size_t block);
  void find(const NodeBlock<Dim>& nodes, std::size_t number, std::vector<Contact>& contacts) const;
  bool near(const Obstacle& obstacle, const NodeBlock<Dim>& nodes, const Vector<Dim>& margin) const;
  double support_along(const Vector<Dim>& normal) const;
  int nearest_within_support(const Index<Dim>& node, Vector<Dim>& normal) const;
  Near near_of(const Index<Dim>& node) const;
  std::array<Index<Dim>, 2> range(const NodeBlock<Dim>& nodes) const;
  Vector<Dim> place(const Index<Dim>& node) const;
  SignedDistance where(const Obstacle& obstacle, Vector<Dim> x) const;
  bool acts(const Obstacle& obstacle, const Vector<Dim>& x, bool* inside, Vector<Dim>* out) const;

  std::vector<Obstacle> obstacles_;
  std::array<std::vector<double>, Dim> places_;
  Vector<Dim> low_, period_;  ///< [m]
  struct GridFace {
    int axis, layer;
    bool held;
  };
  std::vector<GridFace> grid_faces_;
  Vector<Dim> support_{};           ///< of a shape function along each axis [m]
  double hair_ = 0;                 ///< a node this close to the surface is in the obstacle [m]
  std::int64_t version_ = 0;        ///< of the places of the obstacles
  std::vector<Block> blocks_;       ///< by block of nodes
  std::vector<Vector<Dim>> force_;  ///< by block and obstacle: impulse [N s] within a step, then force [N]
};

extern template class Obstacles<2>;
extern template class Obstacles<3>;

}  // namespace sluice
