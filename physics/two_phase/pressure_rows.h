/// Rows of the pressure equation: what the cells around a vertex add up to. docs/theory.md, eqs. (46) and (47a).
#pragma once

#include <array>
#include <cstddef>

#include "core/grid/lane.h"
#include "physics/two_phase/cell_coefficients.h"
#include "physics/two_phase/corner_integrals.h"
#include "physics/two_phase/open_cells.h"
#include "physics/two_phase/pressure_grid.h"

namespace sluice {

/// Couplings of a vertex with those around it, by place in the stencil.
template <int Dim>
struct PressureRow {
  std::array<double, PressureGrid<Dim>::stencil> implicit{}, old{};
  double storage = 0, push = 0, steadied = 0;
};

template <int Dim>
PressureRow<Dim> pressure_row(const typename PressureGrid<Dim>::Vertex& vertex, const CellCoefficients<Dim>& cells,
                              const CornerIntegrals<Dim>& integrals, const OpenCells<Dim>& open);

/// What the rows of inner vertices are made of, and where they go.
template <int Dim>
struct InnerRows {
  const CellCoefficients<Dim>& cells;
  const CornerIntegrals<Dim>& integrals;
  Vector<Dim> cell_size;
  const double *fill, *old;  ///< by vertex: share of its surroundings that is wet; the old pressure
  const Lane* sums;          ///< by vertex: {V, V p, V div v}
  double *values, *right_side;
};

/// Rows of `count` vertices from number `first` on, which is `vertex`, of one run (PressureGrid::run_end), all with
/// nothing but vertices inside around them: no surface, no face and no obstacle is near.
template <int Dim>
void write_inner_rows(const typename PressureGrid<Dim>::Vertex& vertex, std::size_t first, std::size_t count,
                      const InnerRows<Dim>& rows);

}  // namespace sluice
