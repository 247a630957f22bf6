#include "physics/two_phase/steady_seepage.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/case/case_schema.h"
#include "physics/two_phase/corner_integrals.h"
#include "solvers/sparse_cholesky.h"

namespace sluice {

namespace {

constexpr double least_relative_permeability = 1e-4;
constexpr int most_iterations = 1000;
/// Soil fills the surroundings of a vertex that is not on its surface. Beside an obstacle points and surface fit less
/// well; a flat surface through a vertex leaves one half.
constexpr double full = 0.999, full_beside = 0.75;
constexpr double settled = 1e-3;   // largest difference between a relative permeability and that of the pressure
constexpr double positive = 1e-6;  // pressure that opens a seepage face, in heads of a cell

template <int Dim>
class Seepage {
 public:
  using Grid = PressureGrid<Dim>;
  Seepage(const Grid& grid, const std::vector<CellSums<Dim>>& sums, const OpenCells<Dim>& open,
          const GridGeometry<Dim>& geometry, const WaterCase& water, const ExternalPressure<Dim>& outside,
          double unit_weight, double time)
      : grid_(grid),
        sums_(sums),
        open_(open),
        geometry_(geometry),
        integrals_(geometry),
        head_of_cell_(unit_weight * geometry.cell[Dim - 1]),
        pressure_(grid.vertices().size(), 0),
        relative_(sums.size(), 1),
        kind_(grid.vertices().size(), Kind::closed),
        given_(grid.vertices().size(), 0),
        outflow_(grid.vertices().size(), 0) {
    for (std::size_t v = 0; v < kind_.size(); ++v) classify(v, water, outside, unit_weight, time);
  }

  SteadySeepage solve() {
    if (std::ranges::count(kind_, Kind::given) == 0)
      throw CaseError("water.initial: steady_seepage needs a pressure or head on a face, or a pond");
    start();
    const SymmetricPattern& pattern = grid_.pattern();
    SparseCholesky cholesky({.ordering = Ordering::nested_dissection});
    Eigen::SparseMatrix<double> matrix = empty(pattern);
    for (int n = 1; n <= most_iterations; ++n) {
      assemble(matrix);
      cholesky.factorize(matrix);
      const Eigen::VectorXd solution = cholesky.solve(right_);
      std::copy_n(solution.data(), pressure_.size(), pressure_.begin());
      const double change = follow_pressure(std::max(0.02, 1 / (1 + 0.1 * n)));
      const bool switched = update_seepage_faces();
      if (change < settled && !switched) return {pressure_, discharge(), n};
    }
    throw CaseError(fmt::format("water.initial: steady_seepage does not settle in {} iterations", most_iterations));
  }

 private:
  enum class Kind : char {
    none,    ///< touches no soil
    free,    ///< inside
    closed,  ///< on the surface, nothing flows
    open,    ///< on the surface, water leaves at zero pressure
    given
  };

  struct Room {
    double soil = 0, all = 0;  // [m^Dim]
  };
  Room room_of(const typename Grid::Vertex& vertex) const {
    Room room{0, vertex.share * Grid::corners * geometry_.cell_volume()};
    for (const std::int32_t c : vertex.cell) {
      if (c < 0) continue;
      room.soil += sums_[static_cast<std::size_t>(c)].volume;
      if (const OpenCell<Dim>* const cell = open_.of(static_cast<std::size_t>(c)))
        room.all += cell->volume() - geometry_.cell_volume();
    }
    return room;
  }

  double fill(std::size_t v) const {
    const auto& vertex = grid_.vertices()[v];
    Room room = room_of(vertex);
    if (room.soil > 0 && open_.any() && open_.leaves_little(vertex, geometry_))
      for (const std::int32_t other : vertex.neighbour) {
        if (other < 0) continue;
        const Room beside = room_of(grid_.vertices()[static_cast<std::size_t>(other)]);
        room.soil += beside.soil;
        room.all += beside.all;
      }
    return room.all > 0 ? room.soil / room.all : 0;
  }

  void classify(std::size_t v, const WaterCase& water, const ExternalPressure<Dim>& outside, double unit_weight,
                double time) {
    const auto& vertex = grid_.vertices()[v];
    const double share = fill(v);
    const bool beside_obstacle = open_.any() && open_.beside()[v] != 0;
    kind_[v] = share <= 0 ? Kind::none : share < (beside_obstacle ? full_beside : full) ? Kind::closed : Kind::free;
    if (share <= 0) return;
    const Vector<Dim> x = geometry_.vertex(vertex.place);
    if (kind_[v] == Kind::closed) {
      given_[v] = outside.of_ponds(x, time);
      if (given_[v] > 0) kind_[v] = Kind::given;
    }
    const auto names = face_words(Dim);
    for (int f = 0; f < 2 * Dim; ++f) {
      const auto face = water.faces.find(names[static_cast<std::size_t>(f)]);
      if (face == water.faces.end() || vertex.place[f / 2] != (f % 2 == 0 ? 0 : geometry_.cells[f / 2])) continue;
      const auto& [pressure, head, flux] = face->second;
      if (flux) outflow_[v] += flux->at(time) * Grid::area_on_face(vertex, geometry_, f / 2);
      const double below = head ? head->at(time) - x[Dim - 1] : 0;
      if (head && below <= 0) kind_[v] = Kind::closed;
      if (!pressure && below <= 0) continue;
      kind_[v] = Kind::given;
      given_[v] = pressure ? pressure->at(time) : unit_weight * below;
    }
  }

  /// Everything wet, at the mean of the given heads.
  void start() {
    double most = 0;
    for (std::size_t v = 0; v < kind_.size(); ++v)
      if (kind_[v] == Kind::given) most = std::max(most, given_[v]);
    for (std::size_t v = 0; v < kind_.size(); ++v) pressure_[v] = kind_[v] == Kind::given ? given_[v] : most;
  }

  Eigen::SparseMatrix<double> empty(const SymmetricPattern& pattern) const {
    return Eigen::Map<const Eigen::SparseMatrix<double>>(
        pattern.size(), pattern.size(), static_cast<Eigen::Index>(pattern.row.size()), pattern.column_begin.data(),
        pattern.row.data(), std::vector<double>(pattern.row.size(), 0).data());
  }

  /// The share of a cell that is wet, from the pressure in its middle: linear over the head of a cell. Water without
  /// weight has no surface.
  double wet_share(std::size_t c) const {
    if (!(head_of_cell_ > 0)) return 1;
    double mean = 0;
    for (const std::int32_t v : grid_.cells()[c].vertex) mean += pressure_[static_cast<std::size_t>(v)] / Grid::corners;
    return std::clamp(0.5 + mean / head_of_cell_, least_relative_permeability, 1.0);
  }

  bool fixed(std::size_t v) const { return kind_[v] == Kind::given || kind_[v] == Kind::open; }
  double value(std::size_t v) const { return kind_[v] == Kind::given ? given_[v] : 0; }

  /// A cell's part of (matrix) p = (right side): calls couple(m, n, coupling) and push(m, flow).
  template <class Couple, class Push>
  void for_cell(std::size_t c, const Couple& couple, const Push& push) const {
    if (!(sums_[c].volume > 0)) return;
    const OpenCell<Dim>* const part = open_.of(c);
    // A cell that an obstacle cuts has the mean of its particles, however few there are, in its open part.
    const double weight = relative_[c] / (part == nullptr ? geometry_.cell_volume() : sums_[c].volume);
    for (std::size_t m = 0; m < Grid::corners; ++m) {
      double flow = 0;
      for (std::size_t a = 0; a < Dim; ++a)
        flow += weight * sums_[c].push[a] * (part == nullptr ? integrals_.slope[a][m] : part->slope[a][m]);
      push(m, flow);
      for (std::size_t n = 0; n < Grid::corners; ++n) {
        double coupling = 0;
        for (std::size_t a = 0; a < Dim; ++a)
          coupling += weight * sums_[c].mobility[a] *
                      (part == nullptr ? integrals_.laplacian[a][m ^ n] : part->products[a][m][n]);
        couple(m, n, coupling);
      }
    }
  }

  void assemble(Eigen::SparseMatrix<double>& matrix) {
    matrix.coeffs().setZero();
    right_ = Eigen::VectorXd::Zero(matrix.rows());
    for (std::size_t c = 0; c < sums_.size(); ++c) {
      const auto at = [&](std::size_t m) { return static_cast<std::size_t>(grid_.cells()[c].vertex[m]); };
      for_cell(
          c,
          [&](std::size_t m, std::size_t n, double coupling) {
            const std::size_t i = at(m), j = at(n);
            if (fixed(i)) return;
            if (fixed(j))
              right_[static_cast<Eigen::Index>(i)] -= coupling * value(j);
            else if (i >= j)
              matrix.coeffRef(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) += coupling;
          },
          [&](std::size_t m, double flow) {
            if (!fixed(at(m))) right_[static_cast<Eigen::Index>(at(m))] += flow;
          });
    }
    for (std::size_t v = 0; v < kind_.size(); ++v) {
      if (!fixed(v) && kind_[v] != Kind::none) {
        right_[static_cast<Eigen::Index>(v)] -= outflow_[v];
        continue;
      }
      matrix.coeffRef(static_cast<Eigen::Index>(v), static_cast<Eigen::Index>(v)) = 1;
      right_[static_cast<Eigen::Index>(v)] = fixed(v) ? value(v) : 0;
    }
  }

  /// Relative permeabilities a part of the way to those of the pressure: all of it, they would swing to and fro.
  /// Returns the largest way.
  double follow_pressure(double part) {
    double largest = 0;
    for (std::size_t c = 0; c < sums_.size(); ++c) {
      const double way = wet_share(c) - relative_[c];
      if (sums_[c].volume > 0) largest = std::max(largest, std::abs(way));
      relative_[c] += part * way;
    }
    return largest;
  }

  /// Water that enters at each vertex, from the equations without boundary [m3/s].
  std::vector<double> inflow() const {
    std::vector<double> flow(pressure_.size(), 0);
    for (std::size_t c = 0; c < sums_.size(); ++c) {
      const auto at = [&](std::size_t m) { return static_cast<std::size_t>(grid_.cells()[c].vertex[m]); };
      for_cell(
          c, [&](std::size_t m, std::size_t n, double coupling) { flow[at(m)] += coupling * pressure_[at(n)]; },
          [&](std::size_t m, double push) { flow[at(m)] -= push; });
    }
    return flow;
  }

  /// Closed vertices with pressure open; open ones that water would enter close.
  bool update_seepage_faces() {
    const std::vector<double> flow = inflow();
    bool switched = false;
    for (std::size_t v = 0; v < kind_.size(); ++v) {
      const bool opens = kind_[v] == Kind::closed && pressure_[v] > positive * head_of_cell_;
      const bool closes = kind_[v] == Kind::open && flow[v] > 0;
      if (opens) kind_[v] = Kind::open;
      if (closes) kind_[v] = Kind::closed;
      switched = switched || opens || closes;
    }
    return switched;
  }

  double discharge() const {
    const std::vector<double> flow = inflow();
    double sum = 0;
    for (std::size_t v = 0; v < flow.size(); ++v) sum += std::max(0.0, fixed(v) ? flow[v] : -outflow_[v]);
    return sum;
  }

  const Grid& grid_;
  const std::vector<CellSums<Dim>>& sums_;
  const OpenCells<Dim>& open_;
  const GridGeometry<Dim>& geometry_;
  CornerIntegrals<Dim> integrals_;
  double head_of_cell_;
  std::vector<double> pressure_;
  std::vector<double> relative_;  // permeability of the cells
  std::vector<Kind> kind_;
  std::vector<double> given_;
  std::vector<double> outflow_;  // through faces with a flux [m3/s]
  Eigen::VectorXd right_;
};

}  // namespace

template <int Dim>
SteadySeepage solve_steady_seepage(const PressureGrid<Dim>& grid, const std::vector<CellSums<Dim>>& sums,
                                   const OpenCells<Dim>& open, const GridGeometry<Dim>& geometry,
                                   const WaterCase& water, const ExternalPressure<Dim>& outside, double unit_weight,
                                   double time) {
  return Seepage<Dim>(grid, sums, open, geometry, water, outside, unit_weight, time).solve();
}

#define SLUICE_INSTANTIATE(Dim)                                                                                       \
  template SteadySeepage solve_steady_seepage<Dim>(const PressureGrid<Dim>&, const std::vector<CellSums<Dim>>&,       \
                                                   const OpenCells<Dim>&, const GridGeometry<Dim>&, const WaterCase&, \
                                                   const ExternalPressure<Dim>&, double, double);
SLUICE_INSTANTIATE(2)
SLUICE_INSTANTIATE(3)
#undef SLUICE_INSTANTIATE

}  // namespace sluice
