#include "core/transfer/kernels.h"

namespace sluice {
namespace shape {

/// Piecewise linear shape functions on the cells: docs/theory.md, eq. (12).
struct Linear {
  static constexpr int degree = 1;
  /// Transfers keep points this far inside the cell, in cells. A point on a node has no weight on the next one, whose
  /// velocity would then be unknown and the gradient wrong.
  static constexpr double hair = 1e-14;
  /// The slope, and with it the force on a node, does not go to zero with the weight: the acceleration of a node that
  /// holds but a hair would be noise.
  static constexpr double negligible_weight = 1e-11;

  /// At t in [0, 1) of a cell: values N, slopes dN/dt, and offsets of the nodes from the cell's lower edge, in cells.
  /// `first` and `last` are 1 in the first and last cell of the axis, else 0.
  static SLUICE_ALWAYS_INLINE void evaluate(double t, double, double, double* value, double* slope, double* offset) {
    value[0] = 1 - t;
    value[1] = t;
    slope[0] = -1;
    slope[1] = 1;
    offset[0] = 0;
    offset[1] = 1;
  }
  /// APIC's weights N_i (x_i - x) / sum_j N_j (x_j - x)^2, in 1/cells: for linear functions these are the slopes.
  static SLUICE_ALWAYS_INLINE void affine(double, double, double, double* weight) {
    weight[0] = -1;
    weight[1] = 1;
  }
  static double node_offset(int i, int) { return i; }
};

SLUICE_REGISTER_SHAPE(linear, Linear, "linear",
                      "Piecewise linear: the cheapest; forces jump when particles cross cells.")

}  // namespace shape
}  // namespace sluice
