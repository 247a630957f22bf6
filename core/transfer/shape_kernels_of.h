/// ShapeKernelsOf: the kernels of one shape function, and its registration. Included by the files that define a shape
/// function.
#pragma once

#include "core/transfer/kernels.h"

namespace sluice {

/// What shape functions have in common that take particles as points. A shape is a struct of static members for one
/// axis; several axes are products:
///   nodes, reach, outside  nodes that a particle takes; ShapeKernels::reach and outside
///   smooth, hair, negligible_weight  see ShapeKernels and linear.h
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
  double node_shift() const override {
    const double place = Shape::node_offset(4, 8);  // of an inner node, far from walls
    return place - std::floor(place);
  }
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

  void gather_divergence(const BlockParticles<Dim>& particles, const Lane* motion_tile, double* divergence,
                         const std::array<double*, Dim>& change) const override {
    kernel::gather_divergence<Dim, Shape>(particles, motion_tile, divergence, change);
  }

  void scatter_pressure(const BlockParticles<Dim>& particles, const double* volume, const double* pressure,
                        Lane* tile) const override {
    kernel::scatter_pressure<Dim, Shape>(particles, volume, pressure, tile);
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
