/// Sweep: the stages of a step, taken over the grid together, so that what one stage writes is still in the cache when
/// the next ones read it.
#pragma once

#include <functional>
#include <vector>

#include "core/grid/blocks.h"
#include "core/parallel/parallel.h"

namespace sluice {

/// A list of stages over the blocks of particles or of nodes. `run` leads the first stage over the grid some blocks at
/// a time, and lets each stage follow the one before as far as the blocks around are done. A stage may hence read what
/// the stages before it wrote on the same and on neighbouring blocks (after a stage over nodes, another one over nodes
/// on the same block only), and must not change what they read there: each block then finds what it would find if every
/// stage had gone over the whole grid, and results are the same bit for bit.
template <int Dim>
class Sweep {
 public:
  explicit Sweep(const Blocks<Dim>& blocks) : blocks_(blocks) {}

  /// A stage is called with consecutive blocks, once for each block.
  using Stage = std::function<void(Items)>;
  Sweep& over_particles(Stage stage) { return add(true, std::move(stage)); }
  Sweep& over_nodes(Stage stage) { return add(false, std::move(stage)); }

  /// The first stage does this many blocks for each thread at a time: few, so that they stay in the cache until the
  /// last stage has done them, but many against those in work when the threads wait for each other. Measured.
  static constexpr std::size_t usual_pace = 96;
  /// So few blocks, some 5 MiB of tiles and particles for each of two threads, are done at one go.
  static constexpr std::size_t few_blocks = 512;
  void run(std::size_t blocks_per_thread) const;
  void run() const;

 private:
  struct Entry {
    bool particles;  ///< over blocks of particles, not nodes
    Stage stage;
  };
  Sweep& add(bool particles, Stage stage) {
    stages_.push_back({particles, std::move(stage)});
    return *this;
  }
  std::size_t ready(std::size_t stage, std::size_t done_before) const;

  const Blocks<Dim>& blocks_;
  std::vector<Entry> stages_;
};

extern template class Sweep<2>;
extern template class Sweep<3>;

}  // namespace sluice
