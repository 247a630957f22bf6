#include "core/transfer/vertex_field.h"

#include <algorithm>

#include "core/parallel/multitarget.h"
#include "core/transfer/cell_tile.h"

namespace sluice {

namespace vertex_field {

constexpr int chunk_size = 64;

struct InPlane {
  double value, dx, dy;  ///< differences over a cell
};

/// From the corners of a square, first axis fastest.
SLUICE_ALWAYS_INLINE InPlane in_plane(double c0, double c1, double c2, double c3, double x, double y) {
  const double below = c1 - c0, above = c3 - c2, dx = below + y * (above - below);
  const double dy = c2 - c0 + x * (above - below);
  return {c0 + x * below + y * dy, dx, dy};
}

/// (Multi-target functions need external linkage: the linker chooses among their clones.)
template <int Dim>
SLUICE_MULTITARGET void at_particles(const double* tile, const BlockParticles<Dim>& block,
                                     const FieldAtParticles<Dim>& out) {
  constexpr int corners = 1 << Dim, width = tile_width<Dim>(1);
  alignas(64) std::int32_t first[chunk_size], number[chunk_size];
  alignas(64) double in_cell[Dim][chunk_size], corner[corners][chunk_size];
  const double per_x = 1 / block.grid->cell[0], per_y = 1 / block.grid->cell[1], per_z = 1 / block.grid->cell[Dim - 1];
  for (std::uint32_t begin = block.begin; begin < block.end; begin += chunk_size) {
    const int count = static_cast<int>(std::min<std::uint32_t>(chunk_size, block.end - begin));
    std::fill_n(first, count, 0);
    for (int a = Dim - 1; a >= 0; --a) {
      locate_in_tile<Dim, true>(block, a, begin, count, number, in_cell[a]);
      for (int p = 0; p < count; ++p) first[p] = first[p] * width + number[p];
    }
    for (int n = 0; n < corners; ++n) {
      const double* const from = tile + n % 2 + (n / 2 % 2) * width + (n / 4) * width * width;
#pragma omp simd
      for (int p = 0; p < count; ++p) corner[n][p] = from[first[p]];
    }
    double* const value = out.value + begin;
    double *const along_x = out.gradient[0] + begin, *const along_y = out.gradient[1] + begin,
                  *const along_z = out.gradient[Dim - 1] + begin;
#pragma omp simd
    for (int p = 0; p < count; ++p) {
      const double x = in_cell[0][p], y = in_cell[1][p];
      InPlane at = in_plane(corner[0][p], corner[1][p], corner[2][p], corner[3][p], x, y);
      if constexpr (Dim == 3) {
        const double z = in_cell[2][p];
        const InPlane above = in_plane(corner[4][p], corner[5][p], corner[6][p], corner[7][p], x, y);
        along_z[p] = (above.value - at.value) * per_z;
        at = {at.value + z * (above.value - at.value), at.dx + z * (above.dx - at.dx), at.dy + z * (above.dy - at.dy)};
      }
      value[p] = at.value;
      along_x[p] = at.dx * per_x;
      along_y[p] = at.dy * per_y;
    }
  }
}

}  // namespace vertex_field

template <int Dim>
void interpolate(const VertexTile<Dim>& tile, const BlockParticles<Dim>& particles, const FieldAtParticles<Dim>& out) {
  vertex_field::at_particles<Dim>(tile.data(), particles, out);
}

template void interpolate<2>(const VertexTile<2>&, const BlockParticles<2>&, const FieldAtParticles<2>&);
template void interpolate<3>(const VertexTile<3>&, const BlockParticles<3>&, const FieldAtParticles<3>&);

}  // namespace sluice
