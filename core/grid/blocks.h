/// Blocks: which parts of the grid are active, and which particles belong to them.
///
/// The particles are kept sorted by block, then material, then cell. A block of particles works on a tile, a small
/// dense patch of nodes that covers everything its particles can reach; tiles are summed into blocks of nodes in a
/// fixed order, so results do not depend on the number of threads. Memory and time are proportional to the blocks in
/// use.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "core/grid/geometry.h"
#include "core/particles/particles.h"

namespace sluice {

/// Consecutive particles of one block and one material.
struct Batch {
  std::uint32_t begin, end;
  std::int32_t material;
};

template <int Dim>
struct ParticleBlock {
  Index<Dim> first_cell;
  std::uint32_t begin, end;                              ///< its particles
  std::uint32_t first_batch, last_batch;                 ///< its batches, [first, last)
  std::array<std::int32_t, neighbourhood<Dim>> nodes{};  ///< the node blocks under its tile, first axis fastest
};

template <int Dim>
struct NodeBlock {
  Index<Dim> first_node;
  Index<Dim> low, high;  ///< the part [low, high) of the block that particles can reach
  std::array<std::int32_t, neighbourhood<Dim>> particles{};  ///< the particle blocks around it; -1: none there
};

template <int Dim>
class Blocks {
 public:
  /// Sorts the particles and finds the active blocks. `degree` is that of the shape functions.
  void sort(Particles& particles, const GridGeometry<Dim>& grid, int degree);

  /// Forgets all blocks, when the particles have changed otherwise than by moving: the next step sorts.
  void clear() { particle_blocks_.clear(), node_blocks_.clear(), batches_.clear(); }

  const std::vector<ParticleBlock<Dim>>& particle_blocks() const { return particle_blocks_; }
  const std::vector<NodeBlock<Dim>>& node_blocks() const { return node_blocks_; }
  const std::vector<Batch>& batches() const { return batches_; }
  std::size_t largest_block() const { return largest_block_; }

  /// Which particles are in which block is history (they may have wandered since the last sort), so a checkpoint
  /// keeps it.
  std::vector<std::int64_t> record() const;
  void restore(const std::vector<std::int64_t>& record, const Particles& particles, int degree);

 private:
  void connect(int degree);

  std::vector<ParticleBlock<Dim>> particle_blocks_;
  std::vector<NodeBlock<Dim>> node_blocks_;
  std::vector<Batch> batches_;
  std::size_t largest_block_ = 0;
};

extern template class Blocks<2>;
extern template class Blocks<3>;

}  // namespace sluice
