/// Weights of a chunk of particles whose shape functions are products over the axes: where each particle is in its
/// cell, and values, slopes and distances of its nodes, axis by axis.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/parallel/multitarget.h"
#include "core/transfer/shape_kernels.h"

namespace sluice {

inline constexpr int chunk_size = 64;

namespace kernel {

/// Where a point is on an axis, in cells, for the shape functions: from the lower edge of the cell in which its lower
/// end is. A point without a size is its own lower end.
struct AxisPlace {
  double low;    ///< of its lower end, in [0, 1)
  double half;   ///< half of its size; 0 for shape functions that take particles as points
  double below;  ///< cells between this cell and the lower wall
  double above;  ///< and the upper wall
};

/// APIC's weights N_i (x_i - x) / sum_j N_j (x_j - x)^2, in 1/cells, from values and distances. Good to round-off where
/// the values are: near a wall numerator and sum go to zero together.
template <int Nodes>
SLUICE_ALWAYS_INLINE void moment_weights(const double* value, const double* distance, double* weight) {
  double sum = 0;
  for (int i = 0; i < Nodes; ++i) sum += value[i] * distance[i] * distance[i];
  const double inverse = 1 / sum;
  for (int i = 0; i < Nodes; ++i) weight[i] = value[i] * distance[i] * inverse;
}

/// Shape functions of a chunk of particles, by axis and node, and where in the tile each particle's first node is.
template <int Dim, class Shape>
struct ChunkWeights {
  static constexpr int nodes = Shape::nodes;
  alignas(64) double value[Dim][nodes][chunk_size];
  alignas(64) double slope[Dim][nodes][chunk_size];     ///< [1/m]
  alignas(64) double distance[Dim][nodes][chunk_size];  ///< x_i - x [m]
  alignas(64) double affine[Dim][nodes][chunk_size];    ///< [1/m]
  alignas(64) std::int32_t base[chunk_size];
};

template <int Dim, class Shape>
inline constexpr int tile_row = tile_width<Dim>(Shape::reach);

/// Distance in the tile between nodes that are neighbours along an axis.
template <int Dim, class Shape>
constexpr int tile_stride(int axis) {
  return power(tile_row<Dim, Shape>, axis);
}

/// The same for a particle of half size `half` [cells] at `s` cells from the lower wall. Close to a wall it shrinks so
/// as to end there: values then sum to one and reproduce linear fields up to the wall.
template <class Shape>
SLUICE_ALWAYS_INLINE AxisPlace place_of_sized(double s, double half, double last_cell, double* cell) {
  const double end = last_cell + 1, raised = s > Shape::hair ? s : Shape::hair;
  const double centre = raised < end - Shape::hair ? raised : end - Shape::hair;
  const double below = centre < half ? centre : half, size = end - centre < below ? end - centre : below;
  const double lowest = centre - size, floor = std::floor(lowest);
  *cell = floor < last_cell ? floor : last_cell;
  return {lowest - *cell, size, *cell, last_cell - *cell};
}

/// The shape functions of one axis. Written over plain pointers and without calls, or the compiler will not vectorize
/// it.
template <class Shape, bool Distances, bool AffineWeights, int Nodes = Shape::nodes>
SLUICE_ALWAYS_INLINE void weigh_axis(const double* __restrict x, const double* __restrict half, int count, double low,
                                     double h, double last_cell, double (*__restrict values)[chunk_size],
                                     double (*__restrict slopes)[chunk_size],
                                     double (*__restrict distances)[chunk_size],
                                     double (*__restrict affines)[chunk_size], double* __restrict cells) {
  const double inverse = 1 / h;
#pragma GCC ivdep
  for (int p = 0; p < count; ++p) {
    const double s = (x[p] - low) * inverse;
    double cell;
    AxisPlace at;
    if constexpr (Shape::sized) {
      at = place_of_sized<Shape>(s, half[p], last_cell, &cell);
    } else {
      const double floor = std::floor(s), positive = floor > 0 ? floor : 0;
      // A point on the upper face of the grid counts to the last cell.
      cell = positive < last_cell ? positive : last_cell;
      const double in_cell = s - cell;
      const double raised = in_cell > Shape::hair ? in_cell : Shape::hair;
      at = {raised < 1 - Shape::hair ? raised : 1 - Shape::hair, 0, cell, last_cell - cell};
    }
    double value[Nodes], slope[Nodes], distance[Nodes], weight[Nodes];
    Shape::evaluate(at, value, slope, distance);
    if constexpr (AffineWeights) Shape::affine(at, value, distance, weight);
    for (int i = 0; i < Nodes; ++i) {
      values[i][p] = value[i];
      slopes[i][p] = slope[i] * inverse;
      if constexpr (Distances) distances[i][p] = distance[i] * h;
      if constexpr (AffineWeights) affines[i][p] = weight[i] * inverse;
    }
    cells[p] = cell;
  }
}

template <int Dim, class Shape, bool Distances, bool AffineWeights>
SLUICE_ALWAYS_INLINE void weigh(const BlockParticles<Dim>& block, std::uint32_t begin, int count,
                                ChunkWeights<Dim, Shape>& w) {
  alignas(64) double cells[Dim][chunk_size];
  for (int a = 0; a < Dim; ++a)
    weigh_axis<Shape, Distances, AffineWeights>(
        block.position[a] + begin, Shape::sized ? block.domain[0] + begin : nullptr, count, block.grid->min[a],
        block.grid->cell[a], block.grid->cells[a] - 1, w.value[a], w.slope[a], w.distance[a], w.affine[a], cells[a]);
  int origin = 0;
  for (int a = 0; a < Dim; ++a)
    origin += (block.first_cell[a] - tile_margin - Shape::outside) * tile_stride<Dim, Shape>(a);
  for (int p = 0; p < count; ++p) {
    int base = -origin;
    for (int a = 0; a < Dim; ++a) base += static_cast<std::int32_t>(cells[a][p]) * tile_stride<Dim, Shape>(a);
    w.base[p] = base;
  }
}

}  // namespace kernel
}  // namespace sluice
