/// Nodes: the fields on the active nodes of the grid, and the tiles through which particles reach them.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/grid/blocks.h"
#include "core/grid/geometry.h"
#include "core/grid/lane.h"

namespace sluice {

/// Lanes that a node's motion takes: {vx, vy, dvx, dvy} in 2-D, {vx, vy, vz, 0} {dvx, dvy, dvz, 0} in 3-D.
template <int Dim>
inline constexpr int motion_lanes = Dim == 2 ? 1 : 2;

/// A growing array of lanes, aligned for vector access.
class LaneArray {
 public:
  void resize(std::size_t count);
  Lane* data() { return data_.get(); }
  const Lane* data() const { return data_.get(); }

 private:
  struct Free {
    void operator()(Lane* p) const;
  };
  std::unique_ptr<Lane[], Free> data_;
  std::size_t capacity_ = 0;
};

/// Fields of the nodes of the active blocks. Within a block the first axis runs fastest.
template <int Dim>
class NodeFields {
 public:
  /// Makes room for the active blocks; the contents are undefined until the first collect.
  void resize(const Blocks<Dim>& blocks, int reach);

  /// {m, m vx, m vy, (m vz)} [kg, kg m/s]
  Lane* momentum(std::size_t node_block) { return momentum_.data() + node_block * block_nodes<Dim>; }
  /// {0, fx, fy, (fz)} [N]: components stand where those of the momentum do
  Lane* force(std::size_t node_block) { return force_.data() + node_block * block_nodes<Dim>; }
  /// New velocity and its change in this step [m/s]; see motion_lanes.
  Lane* motion(std::size_t node_block) {
    return motion_.data() + node_block * block_nodes<Dim> * static_cast<std::size_t>(motion_lanes<Dim>);
  }

  /// The tile of a particle block, tile_width^Dim lanes.
  Lane* momentum_tile(std::size_t block) { return momentum_tiles_.data() + block * tile_size_; }
  Lane* force_tile(std::size_t block) { return force_tiles_.data() + block * tile_size_; }
  std::size_t tile_size() const { return tile_size_; }

  /// Sums the tiles around a node block into its nodes, always in the same order.
  void collect_momentum(const Blocks<Dim>& blocks, std::size_t node_block);
  void collect_force(const Blocks<Dim>& blocks, std::size_t node_block);
  /// Adds the force tiles to the forces that the nodes have.
  void add_force(const Blocks<Dim>& blocks, std::size_t node_block);

  /// Copies the motion of the nodes under a particle block's tile to `tile` (tile_size * motion_lanes lanes).
  void load_motion(const Blocks<Dim>& blocks, std::size_t block, Lane* tile) const;

 private:
  void collect(const Blocks<Dim>& blocks, std::size_t node_block, const LaneArray& tiles, Lane* nodes) const;

  LaneArray momentum_, force_, motion_, momentum_tiles_, force_tiles_;
  std::size_t tile_size_ = 0;
  int tile_width_ = 0;
};

extern template class NodeFields<2>;
extern template class NodeFields<3>;

}  // namespace sluice
