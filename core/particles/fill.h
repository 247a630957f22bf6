/// Fills the bodies of a case with material points.
#pragma once

#include <functional>

#include "core/case/case.h"
#include "core/grid/geometry.h"
#include "core/particles/particles.h"

namespace sluice {

/// Puts points on the regular lattice of each cell (spacing cell / n for n^Dim points a cell, the first one half a
/// spacing from the cell's edge), where a body's region holds them. Sets position, velocity, volume, mass, id and
/// material; `density(material)` is in kg/m3. A point that two bodies hold belongs to the first if it lies on their
/// common edge, to the later if that replaces the former's material; otherwise the bodies overlap. Throws CaseError:
/// overlap, a body without
/// points, a raster without a height where it is needed, no points at all.
template <int Dim>
void fill_bodies(const Case& definition, const GridGeometry<Dim>& grid, const std::function<double(int)>& density,
                 Particles& particles);

}  // namespace sluice
