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

/// k (u_0 - 2 u_1 + u_2)^2 / 2 for all components of three nodes in a row.
template <int Dim>
void add_difference(const Unknowns<Dim>& unknowns, const std::array<Index<Dim>, 3>& nodes, double stiffness,
                    std::vector<Eigen::Triplet<double>>& entries) {
  constexpr std::array<double, 3> factor = {1, -2, 1};
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

}  // namespace

template <int Dim>
Eigen::SparseMatrix<double> ghost_penalty(const Scene<Dim>& scene, const Materials<Dim>& materials,
                                          const Unknowns<Dim>& unknowns, double strength) {
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
        if (nodes.contains(inwards(-1)) || !nodes.contains(inwards(1)) || !nodes.contains(inwards(2))) continue;
        const double h = scene.grid.cell[a], modulus = sums.modulus / sums.volume;
        add_difference<Dim>(unknowns, {place, inwards(1), inwards(2)}, strength * modulus * cell / (h * h), entries);
      }
  }
  Eigen::SparseMatrix<double> penalty(unknowns.count(), unknowns.count());
  penalty.setFromTriplets(entries.begin(), entries.end());
  return penalty;
}

template Eigen::SparseMatrix<double> ghost_penalty<2>(const Scene<2>&, const Materials<2>&, const Unknowns<2>&, double);
template Eigen::SparseMatrix<double> ghost_penalty<3>(const Scene<3>&, const Materials<3>&, const Unknowns<3>&, double);

}  // namespace sluice
