/// CornerIntegrals: integrals over a cell of the slopes of the linear shape functions of its corners.
#pragma once

#include <array>

#include "core/grid/geometry.h"

namespace sluice {

/// Bit a of a corner's number says that it is the upper one along axis a; m ^ n, along which axes two are apart.
template <int Dim>
struct CornerIntegrals {
  static constexpr std::size_t corners = power(2, Dim);
  /// [axis][m ^ n]: of the product of the slopes of corners m and n along the axis [m^(Dim-2)].
  std::array<std::array<double, corners>, Dim> laplacian;
  /// [axis][m]: of the slope of corner m along the axis [m^(Dim-1)].
  std::array<std::array<double, corners>, Dim> slope;

  explicit CornerIntegrals(const GridGeometry<Dim>& grid) {
    for (std::size_t axis = 0; axis < Dim; ++axis)
      for (std::size_t m = 0; m < corners; ++m) {
        const double area = grid.cell_volume() / grid.cell[axis] / (corners / 2);
        slope[axis][m] = (m >> axis & 1) != 0 ? area : -area;
        laplacian[axis][m] = slope_product(grid.cell, axis, m);
      }
  }

 private:
  static double slope_product(const Vector<Dim>& h, std::size_t axis, std::size_t apart) {
    double product = 1;
    for (std::size_t a = 0; a < Dim; ++a) {
      const bool same = (apart >> a & 1) == 0;
      if (a == axis)
        product *= (same ? 1 : -1) / h[a];
      else
        product *= h[a] * (same ? 1.0 / 3 : 1.0 / 6);
    }
    return product;
  }
};

}  // namespace sluice
