#include "core/transfer/linear.h"

namespace sluice {
namespace shape {

SLUICE_REGISTER_SHAPE(linear, Linear, "linear",
                      "Piecewise linear: the cheapest; forces jump when particles cross cells.")

}  // namespace shape
}  // namespace sluice
