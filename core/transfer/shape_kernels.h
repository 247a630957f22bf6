/// ShapeKernels: everything that depends on the shape functions, block by block.
///
/// A block of particles scatters to a tile of nodes, and gathers from one (see core/grid/nodes.h). The functions are
/// virtual: one call a block of some hundred particles. Each shape function is one file that registers its kernels.
#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <memory>
#include <span>

#include "core/case/registry.h"
#include "core/grid/blocks.h"
#include "core/grid/geometry.h"
#include "core/grid/lane.h"
#include "core/grid/nodes.h"

namespace sluice {

/// Independent components of the spin: 2-D one, 3-D three: the components w_ab =
/// (dv_a/dx_b - dv_b/dx_a) / 2 with ab = yx in 2-D (a counter-clockwise turn is positive), xy yz xz in 3-D.
template <int Dim>
inline constexpr int spin_components = Dim == 2 ? 1 : 3;

/// Strain and rotation increments of consecutive particles, tensor components (see symmetric_components).
template <int Dim>
struct StrainIncrements {
  std::array<double*, symmetric_components<Dim>> strain;
  std::array<double*, spin_components<Dim>> rotation;

  StrainIncrements from(std::uint32_t particle) const {
    StrainIncrements rest = *this;
    for (double*& column : rest.strain) column += particle;
    for (double*& column : rest.rotation) column += particle;
    return rest;
  }
};

/// Most numbers that say what part of space a particle stands for: the corners of a cell, as vectors.
template <int Dim>
inline constexpr int domain_capacity = Dim* power(2, Dim);

/// The particles of a block as the kernels see them; pointers are to whole columns.
template <int Dim>
struct BlockParticles {
  const GridGeometry<Dim>* grid;
  Index<Dim> first_cell;  ///< of the block
  std::uint32_t begin, end;
  std::array<const double*, Dim> position;
  std::array<const double*, domain_capacity<Dim>> domain{};  ///< as many as ShapeKernels::domain has components
};

template <int Dim>
struct ScatterInput {
  BlockParticles<Dim> particles;
  const double* mass;
  std::array<const double*, Dim> velocity;
  std::array<const double*, Dim * Dim>
      affine{};  ///< C of APIC, row by row: C[a][b] = component a, direction b; or null
  const double* volume;
  std::array<const double*, symmetric_components<Dim>> stress;
  std::array<const double*, Dim> body_force{};  ///< [N], added with ScatterWhat::force alone; or null
};

/// What a scatter adds to the tile(s) of its block; tiles are zeroed first.
enum class ScatterWhat {
  momentum,             ///< {m, m v}
  force,                ///< {0, -V sigma grad N}
  momentum_and_force,   ///< both, to two tiles
  momentum_and_impulse  ///< {m, m v + dt f} to one tile
};

/// Shares of a particle's new velocity: of its old velocity, and of the change and the velocity of its nodes. FLIP has
/// (1, 1, 0), PIC (0, 0, 1).
struct VelocityShares {
  double old = 0, change = 0, nodes = 1;
};

/// How a particle's velocity follows from its nodes.
template <int Dim>
struct MotionUpdate {
  double dt;                                ///< length of the step [s]
  VelocityShares shares;                    ///< not used with an affine transfer, which takes that of the nodes
  std::array<double*, Dim> velocity;        ///< in and out
  std::array<double*, Dim> position;        ///< out: position + dt * velocity of the nodes
  std::array<double*, Dim * Dim> affine{};  ///< out: C of APIC; null without it
  bool affine_is_gradient = false;          ///< C is the velocity gradient (TPIC)
  std::array<double*, domain_capacity<Dim>> domain{};  ///< out, for domains that deform; nulls: they stay as they are
  const StrainIncrements<Dim>* strain =
      nullptr;  ///< out, indexed from 0 at the block's first particle; null: not wanted
};

/// What the time loop wants to know of a block after its particles moved.
struct MotionReport {
  double largest_speed_squared = 0;  ///< [m2/s2]
  double largest_travel = 0;         ///< share of a cell crossed in the step, over axes and particles
  double largest_strain_rate = 0;    ///< largest absolute component, spin included [1/s]; 0 if none was asked for
  bool finite = true;                ///< all velocities are finite
  bool inside = true;                ///< all positions are inside the grid

  void include(const MotionReport& other) {
    largest_speed_squared = std::max(largest_speed_squared, other.largest_speed_squared);
    largest_travel = std::max(largest_travel, other.largest_travel);
    largest_strain_rate = std::max(largest_strain_rate, other.largest_strain_rate);
    finite = finite && other.finite;
    inside = inside && other.inside;
  }
};

/// The nodes around one point, their values and gradients: for assembly of matrices, not for hot loops.
template <int Dim>
struct Stencil {
  static constexpr int capacity = power(4, Dim);
  int count = 0;
  std::array<Index<Dim>, capacity> node;
  std::array<double, capacity> value;
  std::array<Vector<Dim>, capacity> gradient;  ///< [1/m]
};

template <int Dim>
class ShapeKernels {
 public:
  virtual ~ShapeKernels() = default;

  virtual int reach() const = 0;    ///< a point in cell i reaches nodes i … i + reach on each axis
  virtual int outside() const = 0;  ///< so many of the nodes of an axis lie beyond each wall
  /// Slopes go to zero with the values: a node that holds but a hair of a particle is not accelerated without bounds.
  virtual bool smooth() const = 0;
  /// Where nodes stand but at walls: 0, at the corners of cells; 1/2, in their middles.
  virtual double node_shift() const = 0;
  /// A node with less than this share of a particle takes no force.
  virtual double negligible_weight() const = 0;

  /// What says which part of space a particle stands for: a column of the particles; without components if shape
  /// functions take particles as points.
  virtual ColumnSpec domain() const { return {"domain", "1", 0, Role::state, ""}; }
  /// Its numbers for a particle that fills `share` of the width of its cell on every axis.
  virtual void fill_domain(const GridGeometry<Dim>& /*grid*/, double /*share*/, std::span<double> /*numbers*/) const {}

  /// APIC's weights are products over the axes.
  virtual bool takes_moments() const { return true; }

  virtual Stencil<Dim> stencil(const GridGeometry<Dim>& grid, const Vector<Dim>& x,
                               std::span<const double> domain = {}) const = 0;
  /// Position of node (control point) `i` of axis `axis` [m]: sum_i N_i(x) position_i = x.
  virtual double node_position(const GridGeometry<Dim>& grid, int axis, int i) const = 0;

  /// `impulse_dt` [s] is used with momentum_and_impulse only.
  virtual void scatter(ScatterWhat what, const ScatterInput<Dim>& input, double impulse_dt, Lane* tile,
                       Lane* force_tile) const = 0;
  /// Strain increments dt * sym grad v from the motion tile. Returns the largest absolute component, rotation included.
  virtual double gather_strain(const BlockParticles<Dim>& particles, const Lane* motion_tile, double dt,
                               const StrainIncrements<Dim>& out) const = 0;
  /// The divergence of the nodes' velocity [1/s] and the nodes' change of velocity [m/s] at the particles.
  virtual void gather_divergence(const BlockParticles<Dim>& particles, const Lane* motion_tile, double* divergence,
                                 const std::array<double*, Dim>& change) const = 0;
  /// The forces of a pressure (p > 0 in compression), {0, V p grad N}: the transpose of the divergence.
  virtual void scatter_pressure(const BlockParticles<Dim>& particles, const double* volume, const double* pressure,
                                Lane* tile) const = 0;
  /// The velocity of the nodes to particles, and at once to nodes again: {m, m v} in `tile`.
  virtual void map_again(const BlockParticles<Dim>& particles, const double* mass, const Lane* motion_tile,
                         Lane* tile) const = 0;
  virtual MotionReport gather_motion(const BlockParticles<Dim>& particles, const Lane* motion_tile,
                                     const MotionUpdate<Dim>& update) const = 0;
};

template <int Dim>
using ShapeRegistry = Registry<std::function<std::unique_ptr<ShapeKernels<Dim>>()>>;

/// Shape functions by the name that a case file uses. The catalogue that `sluice list shapes` shows is the 2-D one.
template <int Dim>
ShapeRegistry<Dim>& shape_registry();

}  // namespace sluice
