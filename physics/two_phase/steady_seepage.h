/// Steady seepage: the pressure of water that flows through soil at rest, with the surface below which the soil is wet.
/// docs/theory.md, section 9, eqs. (56)-(58).
#pragma once

#include <vector>

#include "physics/loads/external_pressure.h"
#include "physics/two_phase/pressure_equation.h"
#include "physics/two_phase/water.h"

namespace sluice {

struct SteadySeepage {
  std::vector<double> pressure;  ///< at the vertices of the grid [Pa]; negative above the surface of the water
  double discharge = 0;          ///< water that enters, and leaves [m3/s]
  int iterations = 0;
};

/// Solves div(k_r K (grad p - rho_w g)) = 0 on the cells that hold soil, k_r the share of a cell below the surface p =
/// 0: pressure where faces and ponds give it, no flow through the rest of the surface but outward where the pressure
/// would be positive (a seepage face). `sums` by cell; pushes are those of gravity. Surfaces of obstacles, of which
/// `open` knows, let nothing through.
/// `time` [s] is that of faces and ponds. Throws CaseError if nothing gives a pressure, or if it does not settle.
template <int Dim>
SteadySeepage solve_steady_seepage(const PressureGrid<Dim>& grid, const std::vector<CellSums<Dim>>& sums,
                                   const OpenCells<Dim>& open, const GridGeometry<Dim>& geometry,
                                   const WaterCase& water, const ExternalPressure<Dim>& outside, double unit_weight,
                                   double time);

}  // namespace sluice
