#include "core/transfer/corner_kernels.h"

namespace sluice {
namespace shape {

/// Convected particle domain interpolation (Sadeghirad, Brannon & Burghardt 2011): a particle is a parallelogram (or
/// parallelepiped) that its deformation gradient carries along. Its numbers are its half edges r_1, r_2, (r_3).
struct Cpdi : CornerShape {
  template <int Dim>
  static constexpr int numbers = Dim* Dim;

  static ColumnSpec domain(int dimension) {
    return {"domain", "m", dimension * dimension, Role::state, "Half edges of the particle, one vector after another.",
            false};
  }
  template <int Dim>
  static void fill(const GridGeometry<Dim>& grid, double share, double* number) {
    for (int k = 0; k < Dim; ++k)
      for (int a = 0; a < Dim; ++a)
        number[k * Dim + a] = k == a ? 0.5 * share * grid.cell[static_cast<std::size_t>(a)] : 0;
  }
  /// grad = sum_c f_c sum_k s_ck g_k / 2^Dim, with the signs s_ck of corner c and the basis g_k dual to r_k.
  template <int Dim>
  static SLUICE_ALWAYS_INLINE void corners(const double* r, kernel::Corners<Dim>& corner) {
    double dual[Dim][Dim];
    if constexpr (Dim == 2) {
      const double inverse = 1 / (r[0] * r[3] - r[1] * r[2]);
      dual[0][0] = r[3] * inverse, dual[0][1] = -r[2] * inverse;
      dual[1][0] = -r[1] * inverse, dual[1][1] = r[0] * inverse;
    } else {
      for (int k = 0; k < 3; ++k) {
        const double *const u = r + (k + 1) % 3 * 3, *const v = r + (k + 2) % 3 * 3;
        for (int a = 0; a < 3; ++a) dual[k][a] = u[(a + 1) % 3] * v[(a + 2) % 3] - u[(a + 2) % 3] * v[(a + 1) % 3];
      }
      const double inverse = 1 / (r[0] * dual[0][0] + r[1] * dual[0][1] + r[2] * dual[0][2]);
      for (int k = 0; k < 3; ++k)
        for (int a = 0; a < 3; ++a) dual[k][a] *= inverse;
    }
    constexpr double share = 1.0 / kernel::Corners<Dim>::count;
    for (int c = 0; c < corner.count; ++c) {
      corner.share[c] = share;
      for (int a = 0; a < Dim; ++a) {
        double offset = 0, gradient = 0;
        for (int k = 0; k < Dim; ++k) {
          const double sign = c >> k & 1 ? 1 : -1;
          offset += sign * r[k * Dim + a];
          gradient += sign * dual[k][a];
        }
        corner.offset[c][a] = offset;
        corner.gradient[c][a] = share * gradient;
      }
    }
  }
  template <int Dim>
  static SLUICE_ALWAYS_INLINE void follow(const kernel::CornerMotion<Dim>& motion, double* r, double*) {
    for (int k = 0; k < Dim; ++k) {
      double change[Dim] = {};
      for (int a = 0; a < Dim; ++a)
        for (int b = 0; b < Dim; ++b) change[a] += motion.gradient[a][b] * r[k * Dim + b];
      for (int a = 0; a < Dim; ++a) r[k * Dim + a] += change[a];
    }
  }
};

SLUICE_REGISTER_SHAPE(cpdi, Cpdi, "cpdi",
                      "Convected particle domains (CPDI): particles are parallelograms that deform with the material.")

}  // namespace shape
}  // namespace sluice
