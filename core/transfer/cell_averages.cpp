#include "core/transfer/cell_averages.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace sluice {

namespace {

/// Cells that are shifted by half of their size: one more in a tile.
constexpr int wider = 1;
template <int Dim>
constexpr int width = cell_tile_width<Dim> + wider;
template <int Dim>
constexpr std::size_t tile_size = power(width<Dim>, Dim);

}  // namespace

template <int Dim>
void CellAverages<Dim>::resize(const Blocks<Dim>& blocks, double shift) {
  shift_ = shift;
  tiles_.resize(blocks.particle_blocks().size() * tile_size<Dim>);
  const std::size_t particles = blocks.particle_blocks().empty() ? 0 : blocks.particle_blocks().back().end;
  cell_.resize(particles);
}

/// The place of the cell of each particle of a block in the block's tile. (Multi-target functions need external
/// linkage: the linker chooses among their clones.)
template <int Dim>
SLUICE_MULTITARGET void place_in_tile(const BlockParticles<Dim>& block, double shift, std::int32_t* __restrict place) {
  constexpr int chunk = 64;
  alignas(64) std::int32_t number[chunk];
  for (std::uint32_t begin = block.begin; begin < block.end; begin += chunk, place += chunk) {
    const int count = static_cast<int>(std::min<std::uint32_t>(chunk, block.end - begin));
    for (int p = 0; p < count; ++p) place[p] = 0;
    for (int a = Dim - 1; a >= 0; --a) {
      locate_in_tile<Dim, false, wider>(block, a, begin, count, number, nullptr, shift);
      for (int p = 0; p < count; ++p) place[p] = place[p] * width<Dim> + number[p];
    }
  }
}

template <int Dim>
void CellAverages<Dim>::locate(const BlockParticles<Dim>& block) {
  place_in_tile(block, shift_, cell_.data() + block.begin);
}

template <int Dim>
void CellAverages<Dim>::clear(std::size_t number) {
  std::fill_n(tiles_.data() + number * tile_size<Dim>, tile_size<Dim>, Sums{});
}

template <int Dim>
void CellAverages<Dim>::add(std::size_t number, const BlockParticles<Dim>& block, const double* weight,
                            const double* quantity) {
  Sums* tile = tiles_.data() + number * tile_size<Dim>;
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
  std::array<Sums, tile_size<Dim>> sums{};
  for (int n = 0; n < neighbourhood<Dim>; ++n) {
    const std::int32_t other = around[static_cast<std::size_t>(n)];
    if (other < 0) continue;
    const Sums* tile = tiles_.data() + static_cast<std::size_t>(other) * tile_size<Dim>;
    const Reach x(width<Dim>, block_width<Dim>, n % 3 - 1), y(width<Dim>, block_width<Dim>, n / 3 % 3 - 1);
    const Reach z(Dim == 3 ? width<Dim> : 1, block_width<Dim>, Dim == 3 ? n / 9 - 1 : 0);
    for (int k = z.low; k < z.high; ++k)
      for (int j = y.low; j < y.high; ++j) {
        const int row = (k * width<Dim> + j) * width<Dim>,
                  row_there = ((k + z.offset) * width<Dim> + j + y.offset) * width<Dim> + x.offset;
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
