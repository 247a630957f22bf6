#include "core/particles/particles.h"

#include <algorithm>
#include <cassert>

namespace sluice {

Particles::Particles(int dim) : dimension(dim) {
  assert(dim == 2 || dim == 3);
  const int tensor = dim == 2 ? symmetric_components<2> : symmetric_components<3>;
  const std::string tensor_order = dim == 2 ? "xx yy zz xy" : "xx yy zz xy yz xz";
  position = columns.declare({"position", "m", dim, Role::state, "Where the material point is."});
  initial_position =
      columns.declare({"initial_position", "m", dim, Role::state, "Where the material point was at time 0.", false});
  velocity =
      columns.declare({"velocity", "m/s", dim, Role::state, "Velocity at the middle of the last step (leap-frog)."});
  const std::string per_metre = dim == 2 ? ", per metre of thickness." : ".";
  mass = columns.declare({"mass", dim == 2 ? "kg/m" : "kg", 1, Role::state, "Mass" + per_metre});
  volume = columns.declare({"volume", dim == 2 ? "m2" : "m3", 1, Role::state, "Current volume" + per_metre});
  stress = columns.declare(
      {"stress", "Pa", tensor, Role::state, "Cauchy stress, tension positive; components " + tensor_order + "."});
}

void Particles::declare_periodic(std::span<const double> lengths) {
  std::copy(lengths.begin(), lengths.end(), period_.begin());
  crossings = columns.declare({"crossings", "1", dimension, Role::state,
                               "Crossings of periodic axes, counted positive where the axis points."});
}

void Particles::resize(std::size_t size) {
  columns.resize(size);
  id.resize(size);
  material.resize(size);
}

void Particles::permute(std::span<const std::uint32_t> order) {
  columns.permute(order);
  for (auto* numbers : {&id, &material}) {
    std::vector<std::int32_t> sorted(order.size());
    for (std::size_t i = 0; i < order.size(); ++i) sorted[i] = (*numbers)[order[i]];
    numbers->swap(sorted);
  }
}

}  // namespace sluice
