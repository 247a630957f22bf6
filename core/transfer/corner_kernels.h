/// Shape functions by the corners of particles (CPDI): a particle is a parallelogram, a quadrilateral or their kin in
/// space, and linear functions are taken at its corners. docs/theory.md, eqs. (13c) and (13d).
///
/// In the place of the weights of a chunk by axis and node stand those of the corners, each a point in a cell of its
/// own; the loops of kernels.h are the same. Included only by the files that define such a shape.
#pragma once

#include "core/transfer/shape_kernels_of.h"

namespace sluice {
namespace kernel {

/// Where the corners of one particle are, how much each counts in a mean over the particle, and in a mean gradient.
template <int Dim>
struct Corners {
  static constexpr int count = power(2, Dim);
  double offset[count][Dim];    ///< from the particle [m]
  double share[count];          ///< the sum is 1
  double gradient[count][Dim];  ///< [1/m]
};

/// How one particle moves in a step.
template <int Dim>
struct CornerMotion {
  double step[power(2, Dim)][Dim];  ///< of its corners, seen from the particle [m]
  double gradient[Dim][Dim];        ///< of the displacement
};

template <int Dim, class Shape>
struct CornerWeights {
  static constexpr int corners = power(2, Dim);
  alignas(64) double value[corners][Dim][chunk_size];     ///< of the upper node along the axis; the lower has the rest
  alignas(64) double distance[corners][Dim][chunk_size];  ///< from the particle to the lower node [m]
  alignas(64) double gradient[corners][Dim][chunk_size];  ///< [1/m]
  alignas(64) double share[corners][chunk_size];
  alignas(64) std::int32_t base[corners][chunk_size];
  alignas(64) double keep[chunk_size];  ///< size of the domain that is weighed with, over its own: see fit
  Vector<Dim> cell;
};

template <int Dim, class Shape>
requires(Shape::by_corners) struct WeightsOf<Dim, Shape> {
  using type = CornerWeights<Dim, Shape>;
};

/// Makes a domain fit, by drawing its corners towards the particle, all in the same proportion, which is returned: it
/// ends at the walls, and reaches no farther than one cell along any axis. The place of the particle in its middle and
/// the gradients of linear fields stay what they are, and no value is negative. `place` is that of the particle in
/// cells from the lower walls, in the grid.
template <int Dim>
SLUICE_ALWAYS_INLINE double fit(const GridGeometry<Dim>& grid, const double* place, Corners<Dim>& corner) {
  constexpr double least = 1e-4;
  double keep = 1;
  for (int a = 0; a < Dim; ++a) {
    const auto axis = static_cast<std::size_t>(a);
    const double above = grid.cells[axis] - place[a];
    const double room_below = grid.cell[axis] * std::min(1.0, std::max(place[a], least));
    const double room_above = grid.cell[axis] * std::min(1.0, std::max(above, least));
    for (int c = 0; c < corner.count; ++c) {
      const double offset = corner.offset[c][a], room = offset < 0 ? room_below : room_above;
      keep = std::abs(offset) * keep > room ? room / std::abs(offset) : keep;
    }
  }
  for (int c = 0; c < corner.count; ++c)
    for (int a = 0; a < Dim; ++a) {
      corner.offset[c][a] *= keep;
      corner.gradient[c][a] /= keep;
    }
  return keep;
}

/// The place of a particle along an axis, in cells from the lower wall; outside of the grid that of the wall.
SLUICE_ALWAYS_INLINE double place_within(double x, double low, double inverse, double cells) {
  const double s = (x - low) * inverse;
  return std::min(std::max(s, 0.0), cells);
}

/// The cell of a corner along an axis, which is that of the particle or one beside it, and the place there.
SLUICE_ALWAYS_INLINE void place_corner(double s, double particle, double last_cell, double* cell, double* t) {
  const double own = std::min(std::floor(particle), last_cell), low = std::max(own - 1, 0.0),
               high = std::min(own + 1, last_cell);
  *cell = std::min(std::max(std::floor(s), low), high);
  *t = s - *cell;
}

template <int Dim, class Shape, bool Distances, bool AffineWeights>
SLUICE_ALWAYS_INLINE void weigh(const BlockParticles<Dim>& block, std::uint32_t begin, int count,
                                CornerWeights<Dim, Shape>& w) {
  static_assert(!AffineWeights);
  constexpr int corners = power(2, Dim), numbers = Shape::template numbers<Dim>;
  const GridGeometry<Dim>& grid = *block.grid;
  w.cell = grid.cell;
  int origin = 0;
  for (int a = 0; a < Dim; ++a)
    origin +=
        (block.first_cell[static_cast<std::size_t>(a)] - tile_margin - Shape::outside) * tile_stride<Dim, Shape>(a);
  for (int k = 0; k < count; ++k) {
    const std::uint32_t p = begin + static_cast<std::uint32_t>(k);
    double number[numbers], s[Dim];
    for (int n = 0; n < numbers; ++n) number[n] = block.domain[static_cast<std::size_t>(n)][p];
    for (std::size_t a = 0; a < Dim; ++a)
      s[a] = place_within(block.position[a][p], grid.min[a], 1 / grid.cell[a], grid.cells[a]);
    Corners<Dim> corner;
    Shape::template corners<Dim>(number, corner);
    w.keep[k] = fit<Dim>(grid, s, corner);
    for (int c = 0; c < corners; ++c) {
      int base = -origin;
      w.share[c][k] = corner.share[c];
      for (int a = 0; a < Dim; ++a) {
        const auto axis = static_cast<std::size_t>(a);
        double cell, t;
        place_corner(s[a] + corner.offset[c][a] / grid.cell[axis], s[a], grid.cells[axis] - 1, &cell, &t);
        base += static_cast<std::int32_t>(cell) * tile_stride<Dim, Shape>(a);
        w.value[c][a][k] = t;
        w.distance[c][a][k] = (cell - s[a]) * grid.cell[axis];
        w.gradient[c][a][k] = corner.gradient[c][a];
      }
      w.base[c][k] = base;
    }
  }
}

/// Calls body(number of the node in the tile, value of the linear function, distance of the node from the particle) for
/// the nodes of corner c of particle p.
template <int Dim, class Shape, class Body>
SLUICE_ALWAYS_INLINE void for_nodes_of_corner(const CornerWeights<Dim, Shape>& w, int c, int p, const Body& body) {
  for (int n = 0; n < power(2, Dim); ++n) {
    double value = 1, distance[Dim];
    int place = w.base[c][p];
    for (int a = 0; a < Dim; ++a) {
      const int up = n >> a & 1;
      value *= up ? w.value[c][a][p] : 1 - w.value[c][a][p];
      distance[a] = w.distance[c][a][p] + (up ? w.cell[static_cast<std::size_t>(a)] : 0);
      place += up * tile_stride<Dim, Shape>(a);
    }
    body(place, value, distance);
  }
}

template <int Dim, class Shape, bool Affine, bool Flux>
SLUICE_ALWAYS_INLINE void add_to_nodes(const CornerWeights<Dim, Shape>& w, int p, Lane base, const Lane* slope,
                                       const Lane* flux, Lane* tile) {
  for (int c = 0; c < w.corners; ++c) {
    const double share = w.share[c][p];
    Lane sum = share * base;
    if constexpr (Flux)
      for (int b = 0; b < Dim; ++b) sum += w.gradient[c][b][p] * flux[b];
    for_nodes_of_corner<Dim, Shape>(w, c, p, [&](int node, double value, const double* distance) SLUICE_INLINE_LAMBDA {
      Lane own = sum;
      if constexpr (Affine)
        for (int b = 0; b < Dim; ++b) own += (share * distance[b]) * slope[b];
      tile[node] += value * own;
    });
  }
}

/// The velocity (and its change) at corner c of particle p.
template <int Dim, class Shape>
SLUICE_ALWAYS_INLINE void at_corner(const CornerWeights<Dim, Shape>& w, int c, int p, const Lane* motion_tile,
                                    Lane* sum) {
  constexpr int lanes = motion_lanes<Dim>;
  for (int l = 0; l < lanes; ++l) sum[l] = Lane{};
  for_nodes_of_corner<Dim, Shape>(w, c, p, [&](int node, double value, const double*) SLUICE_INLINE_LAMBDA {
    for (int l = 0; l < lanes; ++l) sum[l] += value * motion_tile[node * lanes + l];
  });
}

template <int Dim, class Shape, bool Value, bool Gradient, bool Affine>
SLUICE_ALWAYS_INLINE Gathered<Dim> sum_nodes(const CornerWeights<Dim, Shape>& w, int p, const Lane* motion_tile) {
  Gathered<Dim> sum{};
  for (int c = 0; c < w.corners; ++c) {
    Lane here[motion_lanes<Dim>];
    at_corner<Dim, Shape>(w, c, p, motion_tile, here);
    if constexpr (Value)
      for (int l = 0; l < motion_lanes<Dim>; ++l) sum.value[l] += w.share[c][p] * here[l];
    if constexpr (Gradient)
      for (int a = 0; a < Dim; ++a) sum.gradient[a] += w.gradient[c][a][p] * here[0];
  }
  return sum;
}

/// As for points: {0, s grad N} to every node of one particle.
template <int Dim, class Shape>
SLUICE_ALWAYS_INLINE void add_gradient(const CornerWeights<Dim, Shape>& w, int p, double s, Lane* tile) {
  Lane flux[Dim] = {};
  for (int a = 0; a < Dim; ++a) flux[a][1 + a] = s;
  add_to_nodes<Dim, Shape, false, true>(w, p, Lane{}, nullptr, flux, tile);
}

/// As for points: {dvx/dx, dvy/dy, dvx, dvy} of one particle in 2-D, and its kin in two lanes in 3-D.
template <int Dim, class Shape>
SLUICE_ALWAYS_INLINE void sum_divergence(const CornerWeights<Dim, Shape>& w, int p, const Lane* motion_tile,
                                         Lane* out) {
  const Gathered<Dim> g = sum_nodes<Dim, Shape, true, true, false>(w, p, motion_tile);
  for (int l = 0; l < motion_lanes<Dim>; ++l) out[l] = g.value[l];
  for (int a = 0; a < Dim; ++a) out[0][a] = g.gradient[a][a];
}

/// The domains of a chunk follow the motion; `begin` is the chunk's first particle. Positions have moved already.
template <int Dim, class Shape>
SLUICE_ALWAYS_INLINE void move_domains(const CornerWeights<Dim, Shape>& w, const ChunkGathered<Dim>& g,
                                       const BlockParticles<Dim>& block, std::uint32_t begin, int count,
                                       const Lane* motion_tile, const MotionUpdate<Dim>& update) {
  constexpr int numbers = Shape::template numbers<Dim>;
  for (int k = 0; k < count; ++k) {
    const std::uint32_t p = begin + static_cast<std::uint32_t>(k);
    CornerMotion<Dim> motion;
    double number[numbers], shift[Dim] = {};
    for (int n = 0; n < numbers; ++n) number[n] = block.domain[static_cast<std::size_t>(n)][p];
    for (int c = 0; c < w.corners; ++c) {
      Lane here[motion_lanes<Dim>];
      at_corner<Dim, Shape>(w, c, k, motion_tile, here);
      for (int a = 0; a < Dim; ++a) motion.step[c][a] = update.dt / w.keep[k] * (here[0][a] - g.value[0][k][a]);
    }
    for (int a = 0; a < Dim; ++a)
      for (int b = 0; b < Dim; ++b) motion.gradient[a][b] = update.dt * g.gradient[b][k][a];
    Shape::template follow<Dim>(motion, number, shift);
    for (int n = 0; n < numbers; ++n) update.domain[static_cast<std::size_t>(n)][p] = number[n];
    for (int a = 0; a < Dim; ++a) update.position[static_cast<std::size_t>(a)][p] += shift[a];
  }
}

/// Stencil of one particle; nodes that several corners reach are there once.
template <int Dim, class Shape>
Stencil<Dim> corner_stencil(const GridGeometry<Dim>& grid, const Vector<Dim>& x, std::span<const double> domain) {
  Corners<Dim> corner;
  double at[Dim];
  for (std::size_t a = 0; a < Dim; ++a) at[a] = place_within(x[a], grid.min[a], 1 / grid.cell[a], grid.cells[a]);
  Shape::template corners<Dim>(domain.data(), corner);
  fit<Dim>(grid, at, corner);
  Stencil<Dim> s;
  for (int c = 0; c < corner.count; ++c)
    for (int n = 0; n < corner.count; ++n) {
      Index<Dim> node;
      double value = 1;
      for (int a = 0; a < Dim; ++a) {
        const auto axis = static_cast<std::size_t>(a);
        double cell, t;
        place_corner(at[a] + corner.offset[c][a] / grid.cell[axis], at[a], grid.cells[axis] - 1, &cell, &t);
        const int up = n >> a & 1;
        node[axis] = static_cast<int>(cell) + up + Shape::outside;
        value *= up ? t : 1 - t;
      }
      if (std::abs(value) < 1e-15) continue;  // a corner on an edge of cells has but some of their nodes
      const auto place =
          static_cast<std::size_t>(std::find(s.node.begin(), s.node.begin() + s.count, node) - s.node.begin());
      if (place == static_cast<std::size_t>(s.count)) {
        ++s.count;
        s.node[place] = node;
        s.value[place] = 0;
        s.gradient[place] = {};
      }
      s.value[place] += corner.share[c] * value;
      for (int a = 0; a < Dim; ++a) s.gradient[place][static_cast<std::size_t>(a)] += corner.gradient[c][a] * value;
    }
  return s;
}

}  // namespace kernel

/// What shape functions by corners have in common. Such a shape is a struct with
///   numbers<Dim>                how many say what its domain is, components of vectors one after the other
///   fill(grid, share, numbers)  the domain of a particle that fills `share` of the width of its cell
///   corners(numbers, corners)   where its corners are, and their weights
///   follow(motion, numbers, shift)  moves it; `shift` corrects the place of the particle
struct CornerShape {
  static constexpr int nodes = 2, reach = 3, outside = 1;
  static constexpr bool smooth = true, sized = false, by_corners = true, moments_are_slopes = true;
  /// Value and gradient of a node go to zero together, linearly.
  static constexpr double hair = 0, negligible_weight = 1e-12;
  static double node_offset(int i, int) { return i - outside; }
};

}  // namespace sluice
