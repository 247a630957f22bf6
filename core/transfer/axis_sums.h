/// Sums between one particle and its nodes, for shape functions that are products over the axes: one vector operation a
/// node and field lane.
#pragma once

#include "core/transfer/axis_weights.h"

namespace sluice {
namespace kernel {

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

/// Weights of one node along one axis, for a lane of the motion: `slope` for component `axis`, `value` for the others.
SLUICE_ALWAYS_INLINE Lane divergence_weights(double value, double slope, int axis) {
  Lane w{value, value, value, value};
  w[axis] = slope;
  return w;
}

/// Adds {0, s grad N} to every node of one particle: the transpose of the divergence, and like it one product a node.
template <int Dim, class Shape>
SLUICE_ALWAYS_INLINE void add_gradient(const ChunkWeights<Dim, Shape>& w, int p, double s, Lane* tile) {
  constexpr int nodes = Shape::nodes;
  Lane* const origin = tile + w.base[p];
  Lane along_x[nodes];
  for (int i = 0; i < nodes; ++i) along_x[i] = divergence_weights(w.value[0][i][p], w.slope[0][i][p], 1);
  for (int k = 0; k < (Dim == 3 ? nodes : 1); ++k) {
    Lane plane{0, s, s, Dim == 3 ? s : 0};
    if constexpr (Dim == 3) plane *= divergence_weights(w.value[2][k][p], w.slope[2][k][p], 3);
    for (int j = 0; j < nodes; ++j) {
      const Lane row = plane * divergence_weights(w.value[1][j][p], w.slope[1][j][p], 2);
      Lane* const node = origin + j * tile_stride<Dim, Shape>(1) + k * tile_stride<Dim, Shape>(2);
      for (int i = 0; i < nodes; ++i) node[i] += along_x[i] * row;
    }
  }
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

}  // namespace kernel
}  // namespace sluice
