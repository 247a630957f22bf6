/// The transfer kernels, written once for every shape function and dimension.
///
/// Particles are taken in chunks. Within a chunk, what is the same for all particles (weights, updates) is done in
/// loops over particles that the compiler vectorizes; the sums over nodes are done particle by particle, with one
/// vector operation a node and field lane. Included only by the files that define a shape function.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>
#include <type_traits>

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

/// What the loops weigh with: ChunkWeights, or CornerWeights (corner_kernels.h).
template <int Dim, class Shape>
struct WeightsOf {
  using type = ChunkWeights<Dim, Shape>;
};

/// Of shapes by corners: corner_kernels.h.
template <int Dim, class Shape>
Stencil<Dim> corner_stencil(const GridGeometry<Dim>& grid, const Vector<Dim>& x, std::span<const double> domain);

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

/// sigma in the notation of `symmetric_components`, as the columns that grad N is multiplied with.
template <int Dim>
SLUICE_ALWAYS_INLINE void stress_columns(const std::array<const double*, symmetric_components<Dim>>& stress,
                                         double factor, std::uint32_t p, Lane* column) {
  if constexpr (Dim == 2) {
    const double xy = factor * stress[3][p];
    column[0] = Lane{0, factor * stress[0][p], xy, 0};
    column[1] = Lane{0, xy, factor * stress[1][p], 0};
  } else {
    const double xy = factor * stress[3][p], yz = factor * stress[4][p], xz = factor * stress[5][p];
    column[0] = Lane{0, factor * stress[0][p], xy, xz};
    column[1] = Lane{0, xy, factor * stress[1][p], yz};
    column[2] = Lane{0, xz, yz, factor * stress[2][p]};
  }
}

template <int Dim>
SLUICE_ALWAYS_INLINE Lane mass_and_momentum(double mass, const std::array<const double*, Dim>& velocity,
                                            std::uint32_t p) {
  if constexpr (Dim == 2)
    return Lane{mass, mass * velocity[0][p], mass * velocity[1][p], 0};
  else
    return Lane{mass, mass * velocity[0][p], mass * velocity[1][p], mass * velocity[2][p]};
}

/// Adds  N (base + sum_b (x_i - x)_b slope_b) + sum_b dN/dx_b flux_b  to every node of one particle.
/// `Affine` and `Flux` say which of the terms are there.
template <int Dim, class Shape, bool Affine, bool Flux>
SLUICE_ALWAYS_INLINE void add_to_nodes(const ChunkWeights<Dim, Shape>& w, int p, Lane base, const Lane* slope,
                                       const Lane* flux, Lane* tile) {
  constexpr int nodes = Shape::nodes;
  Lane* const origin = tile + w.base[p];
  for (int k = 0; k < (Dim == 3 ? nodes : 1); ++k) {
    Lane plane = base, plane_slope_x{}, plane_slope_y{}, plane_flux{}, plane_flux_x{}, plane_flux_y{};
    if constexpr (Affine) plane_slope_x = slope[0], plane_slope_y = slope[1];
    if constexpr (Flux) plane_flux_x = flux[0], plane_flux_y = flux[1];
    if constexpr (Dim == 3) {
      const double n = w.value[2][k][p];
      if constexpr (Affine) {
        plane = n * (plane + w.distance[2][k][p] * slope[2]);
        plane_slope_x *= n;
        plane_slope_y *= n;
      } else {
        plane *= n;
      }
      if constexpr (Flux) {
        plane_flux = w.slope[2][k][p] * flux[2];
        plane_flux_x *= n;
        plane_flux_y *= n;
      }
    }
    for (int j = 0; j < nodes; ++j) {
      const double n = w.value[1][j][p];
      Lane row = plane, row_slope{}, row_flux{};
      if constexpr (Affine) {
        row += w.distance[1][j][p] * plane_slope_y;
        row_slope = n * plane_slope_x;
      }
      row *= n;
      if constexpr (Flux) {
        row += w.slope[1][j][p] * plane_flux_y;
        if constexpr (Dim == 3) row += n * plane_flux;
        row_flux = n * plane_flux_x;
      }
      Lane* const node = origin + j * tile_stride<Dim, Shape>(1) + k * tile_stride<Dim, Shape>(2);
      for (int i = 0; i < nodes; ++i) {
        Lane sum = row;
        if constexpr (Affine) sum += w.distance[0][i][p] * row_slope;
        sum *= w.value[0][i][p];
        if constexpr (Flux) sum += w.slope[0][i][p] * row_flux;
        node[i] += sum;
      }
    }
  }
}

/// The same for momentum (to `tile`) and force (to `force_tile`) at once, in two dimensions: weights are read once.
template <class Shape, bool Affine>
SLUICE_ALWAYS_INLINE void add_both_to_nodes(const ChunkWeights<2, Shape>& w, int p, Lane base, const Lane* slope,
                                            Lane body, const Lane* flux, Lane* tile, Lane* force_tile) {
  constexpr int nodes = Shape::nodes;
  Lane* const origin = tile + w.base[p];
  Lane* const force_origin = force_tile + w.base[p];
  for (int j = 0; j < nodes; ++j) {
    const double n = w.value[1][j][p];
    Lane row = base, row_slope{};
    if constexpr (Affine) {
      row += w.distance[1][j][p] * slope[1];
      row_slope = n * slope[0];
    }
    row *= n;
    const Lane force_row = n * body + w.slope[1][j][p] * flux[1], row_flux = n * flux[0];
    Lane* const node = origin + j * tile_stride<2, Shape>(1);
    Lane* const force_node = force_origin + j * tile_stride<2, Shape>(1);
    for (int i = 0; i < nodes; ++i) {
      const double value = w.value[0][i][p];
      Lane sum = row;
      if constexpr (Affine) sum += w.distance[0][i][p] * row_slope;
      node[i] += value * sum;
      force_node[i] += value * force_row + w.slope[0][i][p] * row_flux;
    }
  }
}

template <int Dim>
SLUICE_ALWAYS_INLINE Lane body_force(const std::array<const double*, Dim>& force, std::uint32_t p) {
  if constexpr (Dim == 2)
    return Lane{0, force[0][p], force[1][p], 0};
  else
    return Lane{0, force[0][p], force[1][p], force[2][p]};
}

template <int Dim, class Shape, ScatterWhat What, bool Affine, bool Body = false>
SLUICE_MULTITARGET void scatter(const ScatterInput<Dim>& in, double impulse_dt, Lane* tile, Lane* force_tile) {
  constexpr bool momentum = What != ScatterWhat::force;
  constexpr bool impulse = What == ScatterWhat::momentum_and_impulse;
  constexpr bool force = What == ScatterWhat::force || What == ScatterWhat::momentum_and_force;
  constexpr std::size_t tile_bytes = sizeof(Lane) * power(tile_row<Dim, Shape>, Dim);
  if constexpr (momentum) std::memset(static_cast<void*>(tile), 0, tile_bytes);
  if constexpr (force) std::memset(static_cast<void*>(force_tile), 0, tile_bytes);

  typename WeightsOf<Dim, Shape>::type w;
  for (std::uint32_t begin = in.particles.begin; begin < in.particles.end; begin += chunk_size) {
    const int count = static_cast<int>(std::min<std::uint32_t>(chunk_size, in.particles.end - begin));
    weigh<Dim, Shape, Affine, false>(in.particles, begin, count, w);
    for (int k = 0; k < count; ++k) {
      const std::uint32_t p = begin + static_cast<std::uint32_t>(k);
      Lane flux[Dim] = {}, slope[Dim] = {};
      if constexpr (impulse || force)
        stress_columns<Dim>(in.stress, -in.volume[p] * (impulse ? impulse_dt : 1), p, flux);
      if constexpr (Affine) {
        const double m = in.mass[p];
        for (int b = 0; b < Dim; ++b) {
          slope[b] = Lane{0, m * in.affine[static_cast<std::size_t>(b)][p],
                          m * in.affine[static_cast<std::size_t>(Dim + b)][p], 0};
          if constexpr (Dim == 3) slope[b][3] = m * in.affine[static_cast<std::size_t>(2 * Dim + b)][p];
        }
      }
      if constexpr (Dim == 2 && momentum && force && std::is_same_v<decltype(w), ChunkWeights<Dim, Shape>>) {
        add_both_to_nodes<Shape, Affine>(w, k, mass_and_momentum<Dim>(in.mass[p], in.velocity, p), slope,
                                         Body ? body_force<Dim>(in.body_force, p) : Lane{}, flux, tile, force_tile);
        continue;
      }
      if constexpr (momentum)
        add_to_nodes<Dim, Shape, Affine, impulse>(w, k, mass_and_momentum<Dim>(in.mass[p], in.velocity, p), slope, flux,
                                                  tile);
      if constexpr (force) {
        Lane body{};
        if constexpr (Body) body = body_force<Dim>(in.body_force, p);
        add_to_nodes<Dim, Shape, false, true>(w, k, body, slope, flux, force_tile);
      }
    }
  }
}

/// Sums over the nodes of one particle, and their derivatives along the axes.
template <int Dim>
struct Gathered {
  Lane value[motion_lanes<Dim>];
  Lane gradient[Dim];  ///< of the velocity lane
  Lane affine[Dim];    ///< the same with APIC's weights
};

template <int Dim, class Shape, bool Value, bool Gradient, bool Affine>
SLUICE_ALWAYS_INLINE Gathered<Dim> sum_nodes(const ChunkWeights<Dim, Shape>& w, int p, const Lane* motion_tile) {
  constexpr int nodes = Shape::nodes, lanes = motion_lanes<Dim>;
  const Lane* const origin = motion_tile + w.base[p] * lanes;
  Gathered<Dim> sum{};
  for (int k = 0; k < (Dim == 3 ? nodes : 1); ++k) {
    Gathered<Dim> plane{};
    for (int j = 0; j < nodes; ++j) {
      Lane row[lanes] = {}, row_slope{}, row_affine{};
      const Lane* const node = origin + (j * tile_stride<Dim, Shape>(1) + k * tile_stride<Dim, Shape>(2)) * lanes;
      for (int i = 0; i < nodes; ++i) {
        for (int l = 0; l < (Value ? lanes : 1); ++l) row[l] += w.value[0][i][p] * node[i * lanes + l];
        if constexpr (Gradient) row_slope += w.slope[0][i][p] * node[i * lanes];
        if constexpr (Affine) row_affine += w.affine[0][i][p] * node[i * lanes];
      }
      for (int l = 0; l < (Value ? lanes : 1); ++l) plane.value[l] += w.value[1][j][p] * row[l];
      if constexpr (Gradient) {
        plane.gradient[0] += w.value[1][j][p] * row_slope;
        plane.gradient[1] += w.slope[1][j][p] * row[0];
      }
      if constexpr (Affine) {
        plane.affine[0] += w.value[1][j][p] * row_affine;
        plane.affine[1] += w.affine[1][j][p] * row[0];
      }
    }
    if constexpr (Dim == 2) {
      sum = plane;
    } else {
      const double n = w.value[2][k][p];
      for (int l = 0; l < (Value ? lanes : 1); ++l) sum.value[l] += n * plane.value[l];
      for (int a = 0; a < 2; ++a) {
        if constexpr (Gradient) sum.gradient[a] += n * plane.gradient[a];
        if constexpr (Affine) sum.affine[a] += n * plane.affine[a];
      }
      if constexpr (Gradient) sum.gradient[2] += w.slope[2][k][p] * plane.value[0];
      if constexpr (Affine) sum.affine[2] += w.affine[2][k][p] * plane.value[0];
    }
  }
  return sum;
}

/// What the particles of a chunk gathered: four doubles a particle and lane, to be read across particles.
template <int Dim>
struct ChunkGathered {
  alignas(64) Lane value[motion_lanes<Dim>][chunk_size];
  alignas(64) Lane gradient[Dim][chunk_size];
  alignas(64) Lane affine[Dim][chunk_size];

  static SLUICE_ALWAYS_INLINE const double* numbers(const Lane* lanes) {
    return reinterpret_cast<const double*>(lanes);
  }
};

template <int Dim, class Shape, bool Value, bool Gradient, bool Affine, class Weights>
SLUICE_ALWAYS_INLINE void sum_chunk(const Weights& w, int count, const Lane* motion_tile, ChunkGathered<Dim>& out) {
  for (int p = 0; p < count; ++p) {
    const Gathered<Dim> g = sum_nodes<Dim, Shape, Value, Gradient, Affine>(w, p, motion_tile);
    if constexpr (Value)
      for (int l = 0; l < motion_lanes<Dim>; ++l) out.value[l][p] = g.value[l];
    for (int a = 0; a < Dim; ++a) {
      if constexpr (Gradient) out.gradient[a][p] = g.gradient[a];
      if constexpr (Affine) out.affine[a][p] = g.affine[a];
    }
  }
}

/// Strain and rotation increments of a chunk from its velocity gradients; returns the largest absolute component.
template <int Dim>
SLUICE_ALWAYS_INLINE double write_strain(const ChunkGathered<Dim>& g, int count, double dt, std::uint32_t at,
                                         const StrainIncrements<Dim>& out) {
  const double* __restrict gx = g.numbers(g.gradient[0]);
  const double* __restrict gy = g.numbers(g.gradient[1]);
  double* __restrict e[symmetric_components<Dim>];
  double* __restrict r[spin_components<Dim>];
  for (int c = 0; c < symmetric_components<Dim>; ++c) e[c] = out.strain[static_cast<std::size_t>(c)] + at;
  for (int c = 0; c < spin_components<Dim>; ++c) r[c] = out.rotation[static_cast<std::size_t>(c)] + at;
  const double half = 0.5 * dt;
  double largest = 0;
  if constexpr (Dim == 2) {
#pragma omp simd reduction(max : largest)
    for (int p = 0; p < count; ++p) {
      const double xx = dt * gx[4 * p], yy = dt * gy[4 * p + 1];
      const double xy = half * (gy[4 * p] + gx[4 * p + 1]), spin = half * (gx[4 * p + 1] - gy[4 * p]);
      e[0][p] = xx;
      e[1][p] = yy;
      e[2][p] = 0;
      e[3][p] = xy;
      r[0][p] = spin;
      const double axial = std::max(std::abs(xx), std::abs(yy)), angular = std::max(std::abs(xy), std::abs(spin));
      largest = std::max(largest, std::max(axial, angular));
    }
  } else {
    const double* __restrict gz = g.numbers(g.gradient[2]);
#pragma omp simd reduction(max : largest)
    for (int p = 0; p < count; ++p) {
      const double xx = dt * gx[4 * p], yy = dt * gy[4 * p + 1], zz = dt * gz[4 * p + 2];
      const double xy = half * (gy[4 * p] + gx[4 * p + 1]), yz = half * (gz[4 * p + 1] + gy[4 * p + 2]),
                   xz = half * (gz[4 * p] + gx[4 * p + 2]);
      e[0][p] = xx;
      e[1][p] = yy;
      e[2][p] = zz;
      e[3][p] = xy;
      e[4][p] = yz;
      e[5][p] = xz;
      // w_ab = (dv_a/dx_b - dv_b/dx_a) / 2; in 2-D the sign is that of a counter-clockwise turn, w_yx
      r[0][p] = half * (gy[4 * p] - gx[4 * p + 1]);
      r[1][p] = half * (gz[4 * p + 1] - gy[4 * p + 2]);
      r[2][p] = half * (gz[4 * p] - gx[4 * p + 2]);
      const double axial = std::max(std::max(std::abs(xx), std::abs(yy)), std::abs(zz));
      const double shear = std::max(std::max(std::abs(xy), std::abs(yz)), std::abs(xz));
      const double spin = std::max(std::max(std::abs(r[0][p]), std::abs(r[1][p])), std::abs(r[2][p]));
      largest = std::max(largest, std::max(axial, std::max(shear, spin)));
    }
  }
  return largest;
}

template <int Dim, class Shape>
SLUICE_MULTITARGET double gather_strain(const BlockParticles<Dim>& block, const Lane* motion_tile, double dt,
                                        const StrainIncrements<Dim>& out) {
  typename WeightsOf<Dim, Shape>::type w;
  ChunkGathered<Dim> g;
  double largest = 0;
  for (std::uint32_t begin = block.begin; begin < block.end; begin += chunk_size) {
    const int count = static_cast<int>(std::min<std::uint32_t>(chunk_size, block.end - begin));
    weigh<Dim, Shape, false, false>(block, begin, count, w);
    sum_chunk<Dim, Shape, false, true, false>(w, count, motion_tile, g);
    largest = std::max(largest, write_strain<Dim>(g, count, dt, begin - block.begin, out));
  }
  return largest;
}

/// How the affine field of particles is gathered: not at all, as APIC's or as the gradient of the velocity (TPIC).
enum class AffineField { none, moment, gradient };

/// Velocity, position and affine field of a chunk; `begin` is the chunk's first particle.
template <int Dim, bool Affine>
SLUICE_ALWAYS_INLINE void move(const ChunkGathered<Dim>& g, const BlockParticles<Dim>& block, std::uint32_t begin,
                               int count, const MotionUpdate<Dim>& update, MotionReport& report) {
  const VelocityShares share = update.shares;
  const double dt = update.dt;
  alignas(64) double speed_squared[chunk_size] = {};
  double travel = 0;
  int outside = 0;
  for (int a = 0; a < Dim; ++a) {
    const double* __restrict nodes = g.numbers(g.value[0]) + a;
    const double* __restrict change =
        Dim == 2 ? g.numbers(g.value[0]) + 2 + a : g.numbers(g.value[motion_lanes<Dim> - 1]) + a;
    double* __restrict v = update.velocity[static_cast<std::size_t>(a)] + begin;
    const double* x = block.position[static_cast<std::size_t>(a)] + begin;
    double* x_new = update.position[static_cast<std::size_t>(a)] + begin;  // may be x itself
    const double low = block.grid->min[static_cast<std::size_t>(a)],
                 high = block.grid->max[static_cast<std::size_t>(a)];
    const double cells_per_metre = 1 / block.grid->cell[static_cast<std::size_t>(a)];
#pragma omp simd reduction(max : travel) reduction(+ : outside)
    for (int p = 0; p < count; ++p) {
      const double velocity =
          Affine ? nodes[4 * p] : share.old * v[p] + share.change * change[4 * p] + share.nodes * nodes[4 * p];
      const double step = dt * nodes[4 * p];
      const double x_moved = x[p] + step;
      v[p] = velocity;
      x_new[p] = x_moved;
      speed_squared[p] += velocity * velocity;
      travel = std::max(travel, std::abs(step) * cells_per_metre);
      outside += (x_moved >= low && x_moved < high) ? 0 : 1;
    }
    if constexpr (Affine)
      for (int b = 0; b < Dim; ++b) {
        const double* __restrict c = g.numbers(g.affine[b]) + a;
        double* __restrict out = update.affine[static_cast<std::size_t>(a * Dim + b)] + begin;
#pragma omp simd
        for (int p = 0; p < count; ++p) out[p] = c[4 * p];
      }
  }
  double fastest = 0;
  int bad = 0;
#pragma omp simd reduction(max : fastest) reduction(+ : bad)
  for (int p = 0; p < count; ++p) {
    bad += speed_squared[p] < 1e300 ? 0 : 1;  // false for NaN, too
    fastest = std::max(fastest, speed_squared[p]);
  }
  report.largest_speed_squared = std::max(report.largest_speed_squared, fastest);
  report.largest_travel = std::max(report.largest_travel, travel);
  report.finite = report.finite && bad == 0;
  report.inside = report.inside && outside == 0;
}

template <int Dim, class Shape, AffineField Field, bool Strain>
SLUICE_MULTITARGET MotionReport gather_motion(const BlockParticles<Dim>& block, const Lane* motion_tile,
                                              const MotionUpdate<Dim>& update) {
  constexpr bool affine_is_gradient = Field == AffineField::gradient, own_affine = Field == AffineField::moment;
  typename WeightsOf<Dim, Shape>::type w;
  ChunkGathered<Dim> g;
  MotionReport report;
  double largest_strain = 0;
  for (std::uint32_t begin = block.begin; begin < block.end; begin += chunk_size) {
    const int count = static_cast<int>(std::min<std::uint32_t>(chunk_size, block.end - begin));
    weigh<Dim, Shape, false, own_affine>(block, begin, count, w);
    sum_chunk<Dim, Shape, true, Strain || affine_is_gradient || Shape::by_corners, own_affine>(w, count, motion_tile,
                                                                                               g);
    if constexpr (affine_is_gradient)
      for (int a = 0; a < Dim; ++a) std::copy_n(g.gradient[a], count, g.affine[a]);
    if constexpr (Strain)
      largest_strain =
          std::max(largest_strain, write_strain<Dim>(g, count, update.dt, begin - block.begin, *update.strain));
    move<Dim, Field != AffineField::none>(g, block, begin, count, update, report);
    if constexpr (Shape::by_corners)
      if (update.domain[0] != nullptr) move_domains<Dim, Shape>(w, g, block, begin, count, motion_tile, update);
  }
  if constexpr (Strain) report.largest_strain_rate = largest_strain / update.dt;
  return report;
}

/// The velocities of the nodes to the particles and back: {m, m v}. What is lost on the way is what one mapping
/// smooths.
template <int Dim, class Shape>
SLUICE_MULTITARGET void map_again(const BlockParticles<Dim>& block, const double* mass, const Lane* motion_tile,
                                  Lane* tile) {
  std::memset(static_cast<void*>(tile), 0, sizeof(Lane) * power(tile_row<Dim, Shape>, Dim));
  typename WeightsOf<Dim, Shape>::type w;
  for (std::uint32_t begin = block.begin; begin < block.end; begin += chunk_size) {
    const int count = static_cast<int>(std::min<std::uint32_t>(chunk_size, block.end - begin));
    weigh<Dim, Shape, false, false>(block, begin, count, w);
    for (int k = 0; k < count; ++k) {
      const double m = mass[begin + static_cast<std::uint32_t>(k)];
      const Lane v = sum_nodes<Dim, Shape, true, false, false>(w, k, motion_tile).value[0];
      const Lane base = {m, m * v[0], m * v[1], Dim == 3 ? m * v[2] : 0};
      add_to_nodes<Dim, Shape, false, false>(w, k, base, nullptr, nullptr, tile);
    }
  }
}

/// Writes component `component` of every lane of a chunk to a column.
SLUICE_ALWAYS_INLINE void write_component(const Lane* lanes, int component, int count, double* __restrict column) {
  const double* __restrict from = reinterpret_cast<const double*>(lanes) + component;
#pragma omp simd
  for (int p = 0; p < count; ++p) column[p] = from[4 * p];
}

template <int Dim, class Shape>
SLUICE_MULTITARGET void gather_field(const BlockParticles<Dim>& block, const Lane* tile, const FieldGather<Dim>& out) {
  typename WeightsOf<Dim, Shape>::type w;
  ChunkGathered<Dim> g;
  for (std::uint32_t begin = block.begin; begin < block.end; begin += chunk_size) {
    const int count = static_cast<int>(std::min<std::uint32_t>(chunk_size, block.end - begin));
    weigh<Dim, Shape, false, false>(block, begin, count, w);
    sum_chunk<Dim, Shape, true, true, false>(w, count, tile, g);
    write_component(g.value[0], 0, count, out.value + begin);
    for (int a = 0; a < Dim; ++a) write_component(g.gradient[a], 0, count, out.gradient[a] + begin);
  }
}

/// Weights of one node along one axis, for a lane of the motion: `slope` for component `axis`, `value` for the others.
SLUICE_ALWAYS_INLINE Lane divergence_weights(double value, double slope, int axis) {
  Lane w{value, value, value, value};
  w[axis] = slope;
  return w;
}

/// {dvx/dx, dvy/dy, dvx, dvy} of one particle in 2-D, {dvx/dx, dvy/dy, dvz/dz, 0} and {dvx, dvy, dvz, 0} in 3-D: one
/// product a node and lane, because each component has slopes along its own axis only.
template <int Dim, class Shape>
SLUICE_ALWAYS_INLINE void sum_divergence(const ChunkWeights<Dim, Shape>& w, int p, const Lane* motion_tile, Lane* out) {
  constexpr int nodes = Shape::nodes, lanes = motion_lanes<Dim>;
  const Lane* const origin = motion_tile + w.base[p] * lanes;
  Lane along_x[nodes], along_y[nodes], along_z[Dim == 3 ? nodes : 1];
  for (int i = 0; i < nodes; ++i) {
    along_x[i] = divergence_weights(w.value[0][i][p], w.slope[0][i][p], 0);
    along_y[i] = divergence_weights(w.value[1][i][p], w.slope[1][i][p], 1);
    if constexpr (Dim == 3) along_z[i] = divergence_weights(w.value[2][i][p], w.slope[2][i][p], 2);
  }
  Lane sum[lanes] = {};
  for (int k = 0; k < (Dim == 3 ? nodes : 1); ++k) {
    Lane plane[lanes] = {};
    for (int j = 0; j < nodes; ++j) {
      Lane row[lanes] = {};
      const Lane* const node = origin + (j * tile_stride<Dim, Shape>(1) + k * tile_stride<Dim, Shape>(2)) * lanes;
      for (int i = 0; i < nodes; ++i) {
        row[0] += along_x[i] * node[i * lanes];
        if constexpr (Dim == 3) row[1] += w.value[0][i][p] * node[i * lanes + 1];
      }
      plane[0] += along_y[j] * row[0];
      if constexpr (Dim == 3) plane[1] += w.value[1][j][p] * row[1];
    }
    if constexpr (Dim == 3) {
      sum[0] += along_z[k] * plane[0];
      sum[1] += w.value[2][k][p] * plane[1];
    } else {
      sum[0] = plane[0];
    }
  }
  for (int l = 0; l < lanes; ++l) out[l] = sum[l];
}

template <int Dim, class Shape>
SLUICE_MULTITARGET void gather_divergence(const BlockParticles<Dim>& block, const Lane* motion_tile, double* divergence,
                                          const std::array<double*, Dim>& change) {
  constexpr int lanes = motion_lanes<Dim>, numbers = lanes * lane_width;
  typename WeightsOf<Dim, Shape>::type w;
  alignas(64) Lane sums[chunk_size * lanes];
  const double* __restrict sum = reinterpret_cast<const double*>(sums);
  for (std::uint32_t begin = block.begin; begin < block.end; begin += chunk_size) {
    const int count = static_cast<int>(std::min<std::uint32_t>(chunk_size, block.end - begin));
    weigh<Dim, Shape, false, false>(block, begin, count, w);
    for (int p = 0; p < count; ++p) sum_divergence<Dim, Shape>(w, p, motion_tile, sums + p * lanes);
    double* __restrict out = divergence + begin;
#pragma omp simd
    for (int p = 0; p < count; ++p) {
      const double* s = sum + numbers * p;
      out[p] = Dim == 2 ? s[0] + s[1] : s[0] + s[1] + s[2];
    }
    for (int a = 0; a < Dim; ++a) {
      double* __restrict component = change[a] + begin;
#pragma omp simd
      for (int p = 0; p < count; ++p) component[p] = sum[numbers * p + (Dim == 2 ? 2 : lane_width) + a];
    }
  }
}

}  // namespace kernel

/// What shape functions have in common that take particles as points. A shape is a struct of static members for one
/// axis; several axes are products:
///   nodes, reach, outside  nodes that a particle takes; ShapeKernels::reach and outside
///   smooth, hair, negligible_weight  see ShapeKernels and linear.cpp
///   evaluate(place, value, slope, distance)  N, dN/dx [1/cells], and the distances x_i - x of the nodes [cells]
///   affine(place, value, distance, weight)   APIC's weights [1/cells]; moment_weights does, if nothing is shorter
///   node_offset(i, n)  place of node i on an axis of n cells, in cells from the lower wall
struct PointShape {
  static constexpr bool by_corners = false;          ///< see corner_kernels.h
  static constexpr bool sized = false;               ///< particles have a size, the first number of their domain
  static constexpr bool moments_are_slopes = false;  ///< APIC's affine field is the gradient
  static ColumnSpec domain(int) { return {"domain", "1", 0, Role::state, ""}; }
};

/// The kernels of one shape function; see ShapeKernels.
template <int Dim, class Shape>
class ShapeKernelsOf final : public ShapeKernels<Dim> {
 public:
  int reach() const override { return Shape::reach; }
  int outside() const override { return Shape::outside; }
  bool smooth() const override { return Shape::smooth; }
  double negligible_weight() const override { return Shape::negligible_weight; }

  double node_position(const GridGeometry<Dim>& grid, int axis, int i) const override {
    const auto a = static_cast<std::size_t>(axis);
    return grid.min[a] + grid.cell[a] * Shape::node_offset(i, grid.cells[a]);
  }

  ColumnSpec domain() const override { return Shape::domain(Dim); }
  bool takes_moments() const override { return !Shape::by_corners; }
  void fill_domain(const GridGeometry<Dim>& grid, double share, std::span<double> numbers) const override {
    if constexpr (Shape::sized) numbers[0] = 0.5 * share;
    if constexpr (Shape::by_corners) Shape::template fill<Dim>(grid, share, numbers.data());
  }

  Stencil<Dim> stencil(const GridGeometry<Dim>& grid, const Vector<Dim>& x,
                       std::span<const double> domain) const override {
    if constexpr (Shape::by_corners)
      return kernel::corner_stencil<Dim, Shape>(grid, x, domain);
    else
      return axis_stencil(grid, x, domain);
  }

  static Stencil<Dim> axis_stencil(const GridGeometry<Dim>& grid, const Vector<Dim>& x,
                                   std::span<const double> domain) {
    constexpr int nodes = Shape::nodes;
    double value[Dim][nodes], slope[Dim][nodes], distance[nodes];
    Index<Dim> cell = grid.cell_of(x);
    for (int a = 0; a < Dim; ++a) {
      const double s = (x[a] - grid.min[a]) / grid.cell[a], last_cell = grid.cells[a] - 1;
      kernel::AxisPlace at{s - cell[a], 0, static_cast<double>(cell[a]), last_cell - cell[a]};
      if constexpr (Shape::sized) {
        double first;
        at = kernel::place_of_sized<Shape>(s, domain[0], last_cell, &first);
        cell[a] = static_cast<int>(first);
      }
      Shape::evaluate(at, value[a], slope[a], distance);
    }
    Stencil<Dim> s;
    for (int n = 0; n < power(nodes, Dim); ++n) {
      const auto place = static_cast<std::size_t>(s.count++);
      Index<Dim> i;
      for (int a = 0, rest = n; a < Dim; ++a, rest /= nodes) i[a] = rest % nodes;
      s.value[place] = 1;
      for (int a = 0; a < Dim; ++a) {
        s.node[place][a] = cell[a] + Shape::outside + i[a];
        s.value[place] *= value[a][i[a]];
        s.gradient[place][a] = slope[a][i[a]] / grid.cell[a];
        for (int b = 0; b < Dim; ++b)
          if (b != a) s.gradient[place][a] *= value[b][i[b]];
      }
      if (Shape::sized && s.value[place] == 0) --s.count;  // beyond the end of the particle
    }
    return s;
  }

  void scatter(ScatterWhat what, const ScatterInput<Dim>& in, double dt, Lane* tile, Lane* force_tile) const override {
    const bool affine = in.affine[0] != nullptr;
    using enum ScatterWhat;
    if (what == momentum)
      affine ? kernel::scatter<Dim, Shape, momentum, true>(in, dt, tile, force_tile)
             : kernel::scatter<Dim, Shape, momentum, false>(in, dt, tile, force_tile);
    else if (what == force)
      in.body_force[0] != nullptr ? kernel::scatter<Dim, Shape, force, false, true>(in, dt, tile, force_tile)
                                  : kernel::scatter<Dim, Shape, force, false>(in, dt, tile, force_tile);
    else if (what == momentum_and_force)
      affine ? kernel::scatter<Dim, Shape, momentum_and_force, true>(in, dt, tile, force_tile)
             : kernel::scatter<Dim, Shape, momentum_and_force, false>(in, dt, tile, force_tile);
    else
      affine ? kernel::scatter<Dim, Shape, momentum_and_impulse, true>(in, dt, tile, force_tile)
             : kernel::scatter<Dim, Shape, momentum_and_impulse, false>(in, dt, tile, force_tile);
  }

  double gather_strain(const BlockParticles<Dim>& particles, const Lane* motion_tile, double dt,
                       const StrainIncrements<Dim>& out) const override {
    return kernel::gather_strain<Dim, Shape>(particles, motion_tile, dt, out);
  }

  void gather_field(const BlockParticles<Dim>& particles, const Lane* tile,
                    const FieldGather<Dim>& out) const override {
    kernel::gather_field<Dim, Shape>(particles, tile, out);
  }

  void gather_divergence(const BlockParticles<Dim>& particles, const Lane* motion_tile, double* divergence,
                         const std::array<double*, Dim>& change) const override {
    kernel::gather_divergence<Dim, Shape>(particles, motion_tile, divergence, change);
  }

  void map_again(const BlockParticles<Dim>& particles, const double* mass, const Lane* motion_tile,
                 Lane* tile) const override {
    kernel::map_again<Dim, Shape>(particles, mass, motion_tile, tile);
  }

  MotionReport gather_motion(const BlockParticles<Dim>& particles, const Lane* motion_tile,
                             const MotionUpdate<Dim>& update) const override {
    using enum kernel::AffineField;
    if (update.affine[0] == nullptr) return gather_motion_with<none>(particles, motion_tile, update);
    if (update.affine_is_gradient || Shape::moments_are_slopes)
      return gather_motion_with<gradient>(particles, motion_tile, update);
    if constexpr (!Shape::moments_are_slopes) return gather_motion_with<moment>(particles, motion_tile, update);
  }

 private:
  template <kernel::AffineField Field>
  static MotionReport gather_motion_with(const BlockParticles<Dim>& particles, const Lane* motion_tile,
                                         const MotionUpdate<Dim>& update) {
    return update.strain != nullptr ? kernel::gather_motion<Dim, Shape, Field, true>(particles, motion_tile, update)
                                    : kernel::gather_motion<Dim, Shape, Field, false>(particles, motion_tile, update);
  }
};

/// Registers `Shape` under `name`, for 2-D and 3-D. `Shape` must have external linkage: the linker chooses among the
/// clones of its kernels.
#define SLUICE_REGISTER_SHAPE(tag, Shape, name, summary)                                   \
  const bool tag##_registered = shape_registry<2>().add(name, {summary, {}}, [] {          \
    return std::unique_ptr<ShapeKernels<2>>(std::make_unique<ShapeKernelsOf<2, Shape>>()); \
  }) && shape_registry<3>().add(name, {summary, {}}, [] {                                  \
    return std::unique_ptr<ShapeKernels<3>>(std::make_unique<ShapeKernelsOf<3, Shape>>()); \
  });

}  // namespace sluice
