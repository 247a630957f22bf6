/// Piecewise linear shape functions on the cells: docs/theory.md, eq. (12). See shape_kernels_of.h.
#pragma once

#include "core/transfer/shape_kernels_of.h"

namespace sluice {
namespace shape {

struct Linear : PointShape {
  static constexpr int nodes = 2, reach = 1, outside = 0;
  static constexpr bool smooth = false;
  /// Transfers keep points this far inside the cell, in cells. A point on a node has no weight on the next one, whose
  /// velocity would then be unknown and the gradient wrong.
  static constexpr double hair = 1e-14;
  /// The slope, and with it the force on a node, does not go to zero with the weight: the acceleration of a node that
  /// holds but a hair would be noise.
  static constexpr double negligible_weight = 1e-11;

  static SLUICE_ALWAYS_INLINE void evaluate(const kernel::AxisPlace& at, double* value, double* slope,
                                            double* distance) {
    const double t = at.low;
    value[0] = 1 - t;
    value[1] = t;
    slope[0] = -1;
    slope[1] = 1;
    distance[0] = -t;
    distance[1] = 1 - t;
  }
  static constexpr bool moments_are_slopes = true;
  static SLUICE_ALWAYS_INLINE void affine(const kernel::AxisPlace&, const double*, const double*, double* weight) {
    weight[0] = -1;
    weight[1] = 1;
  }
  static double node_offset(int i, int) { return i; }
};

}  // namespace shape
}  // namespace sluice
