/// What a static problem on the grid needs, with the particles as its quadrature points: numbers of the unknowns,
/// particles in order of their cells, stencils.
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <string>
#include <unordered_map>
#include <vector>

#include "core/simulation/scene.h"

namespace sluice {

/// Which components of nodes are no unknowns.
enum class Fixed {
  held,  ///< those that faces and obstacles hold, friction included
  none
};

/// Degrees of freedom: the components of the nodes that particles reach, from `first` on, less those that are fixed.
template <int Dim>
class Unknowns {
 public:
  explicit Unknowns(const Scene<Dim>& scene, int first = 0) : scene_(scene), first_(first) {}
  Unknowns(const Scene<Dim>& scene, Fixed what) : scene_(scene), what_(what) {}

  /// The unknown of a node's component, or -1 if it is fixed. Numbers are given in order of first asking.
  std::array<int, Dim> of(const Index<Dim>& node) {
    const auto [place, fresh] = numbers_.try_emplace(key_of(node));
    if (fresh) nodes_.push_back(node);
    if (fresh)
      for (int a = 0; a < Dim; ++a)
        place->second[static_cast<std::size_t>(a)] = fixed(node, a) || a < first_ ? -1 : count_++;
    return place->second;
  }
  /// The same for a node that may not have been asked for: -1 then.
  std::array<int, Dim> find(const Index<Dim>& node) const {
    const auto place = numbers_.find(key_of(node));
    if (place != numbers_.end()) return place->second;
    std::array<int, Dim> none;
    none.fill(-1);
    return none;
  }
  int count() const { return count_; }
  /// In order of first asking: with Fixed::none the components of number k are the unknowns k Dim … k Dim + Dim - 1.
  const std::vector<Index<Dim>>& nodes() const { return nodes_; }

 private:
  static std::int64_t key_of(const Index<Dim>& node) {
    std::int64_t key = 0;
    for (int a = Dim - 1; a >= 0; --a) key = key * (std::int64_t{1} << 20) + node[a];
    return key;
  }
  bool fixed(const Index<Dim>& node, int component) const {
    if (what_ == Fixed::none) return false;
    for (int axis = 0; axis < Dim; ++axis)
      for (int side = 0; side < 2; ++side) {
        const FaceCase& face = scene_.faces.face(axis, side);
        const bool free = face.normal == FaceCase::Normal::free && !face.absorbing;
        if (node[axis] != scene_.faces.wall_node(axis, side) || free) continue;
        if (component == axis || face.tangential != FaceCase::Tangential::free) return true;
      }
    return scene_.obstacles.any() && scene_.obstacles.holds(node, component);
  }

  const Scene<Dim>& scene_;
  int first_ = 0;
  Fixed what_ = Fixed::held;
  std::vector<Index<Dim>> nodes_;
  std::unordered_map<std::int64_t, std::array<int, Dim>> numbers_;
  int count_ = 0;
};

/// Particles in order of their cells: those of a cell share their nodes, so their stiffness is summed
/// densely first.
template <int Dim>
std::vector<std::uint32_t> by_cell(const Scene<Dim>& scene, std::vector<std::int64_t>& cell) {
  const Particles& ps = scene.particles;
  cell.resize(ps.size());
  for (std::size_t p = 0; p < ps.size(); ++p) {
    Vector<Dim> x;
    for (int a = 0; a < Dim; ++a) x[a] = ps.columns.data(ps.position, a)[p];
    const Index<Dim> c = scene.grid.cell_of(x);
    cell[p] = 0;
    for (int a = Dim - 1; a >= 0; --a) cell[p] = cell[p] * scene.grid.cells[a] + c[a];
  }
  std::vector<std::uint32_t> order(ps.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t p, std::uint32_t q) { return cell[p] < cell[q]; });
  return order;
}

template <int Dim>
Stencil<Dim> stencil_at(const Scene<Dim>& scene, std::size_t p) {
  Vector<Dim> x;
  for (int a = 0; a < Dim; ++a) x[a] = scene.particles.columns.data(scene.particles.position, a)[p];
  std::array<double, domain_capacity<Dim>> domain{};
  const auto components = static_cast<std::size_t>(scene.domain_components());
  for (std::size_t c = 0; c < components; ++c)
    domain[c] = scene.particles.columns.data(scene.domain, static_cast<int>(c))[p];
  return scene.stencil(x, {domain.data(), components});
}

/// "(3.5, 2) m": where the node of an unknown is.
template <int Dim>
std::string place_of(const Scene<Dim>& scene, const Unknowns<Dim>& unknowns, int unknown) {
  std::vector<std::string> place;
  for (const auto& block : scene.blocks.node_blocks())
    for (int n = 0; n < block_nodes<Dim>; ++n) {
      const Index<Dim> node = block.node(n);
      const auto own = unknowns.find(node);
      if (std::find(own.begin(), own.end(), unknown) == own.end()) continue;
      for (int a = 0; a < Dim; ++a) place.push_back(fmt::format("{:.4g}", scene.node_position(a, node[a])));
      return fmt::format("({}) m", fmt::join(place, ", "));
    }
  return "nowhere";
}

}  // namespace sluice
