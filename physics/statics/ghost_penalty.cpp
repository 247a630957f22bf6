#include "physics/statics/ghost_penalty.h"

#include <map>
#include <vector>

namespace sluice {

namespace {

/// Nodes with less volume than this share of a cell are held.
constexpr double least_volume = 0.1;

struct NodeSums {
  double volume = 0;   // V N [m3]
  double modulus = 0;  // V N 2 G [N m]
};

template <int Dim>
using Nodes = std::map<Index<Dim>, NodeSums>;

template <int Dim>
Nodes<Dim> sum_up(const Scene<Dim>& scene, const Materials<Dim>& materials) {
  Nodes<Dim> nodes;
  const Particles& ps = scene.particles;
  for (std::size_t p = 0; p < ps.size(); ++p) {
    const Stencil<Dim> s = stencil_at(scene, p);
    const double volume = ps.columns.data(ps.volume)[p],
                 modulus = 2 * materials[static_cast<std::size_t>(ps.material[p])].elasticity().shear;
    for (int i = 0; i < s.count; ++i) {
      NodeSums& node = nodes[s.node[static_cast<std::size_t>(i)]];
      node.volume += volume * s.value[static_cast<std::size_t>(i)];
      node.modulus += volume * s.value[static_cast<std::size_t>(i)] * modulus;
    }
  }
  return nodes;
}

/// Whether the grid ends with this node, seen against `side`. B-splines at walls have a third or a sixth of a cell, and
/// no edge of a body is there.
template <int Dim>
bool at_end(const Scene<Dim>& scene, int axis, int side, const Index<Dim>& node) {
  const int last = scene.grid.cells[axis] + scene.shape->reach() - 1;
  return !scene.grid.periodic[axis] && node[axis] == (side > 0 ? 0 : last);
}

/// k d^2 / 2 for all components of three nodes in a row, with d = sum_i factor_i u_i.
template <int Dim>
void add_difference(const Unknowns<Dim>& unknowns, const std::array<Index<Dim>, 3>& nodes,
                    const std::array<double, 3>& factor, double stiffness,
                    std::vector<Eigen::Triplet<double>>& entries) {
  std::array<std::array<int, Dim>, 3> number;
  for (std::size_t i = 0; i < 3; ++i) number[i] = unknowns.find(nodes[i]);
  for (std::size_t a = 0; a < Dim; ++a)
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) {
        const int row = number[i][a], column = number[j][a];
        if (row >= 0 && column >= 0 && column <= row)
          entries.emplace_back(row, column, stiffness * factor[i] * factor[j]);
      }
}

/// Factors of the second difference (u_0 - u_1) - q (u_1 - u_2), which is zero for what is linear between nodes that
/// stand at uneven distances, as those of B-splines do at walls.
template <int Dim>
std::array<double, 3> difference(const Scene<Dim>& scene, int axis, const std::array<Index<Dim>, 3>& nodes) {
  std::array<double, 2> step;
  for (std::size_t i = 0; i < 2; ++i)
    step[i] = scene.grid.shortest(
        axis, scene.node_position(axis, nodes[i][axis]) - scene.node_position(axis, nodes[i + 1][axis]));
  const double q = step[0] / step[1];
  return {1, -1 - q, q};
}

}  // namespace

template <int Dim>
Eigen::SparseMatrix<double> ghost_penalty(const Scene<Dim>& scene, const Materials<Dim>& materials,
                                          const Unknowns<Dim>& unknowns, double strength) {
  Eigen::SparseMatrix<double> penalty(unknowns.count(), unknowns.count());
  if (strength == 0) return penalty;
  const Nodes<Dim> nodes = sum_up(scene, materials);
  const double cell = scene.grid.cell_volume();
  std::vector<Eigen::Triplet<double>> entries;
  for (const auto& [place, sums] : nodes) {
    if (!(sums.volume > 0 && sums.volume < least_volume * cell)) continue;
    for (int a = 0; a < Dim; ++a)
      for (const int side : {-1, 1}) {
        const auto inwards = [&, at = place](int steps) {
          Index<Dim> node = at;
          node[a] += side * steps;
          return scene.grid.wrapped(node);
        };
        if (at_end<Dim>(scene, a, side, place) || nodes.contains(inwards(-1)) || !nodes.contains(inwards(1)) ||
            !nodes.contains(inwards(2)))
          continue;
        const double h = scene.grid.cell[a], modulus = sums.modulus / sums.volume;
        const std::array<Index<Dim>, 3> row = {place, inwards(1), inwards(2)};
        add_difference<Dim>(unknowns, row, difference<Dim>(scene, a, row), strength * modulus * cell / (h * h),
                            entries);
      }
  }
  penalty.setFromTriplets(entries.begin(), entries.end());
  return penalty;
}

template Eigen::SparseMatrix<double> ghost_penalty<2>(const Scene<2>&, const Materials<2>&, const Unknowns<2>&, double);
template Eigen::SparseMatrix<double> ghost_penalty<3>(const Scene<3>&, const Materials<3>&, const Unknowns<3>&, double);

}  // namespace sluice
