/// MainBody: the particles that hang together, without those that were thrown off.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/particles/particles.h"

namespace sluice {

/// Particles are binned to cells of the given size [m]; cells with particles that share a face, an edge or a corner
/// hang together; the main body is the set of cells that hang together and hold the most mass. Of equal ones it is the
/// one with the lowest particle id. `place` is a column with the positions: current or initial. Returns one value per
/// particle: 1 in the main body, 0 outside. Cost of order N.
std::vector<std::uint8_t> main_body(const Particles& particles, ColumnId place, std::span<const double> cell);

/// Largest place · direction [m] among the particles of the main body; not a number without particles.
double front_of_main_body(const Particles& particles, ColumnId place, std::span<const double> direction,
                          std::span<const double> cell);

}  // namespace sluice
