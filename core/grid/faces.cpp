#include "core/grid/faces.h"

#include <algorithm>
#include <cmath>

namespace sluice {

std::vector<std::string> face_names(int dimension) {
  if (dimension == 2) return {"left", "right", "bottom", "top"};
  return {"left", "right", "front", "back", "bottom", "top"};
}

template <int Dim>
Faces<Dim>::Faces(const std::map<std::string, FaceCase>& faces, const GridGeometry<Dim>& grid, int reach, int outside)
    : first_node_(outside) {
  const auto names = face_names(Dim);
  for (const auto& [name, face] : faces) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) throw CaseError("the grid has no face called '" + name + "'");
    face_[static_cast<std::size_t>(found - names.begin())] = face;
  }
  for (int a = 0; a < Dim; ++a) last_node_[a] = grid.cells[a] + reach - 1 - outside;
}

namespace {

/// Velocity components of a node, and their change in this step, wherever the motion lanes keep them.
template <int Dim>
struct NodeMotion {
  Lane* lanes;
  double v(int a) const { return lanes[0][a]; }
  void set(int a, double value) const {
    const double change = value - lanes[0][a];
    lanes[0][a] = value;
    if constexpr (Dim == 2)
      lanes[0][2 + a] += change;
    else
      lanes[1][a] += change;
  }
};

/// `outward` is -1 on a lower face and +1 on an upper one; `relief` is the velocity along the axis that presses without
/// friction.
template <int Dim>
void impose_on_node(const FaceCase& face, int axis, double outward, bool friction, double relief,
                    const NodeMotion<Dim>& node) {
  if (face.normal == FaceCase::Normal::free) return;
  const double pressing = std::max(0.0, outward * (node.v(axis) - relief));
  node.set(axis, 0);
  double keep = 1;
  if (face.tangential == FaceCase::Tangential::fixed) {
    keep = 0;
  } else if (face.tangential == FaceCase::Tangential::friction && friction) {
    double squared = 0;
    for (int a = 0; a < Dim; ++a)
      if (a != axis) squared += node.v(a) * node.v(a);
    const double speed = std::sqrt(squared);
    keep = speed > face.friction * pressing ? 1 - face.friction * pressing / speed : 0;
  } else {
    return;
  }
  for (int a = 0; a < Dim; ++a)
    if (a != axis) node.set(a, keep * node.v(a));
}

}  // namespace

template <int Dim>
void Faces<Dim>::impose(const NodeBlock<Dim>& nodes, Lane* motion, bool friction, const Lane* relief) const {
  constexpr int width = block_width<Dim>;
  for (int axis = 0; axis < Dim; ++axis)
    for (int side = 0; side < 2; ++side) {
      const FaceCase& rule = face(axis, side);
      const int layer = wall_node(axis, side) - nodes.first_node[axis];
      if (rule.normal == FaceCase::Normal::free || layer < nodes.low[axis] || layer >= nodes.high[axis]) continue;
      for (int n = 0; n < block_nodes<Dim>; ++n) {
        if (n / power(width, axis) % width != layer) continue;
        impose_on_node<Dim>(rule, axis, side == 0 ? -1 : 1, friction, relief != nullptr ? relief[n][axis] : 0,
                            {motion + n * motion_lanes<Dim>});
      }
    }
}

template <int Dim>
bool Faces<Dim>::any_friction() const {
  return std::any_of(face_.begin(), face_.end(), [](const FaceCase& face) {
    return face.normal == FaceCase::Normal::fixed && face.tangential == FaceCase::Tangential::friction;
  });
}

template class Faces<2>;
template class Faces<3>;

}  // namespace sluice
