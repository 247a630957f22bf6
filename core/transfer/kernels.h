/// The transfer kernels: scatter and gather, written once for every shape function and dimension.
///
/// Particles are taken in chunks. Within a chunk, what is the same for all particles (weights, updates) is done in
/// loops over particles that the compiler vectorizes; the sums over nodes are done particle by particle. Weights and
/// sums are those of products over the axes (axis_weights.h, axis_sums.h) or of corners (corner_kernels.h).
#pragma once

#include <cstring>
#include <type_traits>

#include "core/transfer/axis_sums.h"

namespace sluice {
namespace kernel {

/// What the loops weigh with: ChunkWeights, or CornerWeights (corner_kernels.h).
template <int Dim, class Shape>
struct WeightsOf {
  using type = ChunkWeights<Dim, Shape>;
};

/// Of shapes by corners: corner_kernels.h.
template <int Dim, class Shape>
Stencil<Dim> corner_stencil(const GridGeometry<Dim>& grid, const Vector<Dim>& x, std::span<const double> domain);

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

template <int Dim, class Shape>
SLUICE_ALWAYS_INLINE void clear_tile(Lane* tile) {
  std::memset(static_cast<void*>(tile), 0, sizeof(Lane) * power(tile_row<Dim, Shape>, Dim));
}

/// Calls body(first particle, number of particles, weights) for the chunks of a block, with what weigh() fills in.
template <int Dim, class Shape, bool Distances, bool AffineWeights, class Body>
SLUICE_ALWAYS_INLINE void for_chunks(const BlockParticles<Dim>& block, const Body& body) {
  typename WeightsOf<Dim, Shape>::type w;
  for (std::uint32_t begin = block.begin; begin < block.end; begin += chunk_size) {
    const int count = static_cast<int>(std::min<std::uint32_t>(chunk_size, block.end - begin));
    weigh<Dim, Shape, Distances, AffineWeights>(block, begin, count, w);
    body(begin, count, w);
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
  if constexpr (momentum) clear_tile<Dim, Shape>(tile);
  if constexpr (force) clear_tile<Dim, Shape>(force_tile);

  for_chunks<Dim, Shape, Affine, false>(
      in.particles, [&](std::uint32_t begin, int count, const auto& w) SLUICE_INLINE_LAMBDA {
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
          if constexpr (Dim == 2 && momentum && force &&
                        std::is_same_v<typename WeightsOf<Dim, Shape>::type, ChunkWeights<Dim, Shape>>) {
            add_both_to_nodes<Shape, Affine>(w, k, mass_and_momentum<Dim>(in.mass[p], in.velocity, p), slope,
                                             Body ? body_force<Dim>(in.body_force, p) : Lane{}, flux, tile, force_tile);
            continue;
          }
          if constexpr (momentum)
            add_to_nodes<Dim, Shape, Affine, impulse>(w, k, mass_and_momentum<Dim>(in.mass[p], in.velocity, p), slope,
                                                      flux, tile);
          if constexpr (force) {
            Lane body{};
            if constexpr (Body) body = body_force<Dim>(in.body_force, p);
            add_to_nodes<Dim, Shape, false, true>(w, k, body, slope, flux, force_tile);
          }
        }
      });
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
  ChunkGathered<Dim> g;
  double largest = 0;
  for_chunks<Dim, Shape, false, false>(block, [&](std::uint32_t begin, int count, const auto& w) SLUICE_INLINE_LAMBDA {
    sum_chunk<Dim, Shape, false, true, false>(w, count, motion_tile, g);
    largest = std::max(largest, write_strain<Dim>(g, count, dt, begin - block.begin, out));
  });
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
  ChunkGathered<Dim> g;
  MotionReport report;
  double largest_strain = 0;
  for_chunks<Dim, Shape, false, own_affine>(
      block, [&](std::uint32_t begin, int count, const auto& w) SLUICE_INLINE_LAMBDA {
        sum_chunk<Dim, Shape, true, Strain || affine_is_gradient || Shape::by_corners, own_affine>(w, count,
                                                                                                   motion_tile, g);
        if constexpr (affine_is_gradient)
          for (int a = 0; a < Dim; ++a) std::copy_n(g.gradient[a], count, g.affine[a]);
        if constexpr (Strain)
          largest_strain =
              std::max(largest_strain, write_strain<Dim>(g, count, update.dt, begin - block.begin, *update.strain));
        move<Dim, Field != AffineField::none>(g, block, begin, count, update, report);
        if constexpr (Shape::by_corners)
          if (update.domain[0] != nullptr) move_domains<Dim, Shape>(w, g, block, begin, count, motion_tile, update);
      });
  if constexpr (Strain) report.largest_strain_rate = largest_strain / update.dt;
  return report;
}

/// The velocities of the nodes to the particles and back: {m, m v}. What is lost on the way is what one mapping
/// smooths.
template <int Dim, class Shape>
SLUICE_MULTITARGET void map_again(const BlockParticles<Dim>& block, const double* mass, const Lane* motion_tile,
                                  Lane* tile) {
  clear_tile<Dim, Shape>(tile);
  for_chunks<Dim, Shape, false, false>(block, [&](std::uint32_t begin, int count, const auto& w) SLUICE_INLINE_LAMBDA {
    for (int k = 0; k < count; ++k) {
      const double m = mass[begin + static_cast<std::uint32_t>(k)];
      const Lane v = sum_nodes<Dim, Shape, true, false, false>(w, k, motion_tile).value[0];
      const Lane base = {m, m * v[0], m * v[1], Dim == 3 ? m * v[2] : 0};
      add_to_nodes<Dim, Shape, false, false>(w, k, base, nullptr, nullptr, tile);
    }
  });
}

/// Writes component `component` of every lane of a chunk to a column.
SLUICE_ALWAYS_INLINE void write_component(const Lane* lanes, int component, int count, double* __restrict column) {
  const double* __restrict from = reinterpret_cast<const double*>(lanes) + component;
#pragma omp simd
  for (int p = 0; p < count; ++p) column[p] = from[4 * p];
}

template <int Dim, class Shape>
SLUICE_MULTITARGET void gather_divergence(const BlockParticles<Dim>& block, const Lane* motion_tile, double* divergence,
                                          const std::array<double*, Dim>& change) {
  constexpr int lanes = motion_lanes<Dim>, numbers = lanes * lane_width;
  alignas(64) Lane sums[chunk_size * lanes];
  const double* __restrict sum = reinterpret_cast<const double*>(sums);
  for_chunks<Dim, Shape, false, false>(block, [&](std::uint32_t begin, int count, const auto& w) SLUICE_INLINE_LAMBDA {
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
  });
}

template <int Dim, class Shape>
SLUICE_MULTITARGET void scatter_pressure(const BlockParticles<Dim>& block, const double* volume, const double* pressure,
                                         Lane* tile) {
  clear_tile<Dim, Shape>(tile);
  for_chunks<Dim, Shape, false, false>(block, [&](std::uint32_t begin, int count, const auto& w) SLUICE_INLINE_LAMBDA {
    for (int p = 0; p < count; ++p) add_gradient<Dim, Shape>(w, p, volume[begin + p] * pressure[begin + p], tile);
  });
}

}  // namespace kernel
}  // namespace sluice
