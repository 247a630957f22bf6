#include "core/grid/dashpots.h"

#include <algorithm>

namespace sluice {

template <int Dim>
Dashpots<Dim>::Dashpots(const Faces<Dim>& faces, const GridGeometry<Dim>& grid, int reach, int bodies) {
  for (int a = 0; a < Dim; ++a) nodes_[a] = grid.cells[a] + reach;
  for (int axis = 0; axis < Dim; ++axis)
    for (int side = 0; side < 2; ++side) {
      const FaceCase& rule = faces.face(axis, side);
      if (!rule.absorbing) continue;
      std::size_t count = 1;
      for (int a = 0; a < Dim; ++a)
        if (a != axis) count *= static_cast<std::size_t>(nodes_[a]);
      faces_.push_back({axis, faces.wall_node(axis, side), side == 0 ? -1.0 : 1.0, *rule.absorbing, count,
                        std::vector<Vector<Dim>>(static_cast<std::size_t>(bodies) * count, Vector<Dim>{})});
    }
  any_ = !faces_.empty();
}

template <int Dim>
std::size_t Dashpots<Dim>::number_on_face(const Index<Dim>& node, int axis) const {
  std::size_t number = 0;
  for (int a = Dim - 1; a >= 0; --a)
    if (a != axis) number = number * static_cast<std::size_t>(nodes_[a]) + static_cast<std::size_t>(node[a]);
  return number;
}

namespace {

/// What is left of a velocity that goes from `before` to `after` in a step, with a dashpot that takes the share `rate`
/// of the mean of old and new velocity: stable for any rate.
double damped(double before, double after, double rate) { return (after - 0.5 * rate * before) / (1 + 0.5 * rate); }

}  // namespace

template <int Dim>
void Dashpots<Dim>::impose_on_block(const NodeBlock<Dim>& nodes, int body, Lane* motion, const Lane* area, double kick,
                                    bool first) {
  constexpr int width = block_width<Dim>;
  for (Face& face : faces_) {
    const int layer = face.layer - nodes.first_node[face.axis];
    if (layer < nodes.low[face.axis] || layer >= nodes.high[face.axis]) continue;
    for (int n = 0; n < block_nodes<Dim>; ++n) {
      Index<Dim> node;
      bool reached = n / power(width, face.axis) % width == layer;
      for (int a = 0, rest = n; a < Dim; ++a, rest /= width) {
        const int i = rest % width;
        node[a] = nodes.first_node[a] + i;  // the margins of tiles go beyond the grid
        reached = reached && i >= nodes.low[a] && i < nodes.high[a] && node[a] >= 0 && node[a] < nodes_[a];
      }
      if (!reached) continue;
      const NodeMotion<Dim> own{motion + n * motion_lanes<Dim>};
      Vector<Dim>& held = face.held[static_cast<std::size_t>(body) * face.nodes + number_on_face(node, face.axis)];
      const double per_pascal = face.beyond.density * std::max(0.0, face.outward * area[n][face.axis]);
      for (int a = 0; a < Dim; ++a) {
        const double before = own.v(a) - own.change(a);
        if (first && kick > 0) held[a] = -own.change(a) / kick;
        const double speed = a == face.axis ? face.beyond.p_wave : face.beyond.s_wave;
        own.set(a, damped(before, own.v(a) + kick * held[a], per_pascal * speed));
      }
    }
  }
}

template <int Dim>
std::vector<double> Dashpots<Dim>::record() const {
  std::vector<double> numbers;
  for (const Face& face : faces_)
    for (const Vector<Dim>& held : face.held) numbers.insert(numbers.end(), held.begin(), held.end());
  return numbers;
}

template <int Dim>
void Dashpots<Dim>::restore(const std::vector<double>& record) {
  std::size_t next = 0;
  for (Face& face : faces_)
    for (Vector<Dim>& held : face.held)
      for (double& component : held) component = record.at(next++);
}

template class Dashpots<2>;
template class Dashpots<3>;

}  // namespace sluice
