/// PressureGrid: the vertices of cells at which the pore pressure lives, numbered, and how they are linked.
///
/// The set is larger than the wet part of the grid by a margin of some cells, so that it outlives many steps: the
/// pattern of the matrix, and with it the symbolic analysis, changes only when water comes to a cell beyond the margin.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/grid/blocks.h"
#include "core/grid/geometry.h"
#include "core/transfer/cell_tile.h"
#include "core/transfer/vertex_field.h"
#include "solvers/lagged_cholesky.h"

namespace sluice {

template <int Dim>
class PressureGrid {
 public:
  static constexpr int corners = power(2, Dim);  ///< of a cell; bit a of a corner's number: upper along axis a
  static constexpr int stencil = power(3, Dim);  ///< a vertex and those around it, first axis fastest
  static constexpr int centre = stencil / 2;

  struct Vertex {
    Index<Dim> place;
    std::array<std::int32_t, corners> cell;       ///< cell k has the vertex as its corner (corners - 1 - k); -1: none
    std::array<std::int32_t, stencil> neighbour;  ///< -1: none
    std::array<std::int32_t, stencil> slot;       ///< of the coupling in the matrix; -1: above the diagonal, or none
    double share;                                 ///< of the cells around it, that lie in the grid
  };
  struct Cell {
    Index<Dim> place;
    std::array<std::int32_t, corners> vertex;
  };
  /// Where the tiles of blocks hold the sums that belong to one cell or vertex. Where there are fewer: -1 for cells,
  /// the place behind all tiles for vertices.
  using Entries = std::array<std::int32_t, corners>;

  /// The part of a face of the grid, normal to an axis, that belongs to a vertex on it [m^(Dim-1)].
  static double area_on_face(const Vertex& vertex, const GridGeometry<Dim>& grid, int axis) {
    return 2 * vertex.share * grid.cell_volume() / grid.cell[axis];
  }

  /// Numbers the vertices of the cells in `wet`, which is not empty, and those within the margin.
  void build(const std::vector<Index<Dim>>& wet, const GridGeometry<Dim>& grid);
  /// Links cells and vertices to the tiles of the blocks, after these have changed.
  void locate(const Blocks<Dim>& blocks);

  bool empty() const { return vertices_.empty(); }
  const std::vector<Vertex>& vertices() const { return vertices_; }
  /// Behind the last vertex of the run that vertex i belongs to: consecutive vertices along the first axis with all
  /// their neighbours, none of them across the seam of a periodic axis, so that cells, neighbours and slots follow each
  /// other as the vertices do. i itself if there is no run.
  std::size_t run_end(std::size_t i) const { return run_end_[i]; }
  const std::vector<Cell>& cells() const { return cells_; }
  const Entries& cell_entries(std::size_t cell) const { return cell_entries_[cell]; }
  const Entries& vertex_entries(std::size_t vertex) const { return vertex_entries_[vertex]; }
  /// By block and place in its tile: the cell or vertex there; -1 if it is not in the set.
  const std::int32_t* cells_of_tile(std::size_t block) const { return tile_cells_.data() + block * cell_tile<Dim>; }
  const std::int32_t* vertices_of_tile(std::size_t block) const {
    return tile_vertices_.data() + block * vertex_tile<Dim>;
  }

  /// Whether the tile of a block has cells beyond the set.
  bool has_gaps(std::size_t block) const { return has_gaps_[block] != 0; }

  const SymmetricPattern& pattern() const { return pattern_; }
  std::vector<std::array<int, Dim>> places() const;

 private:
  /// A box of integer places and the number that each has; -1: none.
  class Numbers {
   public:
    void cover(const Index<Dim>& low, const Index<Dim>& high);  ///< both belong to it
    std::int32_t& at(const Index<Dim>& place) { return number_[position(place)]; }
    std::int32_t find(const Index<Dim>& place) const;
    const Index<Dim>& low() const { return low_; }
    const Index<Dim>& high() const { return high_; }

   private:
    std::size_t position(const Index<Dim>& place) const;
    Index<Dim> low_{}, high_{};
    std::vector<std::int32_t> number_;
  };

  void number_cells(const std::vector<Index<Dim>>& wet);
  void number_vertices();
  void link_vertices();
  void make_pattern();
  void find_runs();

  GridGeometry<Dim> geometry_;
  Numbers cell_numbers_, vertex_numbers_;
  std::vector<Cell> cells_;
  std::vector<Vertex> vertices_;
  std::vector<std::size_t> run_end_;  // by vertex
  SymmetricPattern pattern_;
  std::vector<Entries> cell_entries_, vertex_entries_;
  std::vector<std::int32_t> tile_cells_, tile_vertices_;
  std::vector<char> has_gaps_;  // by block
};

extern template class PressureGrid<2>;
extern template class PressureGrid<3>;

}  // namespace sluice
