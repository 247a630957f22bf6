/// A scalar field that is given at the vertices of the cells, and linear between them, at particles.
#pragma once

#include <array>
#include <cstddef>

#include "core/grid/geometry.h"
#include "core/transfer/shape_kernels.h"

namespace sluice {

/// Vertices of the cells that the particles of a block may be in, first axis fastest. The first is the lower corner of
/// the cell that lies tile_margin before the block's first one on every axis.
template <int Dim>
inline constexpr std::size_t vertex_tile = power(tile_width<Dim>(1), Dim);
template <int Dim>
using VertexTile = std::array<double, vertex_tile<Dim>>;

/// Where the field goes. Pointers are to whole columns.
template <int Dim>
struct FieldAtParticles {
  double* value;
  std::array<double*, Dim> gradient{};  ///< per metre
};

/// The field and its gradient at the particles of a block; points beyond the tile count to the cells at its rim.
template <int Dim>
void interpolate(const VertexTile<Dim>& tile, const BlockParticles<Dim>& particles, const FieldAtParticles<Dim>& out);

}  // namespace sluice
