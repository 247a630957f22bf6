/// The uniform background grid: its box, its cells, and how it is cut into blocks.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace sluice {

template <int Dim>
using Vector = std::array<double, Dim>;
template <int Dim>
using Index = std::array<int, Dim>;

inline constexpr int power(int base, int exponent) { return exponent == 0 ? 1 : base * power(base, exponent - 1); }

/// Cells (and nodes) per axis of a block.
template <int Dim>
inline constexpr int block_width = Dim == 2 ? 8 : 4;
/// Nodes of a block.
template <int Dim>
inline constexpr int block_nodes = power(block_width<Dim>, Dim);
/// A block and those around it.
template <int Dim>
inline constexpr int neighbourhood = power(3, Dim);
/// Cells beyond its block that a particle may wander into before the particles are sorted again.
inline constexpr int tile_margin = 1;

/// Nodes per axis of the tile of a block: all nodes that its particles can reach, for shape functions with this reach.
template <int Dim>
constexpr int tile_width(int reach) {
  return block_width<Dim> + 2 * tile_margin + reach;
}

/// The grid of a scene. Cells are half-open, [x_i, x_{i+1}). With shape functions of reach r an axis of n cells has
/// n + r nodes (control points); cell i reaches nodes i … i + r. A periodic axis has n nodes, as it has n vertices of
/// cells: number n is number 0 again. It is a whole number of blocks.
template <int Dim>
struct GridGeometry {
  Vector<Dim> min{}, max{}, cell{};
  Index<Dim> cells{};
  std::array<bool, Dim> periodic{};  ///< the axis begins anew beyond its last cell

  bool any_periodic() const { return std::find(periodic.begin(), periodic.end(), true) != periodic.end(); }
  /// The number that a cell, vertex or node beyond the ends of a periodic axis has inside.
  Index<Dim> wrapped(Index<Dim> place) const {
    for (int a = 0; a < Dim; ++a)
      if (periodic[a]) place[a] = (place[a] % cells[a] + cells[a]) % cells[a];
    return place;
  }
  /// A way along an axis, by the shortest of all turns where the axis is periodic [m].
  double shortest(int axis, double way) const {
    const auto a = static_cast<std::size_t>(axis);
    const double period = max[a] - min[a];
    return periodic[a] ? way - std::round(way / period) * period : way;
  }
  /// The grid as shape functions see it: a periodic axis goes on for a block beyond both of its ends, so that no wall
  /// is near, and a particle that has crossed an end since the last sort is where it is.
  GridGeometry unrolled() const {
    GridGeometry g = *this;
    for (int a = 0; a < Dim; ++a) {
      g.min[a] -= first_inside()[a] * cell[a];
      g.max[a] += first_inside()[a] * cell[a];
      g.cells[a] += 2 * first_inside()[a];
      g.periodic[a] = false;
    }
    return g;
  }
  /// The number that cell 0 has in the unrolled grid.
  Index<Dim> first_inside() const {
    Index<Dim> first{};
    for (int a = 0; a < Dim; ++a) first[a] = periodic[a] ? block_width<Dim> : 0;
    return first;
  }

  double smallest_cell() const {
    double h = cell[0];
    for (const double c : cell) h = std::min(h, c);
    return h;
  }
  double cell_volume() const {
    double v = 1;
    for (const double c : cell) v *= c;
    return v;
  }
  /// The corner of cells with these numbers, from 0 at `min`.
  Vector<Dim> vertex(const Index<Dim>& place) const {
    Vector<Dim> x;
    for (int a = 0; a < Dim; ++a) x[a] = min[a] + place[a] * cell[a];
    return x;
  }
  /// The cell that holds x; x outside the grid belongs to the nearest cell.
  Index<Dim> cell_of(const Vector<Dim>& x) const {
    Index<Dim> c;
    for (int a = 0; a < Dim; ++a) {
      const int i = static_cast<int>(std::floor((x[a] - min[a]) / cell[a]));
      c[a] = std::min(std::max(i, 0), cells[a] - 1);
    }
    return c;
  }
};

}  // namespace sluice
