#include "core/transfer/shape_kernels.h"

namespace sluice {

template <>
ShapeRegistry<2>& shape_registry<2>() {
  static ShapeRegistry<2> registry("shape function", "shapes");
  return registry;
}

template <>
ShapeRegistry<3>& shape_registry<3>() {
  static ShapeRegistry<3> registry("shape function", "");
  return registry;
}

}  // namespace sluice
