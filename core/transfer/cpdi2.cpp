#include "core/transfer/corner_kernels.h"

namespace sluice {
namespace shape {

/// Second-order convected particle domain interpolation (Sadeghirad, Brannon & Guilkey 2013): a particle is a
/// quadrilateral (or hexahedron) whose corners move with the nodes, so that there are neither gaps nor overlaps. Its
/// numbers are the corners, seen from the particle, which is in their centre of gravity.
struct Cpdi2 : CornerShape {
  template <int Dim>
  static constexpr int numbers = Dim* power(2, Dim);

  static ColumnSpec domain(int dimension) {
    return {"domain",
            "m",
            dimension * power(2, dimension),
            Role::state,
            "Corners of the particle, seen from the particle, one vector after another.",
            false};
  }
  template <int Dim>
  static void fill(const GridGeometry<Dim>& grid, double share, double* number) {
    for (int c = 0; c < power(2, Dim); ++c)
      for (int a = 0; a < Dim; ++a)
        number[c * Dim + a] = (c >> a & 1 ? 0.5 : -0.5) * share * grid.cell[static_cast<std::size_t>(a)];
  }
  /// Means over the domain by Gauss's rule with two points an axis, which is exact: determinant and cofactors of the
  /// map from the unit cell, times a function or its derivatives, are of third degree at most along each axis.
  template <int Dim>
  static SLUICE_ALWAYS_INLINE void corners(const double* number, kernel::Corners<Dim>& corner) {
    constexpr int count = kernel::Corners<Dim>::count;
    double volume = 0;
    for (int c = 0; c < count; ++c) {
      corner.share[c] = 0;
      for (int a = 0; a < Dim; ++a) corner.offset[c][a] = number[c * Dim + a], corner.gradient[c][a] = 0;
    }
    for (int q = 0; q < count; ++q) {
      double value[count], slope[count][Dim], map[Dim][Dim] = {}, cofactor[Dim][Dim];
      functions<Dim>(q, value, slope);
      for (int c = 0; c < count; ++c)
        for (int a = 0; a < Dim; ++a)
          for (int k = 0; k < Dim; ++k) map[a][k] += corner.offset[c][a] * slope[c][k];
      cofactors<Dim>(map, cofactor);
      double determinant = 0;
      for (int k = 0; k < Dim; ++k) determinant += map[0][k] * cofactor[0][k];
      volume += determinant;
      for (int c = 0; c < count; ++c) {
        corner.share[c] += value[c] * determinant;
        for (int a = 0; a < Dim; ++a)
          for (int k = 0; k < Dim; ++k) corner.gradient[c][a] += cofactor[a][k] * slope[c][k];
      }
    }
    const double inverse = 1 / volume;
    for (int c = 0; c < count; ++c) {
      corner.share[c] *= inverse;
      for (int a = 0; a < Dim; ++a) corner.gradient[c][a] *= inverse;
    }
  }
  /// The particle stays in the centre of gravity, where linear fields are reproduced.
  template <int Dim>
  static SLUICE_ALWAYS_INLINE void follow(const kernel::CornerMotion<Dim>& motion, double* number, double* shift) {
    kernel::Corners<Dim> corner;
    for (int n = 0; n < numbers<Dim>; ++n) number[n] += motion.step[n / Dim][n % Dim];
    corners<Dim>(number, corner);
    for (int a = 0; a < Dim; ++a)
      for (int c = 0; c < corner.count; ++c) shift[a] += corner.share[c] * number[c * Dim + a];
    for (int n = 0; n < numbers<Dim>; ++n) number[n] -= shift[n % Dim];
  }

 private:
  /// The function of each corner and its derivatives on the unit cell, at Gauss point q.
  template <int Dim>
  static SLUICE_ALWAYS_INLINE void functions(int q, double* value, double (*slope)[Dim]) {
    constexpr double gauss = 0.57735026918962576451;
    for (int c = 0; c < power(2, Dim); ++c) {
      double factor[Dim];
      value[c] = 1;
      for (int k = 0; k < Dim; ++k) {
        factor[k] = 0.5 * (1 + (c >> k & 1 ? 1 : -1) * (q >> k & 1 ? gauss : -gauss));
        value[c] *= factor[k];
      }
      for (int k = 0; k < Dim; ++k) {
        slope[c][k] = c >> k & 1 ? 0.5 : -0.5;
        for (int l = 0; l < Dim; ++l)
          if (l != k) slope[c][k] *= factor[l];
      }
    }
  }
  template <int Dim>
  static SLUICE_ALWAYS_INLINE void cofactors(const double (*map)[Dim], double (*cofactor)[Dim]) {
    if constexpr (Dim == 2) {
      cofactor[0][0] = map[1][1], cofactor[0][1] = -map[1][0];
      cofactor[1][0] = -map[0][1], cofactor[1][1] = map[0][0];
    } else {
      for (int a = 0; a < 3; ++a)
        for (int k = 0; k < 3; ++k)
          cofactor[a][k] = map[(a + 1) % 3][(k + 1) % 3] * map[(a + 2) % 3][(k + 2) % 3] -
                           map[(a + 1) % 3][(k + 2) % 3] * map[(a + 2) % 3][(k + 1) % 3];
    }
  }
};

SLUICE_REGISTER_SHAPE(cpdi2, Cpdi2, "cpdi2",
                      "Convected particle domains (CPDI2): particles are quadrilaterals whose corners move with the "
                      "material, without gaps.")

}  // namespace shape
}  // namespace sluice
