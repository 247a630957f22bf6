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

template <int Dim>
void Faces<Dim>::begin_step(double time_before, double time_now) {
  for (std::size_t f = 0; f < face_.size(); ++f) velocity_[f].evaluate(face_[f], time_before, time_now);
}

template <int Dim>
Touch<Dim> Faces<Dim>::touch_of(int axis, int side, Moment moment) const {
  const SurfaceVelocity<Dim>& velocity = velocity_[static_cast<std::size_t>(2 * axis + side)];
  Touch<Dim> touch;
  touch.out[axis] = side == 0 ? -1 : 1;
  touch.velocity = moment == Moment::before ? velocity.before : velocity.now;
  touch.friction = moment == Moment::kicked;
  return touch;
}

template <int Dim>
void Faces<Dim>::impose(const NodeBlock<Dim>& nodes, Lane* motion, Moment moment, const Beside& beside) const {
  constexpr int width = block_width<Dim>;
  for (int axis = 0; axis < Dim; ++axis)
    for (int side = 0; side < 2; ++side) {
      const FaceCase& rule = face(axis, side);
      const int layer = wall_node(axis, side) - nodes.first_node[axis];
      if (rule.normal == FaceCase::Normal::free || layer < nodes.low[axis] || layer >= nodes.high[axis]) continue;
      Touch<Dim> touch = touch_of(axis, side, moment);
      for (int n = 0; n < block_nodes<Dim>; ++n) {
        if (n / power(width, axis) % width != layer) continue;
        if (beside.relief != nullptr) touch.relief[axis] = beside.relief[n][axis];
        if (beside.area != nullptr)
          touch.adhesion = rule.adhesion * std::max(0.0, touch.out[axis] * beside.area[n][axis]);
        impose_on_node<Dim>(rule, touch, {motion + n * motion_lanes<Dim>});
      }
    }
}

template <int Dim>
void Faces<Dim>::fix_node(int axis, int side, const NodeMotion<Dim>& node) const {
  impose_on_node<Dim>(face(axis, side), touch_of(axis, side, Moment::kicked), node);
}

namespace {

bool has_friction(const FaceCase& face) {
  return face.normal != FaceCase::Normal::free && face.tangential == FaceCase::Tangential::friction;
}

}  // namespace

template <int Dim>
bool Faces<Dim>::any_friction() const {
  return std::any_of(face_.begin(), face_.end(), has_friction);
}

template <int Dim>
bool Faces<Dim>::any_adhesion() const {
  return std::any_of(face_.begin(), face_.end(), [](const FaceCase& face) { return face.adhesion > 0; });
}

template class Faces<2>;
template class Faces<3>;

}  // namespace sluice
