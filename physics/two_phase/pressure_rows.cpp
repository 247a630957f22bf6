#include "physics/two_phase/pressure_rows.h"

#include <algorithm>
#include <utility>

#include "core/parallel/multitarget.h"

namespace sluice {

namespace pressure_rows {

constexpr std::size_t chunk_size = 64;

/// [n][k]: which coupling of cell k around a vertex (m ^ n of its corners) is one with the vertex at place n of the
/// stencil; -1: that vertex is no corner of the cell.
template <int Dim>
constexpr auto couplings_of_cells = [] {
  constexpr std::size_t corners = power(2, Dim);
  std::array<std::array<int, corners>, power(3, Dim)> couplings{};
  for (auto& of_place : couplings) of_place.fill(-1);
  for (std::size_t k = 0; k < corners; ++k)
    for (std::size_t n = 0; n < corners; ++n) {
      const std::size_t m = corners - 1 - k;  // the corner that the vertex is
      std::size_t place = 0;
      for (int a = Dim - 1; a >= 0; --a) place = 3 * place + 1 + (n >> a & 1) - (m >> a & 1);
      couplings[place][k] = static_cast<int>(m ^ n);
    }
  return couplings;
}();

/// Calls body.operator()<i>() for i < count: written out when compiled.
template <std::size_t count, class Body>
SLUICE_ALWAYS_INLINE void unrolled(const Body& body) {
  [&]<std::size_t... i>(std::index_sequence<i...>) SLUICE_INLINE_LAMBDA { (body.template operator()<i>(), ...); }
  (std::make_index_sequence<count>());
}

/// Coupling with the vertex at place n; of(axis, k) is the coefficient of cell k.
template <int Dim, std::size_t n, class Of>
SLUICE_ALWAYS_INLINE double coupling(const CornerIntegrals<Dim>& integrals, const Of& of) {
  double sum = 0;
  unrolled<power(2, Dim)>([&]<std::size_t k>() SLUICE_INLINE_LAMBDA {
    constexpr int c = couplings_of_cells<Dim>[n][k];
    if constexpr (c >= 0)
      unrolled<Dim>([&]<std::size_t a>() SLUICE_INLINE_LAMBDA {
        sum += integrals.laplacian[a][static_cast<std::size_t>(c)] * of(a, k);
      });
  });
  return sum;
}

/// Columns of the cells around the first vertex of a run: [t] is that of the vertex t further on.
template <int Dim>
struct Around {
  static constexpr std::size_t corners = PressureGrid<Dim>::corners;
  using OfCells = std::array<const double*, corners>;
  std::array<OfCells, Dim> implicit, old, push;
  OfCells storage, steadied;

  Around(const typename PressureGrid<Dim>::Vertex& vertex, std::size_t from, const CellCoefficients<Dim>& cells) {
    for (std::size_t k = 0; k < corners; ++k) {
      const std::size_t cell = static_cast<std::size_t>(vertex.cell[k]) + from;
      for (std::size_t a = 0; a < Dim; ++a) {
        implicit[a][k] = cells.implicit[a].data() + cell;
        old[a][k] = cells.old[a].data() + cell;
        push[a][k] = cells.push[a].data() + cell;
      }
      storage[k] = cells.storage.data() + cell;
      steadied[k] = cells.steadied.data() + cell;
    }
  }
};

/// How unevenly particles lie around vertex t, eq. (47a): from the slopes of the fill [1/m2].
template <int Dim>
SLUICE_ALWAYS_INLINE double unevenness(const std::array<const double*, PressureGrid<Dim>::stencil>& fill,
                                       const Vector<Dim>& half_per_square, std::size_t t) {
  constexpr std::size_t centre = PressureGrid<Dim>::centre;
  const double here = fill[centre][t];
  double sum = 0;
  unrolled<Dim>([&]<std::size_t a>() SLUICE_INLINE_LAMBDA {
    constexpr std::size_t step = power(3, static_cast<int>(a));
    const double before = fill[centre - step][t] - here, behind = fill[centre + step][t] - here;
    sum += half_per_square[a] * (before * before + behind * behind);
  });
  return sum;
}

/// (Multi-target functions need external linkage: the linker chooses among their clones.)
template <int Dim>
SLUICE_MULTITARGET void write_chunk(const typename PressureGrid<Dim>::Vertex& vertex, std::size_t first,
                                    std::size_t from, std::size_t count, const InnerRows<Dim>& rows) {
  using Grid = PressureGrid<Dim>;
  constexpr std::size_t behind = Grid::stencil - Grid::centre;  // places from the vertex itself on
  const Around<Dim> around(vertex, from, rows.cells);
  const CornerIntegrals<Dim> integrals = rows.integrals;
  std::array<const double*, Grid::stencil> fill, old;
  for (std::size_t n = 0; n < Grid::stencil; ++n) {
    const std::size_t neighbour = static_cast<std::size_t>(vertex.neighbour[n]) + from;
    fill[n] = rows.fill + neighbour;
    old[n] = rows.old + neighbour;
  }
  Vector<Dim> half_per_square;
  for (int a = 0; a < Dim; ++a) half_per_square[a] = 0.5 / (rows.cell_size[a] * rows.cell_size[a]);
  alignas(64) double couplings[behind][chunk_size], right[chunk_size];
#pragma GCC ivdep
  for (std::size_t t = 0; t < count; ++t) {
    double storage = 0, steadied = 0, sum = 0;
    unrolled<Grid::corners>([&]<std::size_t k>() SLUICE_INLINE_LAMBDA {
      storage += around.storage[k][t];
      steadied += around.steadied[k][t];
      unrolled<Dim>([&]<std::size_t a>() SLUICE_INLINE_LAMBDA {
        sum += integrals.slope[a][Grid::corners - 1 - k] * around.push[a][k][t];
      });
    });
    storage += steadied * unevenness<Dim>(fill, half_per_square, t);
    unrolled<behind>([&]<std::size_t n>() SLUICE_INLINE_LAMBDA {
      couplings[n][t] = coupling<Dim, Grid::centre + n>(
          integrals, [&](std::size_t a, std::size_t k) SLUICE_INLINE_LAMBDA { return around.implicit[a][k][t]; });
    });
    couplings[0][t] += storage;
    sum += storage * old[Grid::centre][t];
    unrolled<Grid::stencil>([&]<std::size_t n>() SLUICE_INLINE_LAMBDA {
      sum += old[n][t] * coupling<Dim, n>(integrals, [&](std::size_t a, std::size_t k)
                                                         SLUICE_INLINE_LAMBDA { return around.old[a][k][t]; });
    });
    right[t] = sum;
  }
  // The couplings with the vertices behind have places that follow each other, and so have the rows of a run.
  double* const values = rows.values + static_cast<std::size_t>(vertex.slot[Grid::centre]) + from * behind;
  for (std::size_t t = 0; t < count; ++t) {
    for (std::size_t n = 0; n < behind; ++n) values[t * behind + n] = couplings[n][t];
    // Particles that lie unevenly fill the surroundings of a vertex to more or less than the whole.
    rows.right_side[first + from + t] = right[t] - rows.sums[first + from + t][2] / fill[Grid::centre][t];
  }
}

}  // namespace pressure_rows

template <int Dim>
PressureRow<Dim> pressure_row(const typename PressureGrid<Dim>::Vertex& vertex, const CellCoefficients<Dim>& cells,
                              const CornerIntegrals<Dim>& integrals, const OpenCells<Dim>& open) {
  using namespace pressure_rows;
  constexpr std::size_t corners = PressureGrid<Dim>::corners;
  PressureRow<Dim> row;
  for (std::size_t k = 0; k < corners; ++k) {
    if (vertex.cell[k] < 0) continue;
    const auto cell = static_cast<std::size_t>(vertex.cell[k]);
    const OpenCell<Dim>* const part = open.of(cell);
    const std::size_t m = corners - 1 - k;
    for (std::size_t n = 0; n < PressureGrid<Dim>::stencil; ++n) {
      const int c = couplings_of_cells<Dim>[n][k];
      if (c < 0) continue;
      const auto apart = static_cast<std::size_t>(c);
      for (std::size_t a = 0; a < Dim; ++a) {
        const double product = part == nullptr ? integrals.laplacian[a][apart] : part->products[a][m][m ^ apart];
        row.implicit[n] += product * cells.implicit[a][cell];
        row.old[n] += product * cells.old[a][cell];
      }
    }
    const double share = part == nullptr ? 1 : part->weight[m] / open.whole_weight();
    row.storage += share * cells.storage[cell];
    row.steadied += share * cells.steadied[cell];
    for (std::size_t a = 0; a < Dim; ++a)
      row.push += (part == nullptr ? integrals.slope[a][m] : part->slope[a][m]) * cells.push[a][cell];
  }
  return row;
}

template <int Dim>
void write_inner_rows(const typename PressureGrid<Dim>::Vertex& vertex, std::size_t first, std::size_t count,
                      const InnerRows<Dim>& rows) {
  using namespace pressure_rows;
  for (std::size_t from = 0; from < count; from += chunk_size)
    write_chunk<Dim>(vertex, first, from, std::min(chunk_size, count - from), rows);
}

#define SLUICE_INSTANTIATE(Dim)                                                                               \
  template PressureRow<Dim> pressure_row<Dim>(const PressureGrid<Dim>::Vertex&, const CellCoefficients<Dim>&, \
                                              const CornerIntegrals<Dim>&, const OpenCells<Dim>&);            \
  template void write_inner_rows<Dim>(const PressureGrid<Dim>::Vertex&, std::size_t, std::size_t, const InnerRows<Dim>&)
SLUICE_INSTANTIATE(2);
SLUICE_INSTANTIATE(3);
#undef SLUICE_INSTANTIATE

}  // namespace sluice
