#include "core/transfer/cell_averages.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace sluice {

template <int Dim>
void CellAverages<Dim>::resize(const Blocks<Dim>& blocks) {
  tiles_.resize(blocks.particle_blocks().size() * tile_cells);
  const std::size_t particles = blocks.particle_blocks().empty() ? 0 : blocks.particle_blocks().back().end;
  cell_.resize(particles);
}

template <int Dim>
void CellAverages<Dim>::add(std::size_t number, const BlockParticles<Dim>& block, const double* weight,
                            const double* quantity) {
  Sums* tile = tiles_.data() + number * tile_cells;
  std::fill_n(tile, tile_cells, Sums{});
  for (std::uint32_t p = block.begin; p < block.end; ++p) {
    Vector<Dim> x;
    for (int a = 0; a < Dim; ++a) x[a] = block.position[a][p];
    const Index<Dim> cell = block.grid->cell_of(x);
    int place = 0;
    for (int a = Dim - 1; a >= 0; --a)
      place = place * width + std::clamp(cell[a] - block.first_cell[a] + tile_margin, 0, width - 1);
    cell_[p] = place;
    tile[place].weight += weight[p];
    tile[place].product += weight[p] * quantity[p - block.begin];
  }
}

template <int Dim>
void CellAverages<Dim>::mean(const Blocks<Dim>& blocks, std::size_t number, const BlockParticles<Dim>& block,
                             double* mean) const {
  constexpr int shift_in_cells = block_width<Dim>;
  const auto& own = blocks.particle_blocks()[number];
  const auto& around = blocks.node_blocks()[static_cast<std::size_t>(own.nodes[neighbourhood<Dim> / 2])].particles;
  std::array<Sums, tile_cells> sums{};
  for (int n = 0; n < neighbourhood<Dim>; ++n) {
    const std::int32_t other = around[static_cast<std::size_t>(n)];
    if (other < 0) continue;
    const Sums* tile = tiles_.data() + static_cast<std::size_t>(other) * tile_cells;
    for (std::size_t c = 0; c < tile_cells; ++c) {
      // Cell c of this tile in the tile of the neighbour, if it reaches there.
      int place = 0, stride = 1;
      bool reached = true;
      for (int a = 0, rest = static_cast<int>(c), shift = n; a < Dim; ++a, rest /= width, shift /= 3, stride *= width) {
        const int i = rest % width - shift_in_cells * (shift % 3 - 1);
        reached = reached && i >= 0 && i < width;
        place += i * stride;
      }
      if (!reached) continue;
      sums[c].weight += tile[place].weight;
      sums[c].product += tile[place].product;
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
