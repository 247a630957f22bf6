#include "core/simulation/physics_module.h"

namespace sluice {

template <>
PhysicsRegistry<2>& physics_registry<2>() {
  static PhysicsRegistry<2> registry("physics", "physics");
  return registry;
}

template <>
PhysicsRegistry<3>& physics_registry<3>() {
  static PhysicsRegistry<3> registry("physics", "");
  return registry;
}

}  // namespace sluice
