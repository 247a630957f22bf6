#include "core/simulation/sweep.h"

#include <algorithm>

namespace sluice {

/// The blocks [0, n) that a stage can do once the stage before it has done [0, done_before).
template <int Dim>
std::size_t Sweep<Dim>::ready(std::size_t stage, std::size_t done_before) const {
  const bool from_particles = stages_[stage - 1].particles, to_particles = stages_[stage].particles;
  const std::size_t nodes = from_particles ? blocks_.nodes_ready(done_before) : done_before;
  return to_particles ? blocks_.particles_ready(nodes) : nodes;
}

template <int Dim>
void Sweep<Dim>::run(std::size_t blocks_per_thread) const {
  if (stages_.empty()) return;
  const std::size_t count = stages_[0].particles ? blocks_.particle_blocks().size() : blocks_.node_blocks().size();
  const std::size_t stride = blocks_per_thread * static_cast<std::size_t>(thread_count());
  std::vector<std::size_t> done(stages_.size(), 0);
  while (done[0] < count) {
    for (std::size_t s = 0; s < stages_.size(); ++s) {
      const std::size_t end = s == 0 ? std::min(done[0] + stride, count) : ready(s, done[s - 1]);
      if (done[s] < end) stages_[s].stage({done[s], end});
      done[s] = end;
    }
  }
}

template <int Dim>
void Sweep<Dim>::run() const {
  run(blocks_.particle_blocks().size() <= few_blocks ? few_blocks : usual_pace);
}

template class Sweep<2>;
template class Sweep<3>;

}  // namespace sluice
