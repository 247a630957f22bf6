#include "physics/two_phase/thin_films.h"

#include <map>

namespace sluice {

namespace {

/// Mass of the inner node over that of the one on the face, below which they move as one. A film of even thickness d
/// has about d (quadratic B-splines; 2/3 d and less with linear functions), material that fills the cells 1.5 to 2.
constexpr double light = 0.5;

}  // namespace

template <int Dim>
void ThinFilms<Dim>::find(const Scene<Dim>& scene) {
  const auto& blocks = scene.blocks.node_blocks();
  std::map<Index<Dim>, std::size_t> number_of;
  for (std::size_t b = 0; b < blocks.size(); ++b) number_of[blocks[b].first_node] = b;
  pairs_.clear();
  for (int axis = 0; axis < Dim; ++axis)
    for (int side = 0; side < 2; ++side) {
      if (scene.faces.face(axis, side).normal == FaceCase::Normal::free) continue;
      const int stride = power(block_width<Dim>, axis), inwards = side == 0 ? 1 : -1;
      for (std::size_t b = 0; b < blocks.size(); ++b) {
        const int layer = scene.faces.wall_node(axis, side) - blocks[b].first_node[axis];
        if (layer < blocks[b].low[axis] || layer >= blocks[b].high[axis]) continue;
        Index<Dim> next = blocks[b].first_node;
        const bool same = layer + inwards >= 0 && layer + inwards < block_width<Dim>;
        next[axis] += same ? 0 : inwards * block_width<Dim>;
        const auto other = number_of.find(next);
        if (other == number_of.end()) continue;
        const int step = inwards * stride * (same ? 1 : 1 - block_width<Dim>);
        for (int n = 0; n < block_nodes<Dim>; ++n)
          if (n / stride % block_width<Dim> == layer) pairs_.push_back({axis, side, {b, n}, {other->second, n + step}});
      }
    }
}

template <int Dim>
void ThinFilms<Dim>::join(Scene<Dim>& scene) const {
  for (const Pair& pair : pairs_)
    for (int body = 0; body < scene.bodies(); ++body)
      if (scene.contact == nullptr ||
          (scene.contact->has(pair.wall.block, body) && scene.contact->has(pair.inner.block, body)))
        join(scene, pair, scene.nodes_of(body));
}

template <int Dim>
void ThinFilms<Dim>::join(const Scene<Dim>& scene, const Pair& pair, NodeFields<Dim>& nodes) const {
  const double wall = nodes.momentum(pair.wall.block)[pair.wall.number][0];
  const double inner = nodes.momentum(pair.inner.block)[pair.inner.number][0];
  if (!(wall > 0 && inner > 0) || inner > light * wall) return;
  const auto motion = [&](const Node& node) {
    return NodeMotion<Dim>{nodes.motion(node.block) + node.number * motion_lanes<Dim>};
  };
  const NodeMotion<Dim> at_wall = motion(pair.wall), inside = motion(pair.inner);
  for (int a = 0; a < Dim; ++a) at_wall.set(a, (wall * at_wall.v(a) + inner * inside.v(a)) / (wall + inner));
  scene.faces.fix_node(pair.axis, pair.side, at_wall);
  for (int a = 0; a < Dim; ++a) inside.set(a, at_wall.v(a));
}

template class ThinFilms<2>;
template class ThinFilms<3>;

}  // namespace sluice
