/// Totals over the particles of one material.
#pragma once

#include <array>
#include <string>

#include "core/particles/particles.h"

namespace sluice {

/// Mass and momentum of the particles of one material.
struct Body {
  double mass = 0;
  std::array<double, 3> momentum{}, travel{};  // travel: mass-weighted displacement

  double velocity(std::size_t axis) const { return momentum[axis] / mass; }
  double displacement(std::size_t axis) const { return travel[axis] / mass; }
};

inline Body body_of(const Particles& particles, const std::string& name) {
  Body body;
  for (std::size_t p = 0; p < particles.size(); ++p) {
    if (particles.material_names[static_cast<std::size_t>(particles.material[p])] != name) continue;
    const double mass = particles.columns.data(particles.mass)[p];
    body.mass += mass;
    for (int a = 0; a < particles.dimension; ++a) {
      body.momentum[static_cast<std::size_t>(a)] += mass * particles.columns.data(particles.velocity, a)[p];
      body.travel[static_cast<std::size_t>(a)] += mass * particles.displacement(p, a);
    }
  }
  return body;
}

}  // namespace sluice
