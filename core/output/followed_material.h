/// FollowedMaterial: the particles that lay in a region at the start, kept by id: particles are sorted, and some may
/// leave.
#pragma once

#include <cstdint>
#include <vector>

#include "core/case/geometry.h"
#include "core/output/observation.h"
#include "core/particles/particles.h"

namespace sluice {

class FollowedMaterial {
 public:
  /// Everything where the observation has no region. Throws CaseError if no material lies in it.
  FollowedMaterial(const ObservationCase& observation, const Particles& particles) {
    std::vector<double> start(static_cast<std::size_t>(particles.dimension));
    bool any = false;
    for (std::size_t i = 0; i < particles.size(); ++i) {
      for (std::size_t k = 0; k < start.size(); ++k)
        start[k] = particles.columns.data(particles.initial_position, static_cast<int>(k))[i];
      const auto id = static_cast<std::size_t>(particles.id[i]);
      if (id >= followed_.size()) followed_.resize(id + 1, 0);
      followed_[id] = !observation.region || observation.region->contains(start);
      any = any || followed_[id];
    }
    if (!any)
      throw CaseError(observation.place, "observation '" + observation.name + "': no material lies in its region");
  }
  bool contains(const Particles& particles, std::size_t particle) const {
    const auto id = static_cast<std::size_t>(particles.id[particle]);
    return id < followed_.size() && followed_[id];
  }

 private:
  std::vector<std::uint8_t> followed_;  // by id
};

}  // namespace sluice
