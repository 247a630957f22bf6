#include "core/transfer/shape_kernels_of.h"

namespace sluice {
namespace shape {

/// Cubic B-splines with knots on the cell edges and repeated end knots (open knot vector), so that constants and linear
/// fields are reproduced up to the wall and the outermost node carries the value at the wall: docs/theory.md, eq.
/// (13a).
struct CubicBSpline : PointShape {
  static constexpr int nodes = 4, reach = 3, outside = 0;
  static constexpr bool smooth = true;
  /// At the wall itself APIC's weights are 0/0.
  static constexpr double hair = 1e-15;
  /// The weight goes to zero as s^3, the slope as s^2: what is lost with this weight is a share of 1e-12 of the force.
  static constexpr double negligible_weight = 1e-19;

  /// The recursion of Cox and de Boor on the knots of the cell, -k2, -k1, 0, 1, l1, l2, of which the outer ones stay
  /// inside the walls. All terms are positive: small values are good to round-off.
  static SLUICE_ALWAYS_INLINE void evaluate(const kernel::AxisPlace& at, double* value, double* slope,
                                            double* distance) {
    const double t = at.low, s = 1 - t;
    const double k1 = at.below < 1 ? at.below : 1, k2 = at.below < 2 ? at.below : 2;
    const double l1 = 1 + (at.above < 1 ? at.above : 1), l2 = 1 + (at.above < 2 ? at.above : 2);
    const double to_k1 = 1 / (1 + k1), to_l1 = 1 / l1;
    const double q0 = s * s * to_k1, q2 = t * t * to_l1, q1 = (t + k1) * to_k1 * s + (l1 - t) * to_l1 * t;
    const double left = 1 / (1 + k2), middle = 1 / (l1 + k1), right = 1 / l2;
    value[0] = s * left * q0;
    value[1] = (t + k2) * left * q0 + (l1 - t) * middle * q1;
    value[2] = (t + k1) * middle * q1 + (l2 - t) * right * q2;
    value[3] = t * right * q2;
    slope[0] = -3 * left * q0;
    slope[1] = 3 * (left * q0 - middle * q1);
    slope[2] = 3 * (middle * q1 - right * q2);
    slope[3] = 3 * right * q2;
    distance[0] = -(k1 + k2) / 3 - t;  // Greville abscissae
    distance[1] = (1 - k1) / 3 - t;
    distance[2] = (1 + l1) / 3 - t;
    distance[3] = (1 + l1 + l2) / 3 - t;
  }
  static SLUICE_ALWAYS_INLINE void affine(const kernel::AxisPlace&, const double* value, const double* distance,
                                          double* weight) {
    kernel::moment_weights<nodes>(value, distance, weight);
  }
  /// The mean of the three inner knots i - 2, i - 1 and i of node i, in cells from the lower end.
  static double node_offset(int i, int n) {
    double sum = 0;
    for (int knot = i - 2; knot <= i; ++knot) sum += std::min(std::max(knot, 0), n);
    return sum / 3;
  }
};

SLUICE_REGISTER_SHAPE(cubic_bspline, CubicBSpline, "cubic_bspline",
                      "Cubic B-splines, modified at walls: smoother still, wider and dearer.")

}  // namespace shape
}  // namespace sluice
