#include "core/transfer/shape_kernels_of.h"

namespace sluice {
namespace shape {

/// Quadratic B-splines with knots on the cell edges, the end knots repeated (open knot vector), so that constants and
/// linear fields are reproduced up to the wall and the outermost node carries the value at the wall: docs/theory.md,
/// eq. (13).
struct QuadraticBSpline : PointShape {
  static constexpr int nodes = 3, reach = 2, outside = 0;
  static constexpr bool smooth = true;
  static constexpr double hair = 0;
  /// Weight and slope go to zero together, the weight as its square: quotients are good down to round-off.
  static constexpr double negligible_weight = 1e-12;

  static SLUICE_ALWAYS_INLINE void evaluate(const kernel::AxisPlace& at, double* value, double* slope,
                                            double* distance) {
    const double t = at.low, first = at.below == 0 ? 1.0 : 0.0, last = at.above == 0 ? 1.0 : 0.0;
    const double a = 0.5 + 0.5 * first, b = 0.5 + 0.5 * last, s = 1 - t;
    value[0] = a * s * s;
    value[2] = b * t * t;
    value[1] = 1 - value[0] - value[2];
    slope[0] = -2 * a * s;
    slope[2] = 2 * b * t;
    slope[1] = -slope[0] - slope[2];
    distance[0] = -0.5 + 0.5 * first - t;  // Greville abscissae
    distance[1] = 0.5 - t;
    distance[2] = 1.5 - 0.5 * last - t;
  }
  /// APIC's weights N_i (x_i - x) / sum_j N_j (x_j - x)^2, in 1/cells. Inside, the sum is 1/4. In the cell at a wall it
  /// is t (2 - t) / 4, which goes to zero with t; t cancels, and the quotient is written without it.
  static SLUICE_ALWAYS_INLINE void affine(const kernel::AxisPlace& at, const double*, const double*, double* weight) {
    const double t = at.low, first = at.below == 0 ? 1.0 : 0.0, last = at.above == 0 ? 1.0 : 0.0;
    const double s = 1 - t, p = 4 / (2 - t), q = 4 / (2 - s);
    // Weights by arithmetic, not by branches, so that the loop over particles is vectorized.
    const double inside = (1 - first) * (1 - last), lower = first * (1 - last), upper = (1 - first) * last,
                 both = first * last;
    weight[0] =
        inside * (2 * s * s * (-0.5 - t)) - lower * (s * s * p) - upper * (0.5 * s * (1.5 - s) * q) - both * 2 * s;
    weight[1] = inside * (4 * (0.5 + t * s) * (0.5 - t)) + lower * ((2 - 1.5 * t) * (0.5 - t) * p) -
                upper * ((2 - 1.5 * s) * (0.5 - s) * q) + both * (2 - 4 * t);
    weight[2] =
        inside * (2 * t * t * (1.5 - t)) + lower * (0.5 * t * (1.5 - t) * p) + upper * (t * t * q) + both * 2 * t;
  }
  /// Position of node i of an axis of n cells, in cells from the lower end.
  static double node_offset(int i, int n) { return i == 0 ? 0 : i == n + 1 ? n : i - 0.5; }
};

SLUICE_REGISTER_SHAPE(quadratic_bspline, QuadraticBSpline, "quadratic_bspline",
                      "Quadratic B-splines, modified at walls: smooth forces when particles cross cells.")

}  // namespace shape
}  // namespace sluice
