/// OpenCells: what obstacles leave of the cells of the pressure, whose integrals then go over the open part alone.
/// docs/theory.md, section 9.14.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/grid/geometry.h"
#include "core/grid/obstacles.h"
#include "physics/two_phase/cell_sums.h"
#include "physics/two_phase/corner_integrals.h"
#include "physics/two_phase/pressure_grid.h"

namespace sluice {

/// Integrals over the open part of a cell of the linear shape functions of its corners, and of their slopes.
template <int Dim>
struct OpenCell {
  static constexpr std::size_t corners = power(2, Dim);
  std::array<double, corners> weight{};                                          ///< of the functions [m^Dim]
  std::array<std::array<double, corners>, Dim> slope{};                          ///< [axis][m]: [m^(Dim-1)]
  std::array<std::array<std::array<double, corners>, corners>, Dim> products{};  ///< [axis][m][n]: [m^(Dim-2)]

  double volume() const;
  /// Adds so many times the integrals over the whole cell.
  void add_whole(double share, const GridGeometry<Dim>& grid, const CornerIntegrals<Dim>& whole);
};

template <int Dim>
class OpenCells {
 public:
  /// Finds them for the cells of a grid; does nothing while neither the grid nor the obstacles have changed.
  void find(const Obstacles<Dim>& obstacles, const PressureGrid<Dim>& grid, const GridGeometry<Dim>& geometry);
  /// After the grid has changed.
  void forget() { version_ = -1; }
  /// Where particles hold more water than an obstacle leaves room for, the cell is so much more open: what pushes
  /// there must be balanced there.
  void make_room(std::span<const CellSums<Dim>> sums, const GridGeometry<Dim>& geometry,
                 const CornerIntegrals<Dim>& whole);

  bool any() const { return !cut_.empty(); }
  /// Null: no obstacle takes anything of the cell.
  const OpenCell<Dim>* of(std::size_t cell) const {
    return number_.empty() || number_[cell] < 0 ? nullptr : &open_[static_cast<std::size_t>(number_[cell])];
  }
  /// Of a corner of a cell that is not cut [m^Dim].
  double whole_weight() const { return whole_weight_; }
  /// By vertex: 0 where no cell around it or around its neighbours is cut. Empty without obstacles.
  const std::vector<char>& beside() const { return beside_; }
  /// By vertex: whether an obstacle beside it holds only what comes towards it. Empty without obstacles.
  const std::vector<char>& may_part() const { return may_part_; }
  /// The open part of a vertex's surroundings: the integral of its shape function [m^Dim].
  double around(const typename PressureGrid<Dim>::Vertex& vertex, const GridGeometry<Dim>& geometry) const;
  /// Whether that is less than a quarter of what it would be without obstacles (half is the room of a vertex on a
  /// plane): few particles are in so little room, or none, and whether it is wet its neighbours know better.
  bool leaves_little(const typename PressureGrid<Dim>::Vertex& vertex, const GridGeometry<Dim>& geometry) const {
    return around(vertex, geometry) < 0.25 * vertex.share * geometry.cell_volume();
  }

 private:
  void mark_vertices(const PressureGrid<Dim>& grid, const std::vector<char>& contact);
  OpenCell<Dim> cut(const Obstacles<Dim>& obstacles, const Index<Dim>& cell, const GridGeometry<Dim>& geometry) const;

  std::int64_t version_ = -1;
  double whole_weight_ = 1;
  std::vector<std::int32_t> number_;  // by cell, in the following; -1: not cut
  std::vector<std::size_t> cut_;      // the cells
  std::vector<OpenCell<Dim>> geometric_, open_;
  std::vector<char> beside_, may_part_;
};

extern template class OpenCells<2>;
extern template class OpenCells<3>;

}  // namespace sluice
