#include "physics/two_phase/open_cells.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace sluice {

namespace {

constexpr int samples = 4;  // along each axis of a cell

/// The part of a box that lies outside of a surface at this distance from its centre, as if the surface were plane and
/// the box as long as it looks along the normal: exact where the normal is an axis.
template <int Dim>
double open_share(const SignedDistance& from, const Vector<Dim>& box) {
  double length = 0;
  for (int a = 0; a < Dim; ++a) length += std::abs(from.normal[static_cast<std::size_t>(a)]) * box[a];
  return length > 0 ? std::clamp(0.5 + from.distance / length, 0.0, 1.0) : (from.distance > 0 ? 1.0 : 0.0);
}

/// The functions of the corners in a small box of a cell, whose middle lies at `in_cell`, as share of the cell.
template <int Dim>
class InSample {
 public:
  InSample(const Vector<Dim>& in_cell, const Vector<Dim>& h) : in_cell_(in_cell), h_(h) {}

  double value(std::size_t m) const {
    return product(-1, [&](int a) { return here(m, a); });
  }
  double slope(std::size_t m, int axis) const {
    return sign(m, axis) / h_[axis] * product(axis, [&](int a) { return here(m, a); });
  }
  /// Mean of the product of two slopes, exact.
  double slopes(std::size_t m, std::size_t n, int axis) const {
    constexpr double variance = 1.0 / (12 * samples * samples);
    return sign(m, axis) * sign(n, axis) / (h_[axis] * h_[axis]) *
           product(axis, [&](int a) { return here(m, a) * here(n, a) + sign(m, a) * sign(n, a) * variance; });
  }

 private:
  static double sign(std::size_t m, int axis) { return (m >> axis & 1) != 0 ? 1 : -1; }
  double here(std::size_t m, int axis) const { return (m >> axis & 1) != 0 ? in_cell_[axis] : 1 - in_cell_[axis]; }
  template <class Factor>
  static double product(int without, const Factor& factor) {
    double all = 1;
    for (int a = 0; a < Dim; ++a)
      if (a != without) all *= factor(a);
    return all;
  }

  Vector<Dim> in_cell_, h_;
};

}  // namespace

template <int Dim>
double OpenCell<Dim>::volume() const {
  return std::accumulate(weight.begin(), weight.end(), 0.0);
}

template <int Dim>
void OpenCell<Dim>::add_whole(double share, const GridGeometry<Dim>& grid, const CornerIntegrals<Dim>& whole) {
  for (std::size_t m = 0; m < corners; ++m) {
    weight[m] += share * grid.cell_volume() / corners;
    for (std::size_t a = 0; a < Dim; ++a) {
      slope[a][m] += share * whole.slope[a][m];
      for (std::size_t n = 0; n < corners; ++n) products[a][m][n] += share * whole.laplacian[a][m ^ n];
    }
  }
}

template <int Dim>
OpenCell<Dim> OpenCells<Dim>::cut(const Obstacles<Dim>& obstacles, const Index<Dim>& cell,
                                  const GridGeometry<Dim>& geometry) const {
  OpenCell<Dim> open;
  Vector<Dim> box;
  for (int a = 0; a < Dim; ++a) box[a] = geometry.cell[a] / samples;
  const double volume = geometry.cell_volume() / power(samples, Dim);
  for (int s = 0; s < power(samples, Dim); ++s) {
    Vector<Dim> in_cell, x;
    for (int a = 0, rest = s; a < Dim; ++a, rest /= samples) {
      in_cell[a] = (rest % samples + 0.5) / samples;
      x[a] = geometry.min[a] + (cell[a] + in_cell[a]) * geometry.cell[a];
    }
    const double weight = volume * open_share<Dim>(obstacles.nearest(x), box);
    if (!(weight > 0)) continue;
    const InSample<Dim> sample(in_cell, geometry.cell);
    for (std::size_t m = 0; m < OpenCell<Dim>::corners; ++m) {
      open.weight[m] += weight * sample.value(m);
      for (int a = 0; a < Dim; ++a) {
        const auto axis = static_cast<std::size_t>(a);
        open.slope[axis][m] += weight * sample.slope(m, a);
        for (std::size_t n = 0; n < OpenCell<Dim>::corners; ++n)
          open.products[axis][m][n] += weight * sample.slopes(m, n, a);
      }
    }
  }
  return open;
}

template <int Dim>
void OpenCells<Dim>::find(const Obstacles<Dim>& obstacles, const PressureGrid<Dim>& grid,
                          const GridGeometry<Dim>& geometry) {
  if (!obstacles.any() || version_ == obstacles.version()) return;
  version_ = obstacles.version();
  whole_weight_ = geometry.cell_volume() / OpenCell<Dim>::corners;
  number_.assign(grid.cells().size(), -1);
  cut_.clear();
  geometric_.clear();
  std::vector<char> contact;  // by cut cell
  for (std::size_t c = 0; c < grid.cells().size(); ++c) {
    const Index<Dim>& place = grid.cells()[c].place;
    const Vector<Dim> low = geometry.vertex(place);
    Vector<Dim> high, middle;
    for (int a = 0; a < Dim; ++a) {
      high[a] = low[a] + geometry.cell[a];
      middle[a] = 0.5 * (low[a] + high[a]);
    }
    if (!obstacles.reach(low, high)) continue;
    const ObstacleCase* whose = nullptr;
    if (open_share<Dim>(obstacles.nearest(middle, &whose), geometry.cell) >= 1) continue;
    contact.push_back(whose->surface.normal == FaceCase::Normal::contact ? 1 : 0);
    number_[c] = static_cast<std::int32_t>(cut_.size());
    cut_.push_back(c);
    geometric_.push_back(cut(obstacles, place, geometry));
  }
  mark_vertices(grid, contact);
}

template <int Dim>
void OpenCells<Dim>::mark_vertices(const PressureGrid<Dim>& grid, const std::vector<char>& contact) {
  const auto& vertices = grid.vertices();
  std::vector<char> touched(vertices.size(), 0);
  may_part_.assign(vertices.size(), 0);
  for (std::size_t k = 0; k < cut_.size(); ++k)
    for (const std::int32_t v : grid.cells()[cut_[k]].vertex) {
      touched[static_cast<std::size_t>(v)] = 1;
      if (contact[k] != 0) may_part_[static_cast<std::size_t>(v)] = 1;
    }
  beside_.assign(vertices.size(), 0);
  for (std::size_t v = 0; v < vertices.size(); ++v)
    for (const std::int32_t other : vertices[v].neighbour)
      if (other >= 0 && touched[static_cast<std::size_t>(other)] != 0) beside_[v] = 1;
}

template <int Dim>
void OpenCells<Dim>::make_room(std::span<const CellSums<Dim>> sums, const GridGeometry<Dim>& geometry,
                               const CornerIntegrals<Dim>& whole) {
  open_ = geometric_;
  for (std::size_t k = 0; k < cut_.size(); ++k) {
    const double excess = (sums[cut_[k]].volume - open_[k].volume()) / geometry.cell_volume();
    if (excess > 0) open_[k].add_whole(excess, geometry, whole);
  }
}

template <int Dim>
double OpenCells<Dim>::around(const typename PressureGrid<Dim>::Vertex& vertex,
                              const GridGeometry<Dim>& geometry) const {
  constexpr std::size_t corners = OpenCell<Dim>::corners;
  double sum = vertex.share * geometry.cell_volume();
  for (std::size_t k = 0; k < corners; ++k)
    if (vertex.cell[k] >= 0)
      if (const OpenCell<Dim>* const cell = of(static_cast<std::size_t>(vertex.cell[k])))
        sum += cell->weight[corners - 1 - k] - geometry.cell_volume() / corners;
  return sum;
}

template struct OpenCell<2>;
template struct OpenCell<3>;
template class OpenCells<2>;
template class OpenCells<3>;

}  // namespace sluice
