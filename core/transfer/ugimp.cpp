#include "core/transfer/shape_kernels_of.h"

namespace sluice {
namespace shape {

/// The generalized interpolation material point with particles of constant size (uGIMP, Bardenhagen & Kober 2004):
/// values and slopes of linear functions, averaged over the particle: docs/theory.md, eq. (13b). A particle reaches
/// into the neighbouring cells. Node i stands on the edge i - 1.
struct Ugimp : PointShape {
  static constexpr int nodes = 3, reach = 3, outside = 1;
  static constexpr bool smooth = true, sized = true;
  /// At the wall itself a particle has no size left.
  static constexpr double hair = 1e-14;
  /// As with quadratic B-splines, the weight goes to zero as the square of the slope.
  static constexpr double negligible_weight = 1e-12;

  static ColumnSpec domain(int) {
    return {"half_size", "1", 1, Role::state, "Half of the size of the particle, in cells.", false};
  }
  /// `d` of the particle's length is in the first cell and `e` in the second. All terms are positive.
  static SLUICE_ALWAYS_INLINE void evaluate(const kernel::AxisPlace& at, double* value, double* slope,
                                            double* distance) {
    const double z = at.low, size = 2 * at.half, d = size < 1 - z ? size : 1 - z, e = size - d, inverse = 1 / size;
    const double in_first = d * inverse, in_second = e * inverse, t = z + at.half;
    value[0] = in_first * (1 - z - 0.5 * d);
    value[1] = in_first * (z + 0.5 * d) + in_second * (1 - 0.5 * e);
    value[2] = in_second * (0.5 * e);
    slope[0] = -in_first;
    slope[1] = in_first - in_second;
    slope[2] = in_second;
    for (int i = 0; i < 3; ++i) distance[i] = i - t;
  }
  static SLUICE_ALWAYS_INLINE void affine(const kernel::AxisPlace&, const double* value, const double* distance,
                                          double* weight) {
    kernel::moment_weights<nodes>(value, distance, weight);
  }
  static double node_offset(int i, int) { return i - outside; }
};

SLUICE_REGISTER_SHAPE(ugimp, Ugimp, "ugimp",
                      "Linear functions averaged over particles of constant size (uGIMP): smooth forces on linear "
                      "nodes.")

}  // namespace shape
}  // namespace sluice
