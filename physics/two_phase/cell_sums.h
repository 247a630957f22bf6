/// CellSums: what the particles of a cell say of its water, and the loop that adds it up. docs/theory.md, eq. (45).
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "core/grid/lane.h"
#include "core/transfer/cell_tile.h"

namespace sluice {

/// Sums over the wet particles of a cell, each weighted with the volume.
template <int Dim>
struct alignas(sizeof(Lane)) CellSums {
  double volume = 0;                   ///< [m3]
  double inverse_density = 0;          ///< of 1 / rho, rho that of soil with water
  double compliance = 0;               ///< of 1 / M, M the constrained modulus of the skeleton; 0 without one
  double storage = 0;                  ///< of n / K_w
  std::array<double, Dim> mobility{};  ///< of K = k / gamma_w and the like [m2/(Pa s)], along each axis
  std::array<double, Dim> push{};      ///< of K rho_w (b - a) and the like: what drives water but the pressure [m/s]

  static constexpr std::size_t numbers = 4 + 2 * Dim;  ///< that a cell has, in the order above
  static constexpr std::size_t lanes = (numbers + lane_width - 1) / lane_width;
  Lane* as_lanes() { return reinterpret_cast<Lane*>(this); }
  const Lane* as_lanes() const { return reinterpret_cast<const Lane*>(this); }

  void add(const CellSums& other) {
    for (std::size_t l = 0; l < lanes; ++l) as_lanes()[l] += other.as_lanes()[l];
  }
};

/// How easily water passes a soil: k / gamma_w along each axis [m2/(Pa s)], which follows the porosity.
template <int Dim>
struct Mobility {
  std::array<double, Dim> initial{};  ///< at the start
  double constant = 0;                ///< 1 where it does not follow the porosity, else 0
  double per_kozeny_carman = 0;       ///< (1 - n)^2 / n^3 at the start where it does, else 0
  double most = 0;                    ///< no more than this

  /// By how much a porosity n changes it: Kozeny, Carman.
  SLUICE_ALWAYS_INLINE double factor(double n) const {
    const double grains = 1 - n;
    return constant + per_kozeny_carman * (n * n * n / (grains * grains));
  }
  SLUICE_ALWAYS_INLINE double along(std::size_t axis, double factor) const {
    const double mobility = factor * initial[axis];
    return mobility < most ? mobility : most;
  }
};

/// Particles of one material in a block, and what their sums need. Pointers are to whole columns.
template <int Dim>
struct WaterBatch {
  BlockParticles<Dim> particles;
  const double *volume, *mass, *porosity, *wet, *pressure, *divergence;
  std::array<const double*, Dim> pressure_gradient;
  std::array<const double*, Dim> change;      ///< of the velocity, predicted [m/s]
  std::array<const double*, Dim> relative{};  ///< velocity of the water; nulls where it has no inertia of its own
  bool liquid;                                ///< nothing but water
  Mobility<Dim> mobility;
  double compliance;       ///< 1 / M
  double compressibility;  ///< 1 / K_w [1/Pa]
  double density;          ///< rho_w
  double kick;             ///< [s]
  Vector<Dim> gravity;
};

/// Adds the wet particles of a batch to the cells (cell_tile) and the vertices {V, V p, V div v, 0} (the tile of linear
/// functions) of their block, the pressure continued to the vertices along its gradient. Returns the power that the
/// flow through the pores dissipates [W].
template <int Dim>
double add_water(const WaterBatch<Dim>& batch, CellSums<Dim>* cells, Lane* vertices);

}  // namespace sluice
