#include "core/transfer/cell_averages.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel/multitarget.h"

namespace sluice {

template <int Dim>
void CellAverages<Dim>::resize(const Blocks<Dim>& blocks) {
  tiles_.resize(blocks.particle_blocks().size() * tile_cells);
  const std::size_t particles = blocks.particle_blocks().empty() ? 0 : blocks.particle_blocks().back().end;
  cell_.resize(particles);
}

/// The cell of each particle of a block in the block's tile, first axis fastest; points outside of the tile count to
/// its rim.
template <int Dim>
SLUICE_MULTITARGET void locate_in_tile(const BlockParticles<Dim>& block, int width, std::int32_t* __restrict place) {
  const std::uint32_t count = block.end - block.begin;
  for (std::uint32_t p = 0; p < count; ++p) place[p] = 0;
  for (int a = Dim - 1; a >= 0; --a) {
    const double* __restrict x = block.position[a] + block.begin;
    const double low = block.grid->min[a], inverse = 1 / block.grid->cell[a], last_cell = block.grid->cells[a] - 1;
    const double first = block.first_cell[a] - tile_margin, rim = width - 1;
    for (std::uint32_t p = 0; p < count; ++p) {
      double cell = std::floor((x[p] - low) * inverse);
      cell = cell < last_cell ? cell : last_cell;
      double local = (cell > 0 ? cell : 0) - first;
      local = local > 0 ? local : 0;
      place[p] = place[p] * width + static_cast<std::int32_t>(local < rim ? local : rim);
    }
  }
}

template <int Dim>
void CellAverages<Dim>::locate(const BlockParticles<Dim>& block) {
  locate_in_tile<Dim>(block, width, cell_.data() + block.begin);
}

template <int Dim>
void CellAverages<Dim>::add(std::size_t number, const BlockParticles<Dim>& block, const double* weight,
                            const double* quantity) {
  Sums* tile = tiles_.data() + number * tile_cells;
  std::fill_n(tile, tile_cells, Sums{});
  const std::int32_t* const place = cell_.data() + block.begin;
  for (std::uint32_t p = 0; p < block.end - block.begin; ++p) {
    const double w = weight[block.begin + p];
    tile[place[p]].weight += w;
    tile[place[p]].product += w * quantity[p];
  }
}

namespace {

/// Cells [low, high) of a tile along one axis that the tile of a neighbour, `shift` blocks on, reaches too; cell i here
/// is cell i + offset there.
struct Reach {
  int low, high, offset;
  Reach(int tile, int block, int shift)
      : low(std::max(0, block * shift)), high(std::min(tile, tile + block * shift)), offset(-block * shift) {}
};

}  // namespace

template <int Dim>
void CellAverages<Dim>::mean(const Blocks<Dim>& blocks, std::size_t number, const BlockParticles<Dim>& block,
                             double* mean) const {
  const auto& own = blocks.particle_blocks()[number];
  const auto& around = blocks.node_blocks()[static_cast<std::size_t>(own.nodes[neighbourhood<Dim> / 2])].particles;
  std::array<Sums, tile_cells> sums{};
  for (int n = 0; n < neighbourhood<Dim>; ++n) {
    const std::int32_t other = around[static_cast<std::size_t>(n)];
    if (other < 0) continue;
    const Sums* tile = tiles_.data() + static_cast<std::size_t>(other) * tile_cells;
    const Reach x(width, block_width<Dim>, n % 3 - 1), y(width, block_width<Dim>, n / 3 % 3 - 1);
    const Reach z(Dim == 3 ? width : 1, block_width<Dim>, Dim == 3 ? n / 9 - 1 : 0);
    for (int k = z.low; k < z.high; ++k)
      for (int j = y.low; j < y.high; ++j) {
        const int row = (k * width + j) * width, row_there = ((k + z.offset) * width + j + y.offset) * width + x.offset;
        for (int i = x.low; i < x.high; ++i) {
          sums[static_cast<std::size_t>(row + i)].weight += tile[row_there + i].weight;
          sums[static_cast<std::size_t>(row + i)].product += tile[row_there + i].product;
        }
      }
  }
  for (std::uint32_t p = block.begin; p < block.end; ++p) {
    const Sums& s = sums[static_cast<std::size_t>(cell_[p])];
    mean[p - block.begin] = s.product / s.weight;
  }
}

template class CellAverages<2>;
template class CellAverages<3>;

}  // namespace sluice
