#include "core/grid/nodes.h"

#include <algorithm>
#include <cstdlib>
#include <new>

namespace sluice {

void LaneArray::Free::operator()(Lane* p) const { std::free(p); }

void LaneArray::resize(std::size_t count) {
  if (count <= capacity_) return;
  capacity_ = count + count / 4;
  const std::size_t bytes = (capacity_ * sizeof(Lane) + 63) / 64 * 64;
  auto* p = static_cast<Lane*>(std::aligned_alloc(64, bytes));
  if (p == nullptr) throw std::bad_alloc();
  data_.reset(p);
}

template <int Dim>
void NodeFields<Dim>::resize(const Blocks<Dim>& blocks, int reach) {
  tile_width_ = tile_width<Dim>(reach);
  tile_size_ = static_cast<std::size_t>(power(tile_width_, Dim));
  const std::size_t nodes = blocks.node_blocks().size() * block_nodes<Dim>;
  momentum_.resize(nodes);
  force_.resize(nodes);
  motion_.resize(nodes * motion_lanes<Dim>);
  const std::size_t tiles = blocks.particle_blocks().size() * tile_size_;
  momentum_tiles_.resize(tiles);
  force_tiles_.resize(tiles);
}

namespace {

/// The part of a node block that one tile overlaps: nodes [low, high) of the block, node i of the block at i + offset
/// of the tile.
struct Overlap {
  int low, high, offset;
  Overlap(int width, int tile, int shift)
      : low(std::max(0, -(width * shift + tile_margin))),
        high(std::min(width, tile - (width * shift + tile_margin))),
        offset(width * shift + tile_margin) {}
};

/// Calls row(node, place, length) for every row along the first axis that a node block shares with a tile: `length`
/// nodes from number `node` of the block and number `place` of the tile on. `n` numbers the shift from the tile's block
/// to the node block.
template <int Dim, class Row>
void for_shared_rows(int tile, int n, const Row& row) {
  constexpr int width = block_width<Dim>;
  const Overlap x(width, tile, n % 3 - 1), y(width, tile, n / 3 % 3 - 1);
  if constexpr (Dim == 2) {
    for (int j = y.low; j < y.high; ++j)
      row(j * width + x.low, (j + y.offset) * tile + x.low + x.offset, x.high - x.low);
  } else {
    const Overlap z(width, tile, n / 9 - 1);
    for (int k = z.low; k < z.high; ++k)
      for (int j = y.low; j < y.high; ++j)
        row((k * width + j) * width + x.low, ((k + z.offset) * tile + j + y.offset) * tile + x.low + x.offset,
            x.high - x.low);
  }
}

}  // namespace

template <int Dim>
void NodeFields<Dim>::collect(const Blocks<Dim>& blocks, std::size_t node_block, const LaneArray& tiles,
                              Lane* nodes) const {
  const auto& around = blocks.node_blocks()[node_block].particles;
  for (int n = 0; n < neighbourhood<Dim>; ++n) {
    const std::int32_t block = around[static_cast<std::size_t>(n)];
    if (block < 0) continue;
    const Lane* tile = tiles.data() + static_cast<std::size_t>(block) * tile_size_;
    // particles[n] lies at shift n from the nodes, so the nodes lie at the opposite shift from it.
    for_shared_rows<Dim>(tile_width_, neighbourhood<Dim> - 1 - n, [&](int node, int place, int length) {
      for (int i = 0; i < length; ++i) nodes[node + i] += tile[place + i];
    });
  }
}

template <int Dim>
void NodeFields<Dim>::collect_momentum(const Blocks<Dim>& blocks, std::size_t node_block) {
  std::fill_n(momentum(node_block), block_nodes<Dim>, Lane{});
  collect(blocks, node_block, momentum_tiles_, momentum(node_block));
}

template <int Dim>
void NodeFields<Dim>::collect_force(const Blocks<Dim>& blocks, std::size_t node_block) {
  std::fill_n(force(node_block), block_nodes<Dim>, Lane{});
  add_force(blocks, node_block);
}

template <int Dim>
void NodeFields<Dim>::add_force(const Blocks<Dim>& blocks, std::size_t node_block) {
  collect(blocks, node_block, force_tiles_, force(node_block));
}

template <int Dim>
void NodeFields<Dim>::load_motion(const Blocks<Dim>& blocks, std::size_t block, Lane* tile) const {
  constexpr int lanes = motion_lanes<Dim>;
  const auto& around = blocks.particle_blocks()[block].nodes;
  for (int n = 0; n < neighbourhood<Dim>; ++n) {
    const Lane* nodes = motion_.data() + static_cast<std::size_t>(around[static_cast<std::size_t>(n)]) *
                                             block_nodes<Dim> * static_cast<std::size_t>(lanes);
    for_shared_rows<Dim>(tile_width_, n, [&](int node, int place, int length) {
      std::copy_n(nodes + node * lanes, length * lanes, tile + place * lanes);
    });
  }
}

template class NodeFields<2>;
template class NodeFields<3>;

}  // namespace sluice
