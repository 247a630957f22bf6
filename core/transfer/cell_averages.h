/// CellAverages: the volume-weighted mean of a particle quantity over each cell, for F-bar.
#pragma once

#include <vector>

#include "core/grid/blocks.h"
#include "core/grid/geometry.h"
#include "core/transfer/cell_tile.h"

namespace sluice {

/// Works block by block like the nodes do: `locate` before the particles move, then `clear` and `add` on all blocks,
/// then (after all are done) `mean` on all blocks. A particle may be up to tile_margin cells outside of its block.
template <int Dim>
class CellAverages {
 public:
  /// `shift` is ShapeKernels::node_shift: cells from node to node, of the grid or moved by half a cell.
  void resize(const Blocks<Dim>& blocks, double shift);

  /// Notes the cell of each particle of the block. A strain belongs to the place where it was gathered.
  void locate(const BlockParticles<Dim>& block);

  void clear(std::size_t number);
  /// Sums weight and weight * quantity over the particles of the block; `quantity` is indexed from 0 at its first
  /// particle.
  void add(std::size_t number, const BlockParticles<Dim>& block, const double* weight, const double* quantity);

  /// Writes the mean of each particle's cell to `mean`, indexed like `quantity`.
  void mean(const Blocks<Dim>& blocks, std::size_t number, const BlockParticles<Dim>& block, double* mean) const;

 private:
  struct Sums {
    double weight = 0, product = 0;
  };
  double shift_ = 0;
  std::vector<Sums> tiles_;
  std::vector<std::int32_t> cell_;  // of each particle, in the tile of its block
};

extern template class CellAverages<2>;
extern template class CellAverages<3>;

}  // namespace sluice
