/// Faces: what the sides of the grid do to the velocity of the nodes on them.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/case/case.h"
#include "core/grid/blocks.h"
#include "core/grid/contact.h"
#include "core/grid/lane.h"
#include "core/grid/nodes.h"

namespace sluice {

/// Names of the faces, lower then upper, axis by axis; the last axis points up.
std::vector<std::string> face_names(int dimension);

template <int Dim>
class Faces {
 public:
  /// Throws CaseError for a face that this dimension does not have. `reach` and `outside` are those of the shape
  /// functions.
  Faces(const std::map<std::string, FaceCase>& faces, const GridGeometry<Dim>& grid, int reach, int outside = 0);

  /// Velocities of faces that move, for a step whose velocities change from one time to the other [s].
  void begin_step(double time_before, double time_now);

  /// Velocities that are given whatever the forces are: normal fixed, tangential fixed. Acts on the motion of a node
  /// block; the change is added to dv as well.
  void fix(const NodeBlock<Dim>& nodes, Lane* motion, Moment moment = Moment::now) const {
    impose(nodes, motion, moment, {});
  }

  /// The same after forces have acted, with Coulomb friction: the normal impulse m v_n that the wall takes up limits
  /// the tangential impulse to friction * m v_n. A wall that is being pulled (v_n away from it) gives no friction.
  void fix_with_friction(const NodeBlock<Dim>& nodes, Lane* motion, const Beside& beside = {}) const {
    impose(nodes, motion, Moment::kicked, beside);
  }
  /// The same for one node of a face.
  void fix_node(int axis, int side, const NodeMotion<Dim>& node) const;
  bool any_friction() const;
  bool any_adhesion() const;

  const FaceCase& face(int axis, int side) const { return face_[static_cast<std::size_t>(2 * axis + side)]; }
  /// The node on the wall.
  int wall_node(int axis, int side) const {
    return side == 0 ? first_node_ : last_node_[static_cast<std::size_t>(axis)];
  }

 private:
  void impose(const NodeBlock<Dim>& nodes, Lane* motion, Moment moment, const Beside& beside) const;
  Touch<Dim> touch_of(int axis, int side, Moment moment) const;

  std::array<FaceCase, 2 * Dim> face_{};
  int first_node_;
  std::array<SurfaceVelocity<Dim>, 2 * Dim> velocity_{};
  Index<Dim> last_node_{};
};

extern template class Faces<2>;
extern template class Faces<3>;

}  // namespace sluice
