/// Chunks: a batch of material points cut into pieces of a fixed number of lanes.
///
/// Every chunk is full: the last points of a batch are copied into a zero-filled chunk and back. Loops over lanes hence
/// have no remainder, each point goes through the same instructions, and its result depends neither on its neighbours
/// nor on where it stands in the batch, bit for bit.
#pragma once

#include <array>
#include <cstddef>

#include "core/parallel/multitarget.h"
#include "physics/materials/material.h"

namespace sluice {

/// Lanes of a chunk: a multiple of every vector length, and little enough to stay in the first cache.
inline constexpr int chunk_lanes = 16;

/// Before a loop over lanes: lanes are independent, and the loop stays a loop. Unrolled whole, the compiler may
/// contract a product and a sum in one lane and not in another, and a point's last bit would depend on its place.
#define SLUICE_LANE_LOOP _Pragma("GCC ivdep") _Pragma("GCC unroll 1")

/// Components of strain, stress and state of `chunk_lanes` points; see MaterialBatch.
template <int Dim, int States>
struct Chunk {
  std::array<const double*, symmetric_components<Dim>> strain_increment;
  std::array<double*, symmetric_components<Dim>> stress;
  std::array<double*, States> state;
};

/// The first `lanes` values of a column, followed by zeros. Written so that compilers make masked loads of it.
SLUICE_ALWAYS_INLINE double* pad(const double* column, int lanes, double* padded) {
#pragma GCC ivdep
  for (int i = 0; i < chunk_lanes; ++i) padded[i] = i < lanes ? column[i] : 0;
  return padded;
}

SLUICE_ALWAYS_INLINE void unpad(const double* padded, int lanes, double* column) {
#pragma GCC ivdep
  for (int i = 0; i < chunk_lanes; ++i) {
    if (i < lanes) column[i] = padded[i];
  }
}

/// Calls `body(chunk)` for each chunk of the batch. A chunk of zeros must be harmless to `body`.
template <int Dim, int States, class Body>
SLUICE_ALWAYS_INLINE void for_each_chunk(const MaterialBatch<Dim>& batch, const Body& body) {
  constexpr int components = symmetric_components<Dim>;
  alignas(64) double strain[components][chunk_lanes], stress[components][chunk_lanes], state[States + 1][chunk_lanes];
  for (std::size_t first = 0; first < batch.size; first += chunk_lanes) {
    const bool full = batch.size - first >= chunk_lanes;
    const int lanes = full ? chunk_lanes : static_cast<int>(batch.size - first);
    Chunk<Dim, States> chunk;
    for (int k = 0; k < components; ++k) {
      const double* const strain_column = batch.strain_increment[k] + first;
      double* const stress_column = batch.stress[k] + first;
      chunk.strain_increment[k] = full ? strain_column : pad(strain_column, lanes, strain[k]);
      chunk.stress[k] = full ? stress_column : pad(stress_column, lanes, stress[k]);
    }
    for (int k = 0; k < States; ++k) {
      chunk.state[k] = full ? batch.state[k] + first : pad(batch.state[k] + first, lanes, state[k]);
    }

    body(chunk);

    if (full) continue;
    for (int k = 0; k < components; ++k) unpad(stress[k], lanes, batch.stress[k] + first);
    for (int k = 0; k < States; ++k) unpad(state[k], lanes, batch.state[k] + first);
  }
}

}  // namespace sluice
