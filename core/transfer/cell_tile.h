/// The cells around a block: where in them particles lie. Written once for all sums over cells.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/grid/geometry.h"
#include "core/parallel/multitarget.h"
#include "core/transfer/shape_kernels.h"

namespace sluice {

/// The cells that the particles of a block may be in, per axis. The first axis runs fastest.
template <int Dim>
inline constexpr int cell_tile_width = block_width<Dim> + 2 * tile_margin;
template <int Dim>
inline constexpr std::size_t cell_tile = power(cell_tile_width<Dim>, Dim);

/// With `shift`, counted are not the cells but what they become when moved back by that share of a cell along each
/// axis, the first and the last cut by the walls; such a tile is wider by `wider`. For `count` particles from `begin`
/// on: writes the number that their cell has in the tile along one axis; points outside of the tile count to its rim.
/// With `InCell` also how far into the cell they are, as share of it.
template <int Dim, bool InCell, int wider = 0>
SLUICE_ALWAYS_INLINE void locate_in_tile(const BlockParticles<Dim>& block, int axis, std::uint32_t begin, int count,
                                         std::int32_t* __restrict number, double* __restrict in_cell,
                                         double shift = 0) {
  const double* __restrict x = block.position[axis] + begin;
  const double low = block.grid->min[axis], inverse = 1 / block.grid->cell[axis];
  const double last_cell = block.grid->cells[axis] - (shift > 0 ? 0 : 1);
  const double first = block.first_cell[axis] - tile_margin, rim = cell_tile_width<Dim> + wider - 1;
  for (int p = 0; p < count; ++p) {
    const double s = (x[p] - low) * inverse + shift;
    double cell = std::floor(s);
    cell = cell < last_cell ? cell : last_cell;
    cell = cell > 0 ? cell : 0;
    double local = cell - first;
    local = local > 0 ? local : 0;
    number[p] = static_cast<std::int32_t>(local < rim ? local : rim);
    if constexpr (InCell) in_cell[p] = s - cell;
  }
}

}  // namespace sluice
