/// Blocks: which parts of the grid are active, and which particles belong to them.
///
/// The particles are kept sorted by block, then material, then cell. A block of particles works on a tile, a small
/// dense patch of nodes that covers everything its particles can reach; tiles are summed into blocks of nodes in a
/// fixed order, so results do not depend on the number of threads. Memory and time are proportional to the blocks in
/// use. Along a periodic axis the blocks at both ends are neighbours; nothing else knows of the seam but a block that
/// is alone on such an axis, which is its own neighbour.
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
  /// The node with this number in the block, the first axis fastest.
  Index<Dim> node(int number) const {
    Index<Dim> place = first_node;
    for (int a = 0; a < Dim; ++a, number /= block_width<Dim>) place[a] += number % block_width<Dim>;
    return place;
  }
  Index<Dim> low, high;  ///< the part [low, high) of the block that particles can reach
  std::array<std::int32_t, neighbourhood<Dim>> particles{};  ///< the particle blocks around it; -1: none there
};

template <int Dim>
class Blocks {
 public:
  /// Sorts the particles and finds the active blocks. `reach` is that of the shape functions. Particles beyond the ends
  /// of periodic axes are brought back first.
  void sort(Particles& particles, const GridGeometry<Dim>& grid, int reach);

  /// Forgets all blocks, when the particles have changed otherwise than by moving: the next step sorts.
  void clear() { particle_blocks_.clear(), node_blocks_.clear(), batches_.clear(); }

  const std::vector<ParticleBlock<Dim>>& particle_blocks() const { return particle_blocks_; }
  const std::vector<NodeBlock<Dim>>& node_blocks() const { return node_blocks_; }
  const std::vector<Batch>& batches() const { return batches_; }
  std::size_t largest_block() const { return largest_block_; }

  /// The blocks of nodes [0, n) whose sums are complete once particle blocks [0, done) have filled their tiles.
  std::size_t nodes_ready(std::size_t done) const { return ready(particles_needed_, done); }
  /// The blocks of particles [0, n) whose tiles are complete once node blocks [0, done) are.
  std::size_t particles_ready(std::size_t done) const { return ready(nodes_needed_, done); }

  /// Which particles are in which block is history (they may have wandered since the last sort), so a checkpoint
  /// keeps it.
  std::vector<std::int64_t> record() const;
  void restore(const std::vector<std::int64_t>& record, const Particles& particles, const GridGeometry<Dim>& grid,
               int reach);

 private:
  void connect(const GridGeometry<Dim>& grid, int reach);
  void note_needs();
  static std::size_t ready(const std::vector<std::size_t>& needed, std::size_t done);

  std::vector<ParticleBlock<Dim>> particle_blocks_;
  std::vector<NodeBlock<Dim>> node_blocks_;
  std::vector<Batch> batches_;
  std::vector<std::size_t> nodes_needed_;      // of particle blocks [0, b]: the blocks of nodes under them are [0, n)
  std::vector<std::size_t> particles_needed_;  // of node blocks [0, b]: the blocks of particles around are [0, n)
  std::size_t largest_block_ = 0;
};

extern template class Blocks<2>;
extern template class Blocks<3>;

}  // namespace sluice
