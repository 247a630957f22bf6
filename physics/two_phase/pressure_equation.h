/// PressureEquation: the balance of volume of soil and water at the vertices of cells, solved for the pressure at the
/// end of the step. docs/theory.md, section 9, eqs. (40)-(48).
///
/// A step uses it so:
///   prepare(scene)                                  which cells and vertices take part
///   collect: in parallel over blocks, each fills its cell_sums(b) and vertex_sums(b)
///   solve(...)                                      assembles, imposes boundaries, solves, extrapolates
///   load(b, tile)                                   the new pressure at the vertices around a block
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "core/output/archive.h"
#include "core/simulation/scene.h"
#include "physics/loads/external_pressure.h"
#include "physics/two_phase/cell_coefficients.h"
#include "physics/two_phase/cell_sums.h"
#include "physics/two_phase/corner_integrals.h"
#include "physics/two_phase/open_cells.h"
#include "physics/two_phase/pressure_grid.h"
#include "physics/two_phase/pressure_rows.h"
#include "physics/two_phase/water.h"
#include "solvers/lagged_cholesky.h"

namespace sluice {

/// What the pressure has to do in a step.
struct PressureStep {
  double dt;    ///< time over which volume is balanced [s]
  double kick;  ///< time over which the pressure accelerates [s]
  double time;  ///< at the end of the step [s]
  bool stabilised;
  bool first;  ///< of the run: faces that absorb hold still
};

template <int Dim>
class PressureEquation {
 public:
  /// `gravity` is the component along the last axis [m/s2].
  PressureEquation(const WaterCase& water, const GridGeometry<Dim>& grid, double gravity);

  /// After blocks have changed: finds again where everything is. `wet` says which blocks hold water.
  void prepare(const Scene<Dim>& scene, const std::vector<char>& wet);
  bool is_wet(std::size_t block) const { return wet_[block] != 0; }

  CellSums<Dim>* cell_sums(std::size_t block) { return cell_sums_.data() + block * cell_tile<Dim>; }
  /// Lanes {V, V p, V div v, V (v away from an obstacle)} of linear shape functions.
  Lane* vertex_sums(std::size_t block) { return vertex_tiles_.data() + block * vertex_tile<Dim>; }

  /// To be called when both are complete: finds out whether all cells with water are known. Blocks side by side.
  void check_cover(std::size_t block);

  /// Throws CaseError if nothing holds the pressure of a closed region of incompressible water.
  void solve(Scene<Dim>& scene, const ExternalPressure<Dim>& outside, const PressureStep& step);

  /// The pressure of steady seepage, from sums collected at rest; returns the discharge [m3/s].
  double solve_steady(Scene<Dim>& scene, const ExternalPressure<Dim>& outside);

  /// The pressure at the vertices around a block.
  void load(std::size_t block, VertexTile<Dim>& tile) const;

  /// Of the last step.
  const LaggedCholesky::Report& report() const { return report_; }
  const LaggedCholeskyStatistics& statistics() const { return solver_.statistics(); }
  std::size_t unknowns() const { return grid_.vertices().size(); }

  void store(Archive& archive) const;
  void restore(const Archive& archive);

 private:
  using Grid = PressureGrid<Dim>;
  enum class Kind : char { outside, inside, given, closed };  ///< closed: within an obstacle, no water is near

  /// A face that lets waves out: the share of the pressure that it gives way to.
  struct AbsorbingFace {
    int axis, side;
    double impedance;  ///< rho c of what lies beyond [kg/(m2 s)]
    double depth;      ///< of the material that moves with the nodes of the face [m]
  };

  /// A line from a vertex inside to one outside, and where it crosses the surface.
  struct Crossing {
    double share;     ///< of the line that is inside
    double pressure;  ///< at the surface [Pa]
  };

  bool covered() const;
  void rebuild(const Scene<Dim>& scene);
  void build(const std::vector<Index<Dim>>& wet_cells);
  CellSums<Dim> cell_sum(std::size_t c) const;
  Lane vertex_sum(std::size_t v) const;
  void set_cells(const PressureStep& step);
  StepCoefficients<Dim> coefficients(const PressureStep& step) const;
  void classify(std::size_t v, double time);
  void classify_beside_obstacle(std::size_t v);
  double continued_old(std::size_t v) const;
  bool parts(std::size_t v) const;
  bool beside_obstacle(std::size_t v) const { return open_.any() && open_.beside()[v] != 0; }
  void find_absorbing_faces(const Scene<Dim>& scene);
  CellSums<Dim> sums_around(const typename Grid::Vertex& vertex) const;
  double give(const typename Grid::Vertex& vertex, double kick) const;
  void sum_up(double time);
  bool on_face(const Index<Dim>& place, int axis, int side) const;
  void assemble(const ExternalPressure<Dim>& outside, const PressureStep& step);
  void write_rows(std::size_t begin, std::size_t end, const ExternalPressure<Dim>& outside, const PressureStep& step);
  void guess(std::size_t begin, std::size_t end);
  void write_own_equation(std::size_t i);
  std::size_t inner_vertices(std::size_t i, std::size_t end) const;
  double unevenness(std::size_t i) const;
  void write_row(std::size_t i, const ExternalPressure<Dim>& outside, const PressureStep& step);
  double surface_share(std::size_t inside, std::size_t neighbour) const;
  Crossing crossing(std::size_t inside, std::size_t neighbour, const ExternalPressure<Dim>& outside, double time) const;
  double face_flux(const typename Grid::Vertex& vertex, double time) const;
  bool continues(std::size_t i) const;
  double line_weights(std::size_t j) const;
  double continuation(std::size_t i, std::size_t j, std::size_t n) const;
  void extrapolate(const ExternalPressure<Dim>& outside, double time);
  void solve_system(double dt);
  [[noreturn]] void explain(const NotPositiveDefinite& error) const;

  const WaterCase& water_;
  GridGeometry<Dim> geometry_;
  double unit_weight_;  // of the water [N/m3]
  CornerIntegrals<Dim> integrals_;
  std::array<const WaterFace*, 2 * Dim> faces_{};  ///< null: impermeable

  std::vector<AbsorbingFace> absorbing_;
  bool knows_absorbing_ = false;

  PressureGrid<Dim> grid_;
  OpenCells<Dim> open_;
  std::vector<Index<Dim>> built_from_;  // the wet cells of that time
  LaggedCholesky solver_;
  std::vector<char> wet_;          // by block
  std::vector<char> outside_set_;  // by block: whether it has water in cells beyond the set
  std::vector<CellSums<Dim>> cell_sums_;
  LaneArray vertex_tiles_;

  std::vector<CellSums<Dim>> sums_;  // by cell
  CellCoefficients<Dim> cells_;
  std::vector<Lane> lanes_;             // by vertex
  std::vector<double> fill_;            // by vertex: share of its surroundings that is wet
  std::vector<Kind> kind_;              // by vertex
  std::vector<char> little_;            // by vertex: an obstacle leaves little room; empty without obstacles
  std::vector<double> given_;           // by vertex [Pa]
  std::vector<double> old_, pressure_;  // by vertex [Pa]
  std::vector<double> change_;          // of the pressure in the last step, by vertex [Pa]
  std::vector<double> values_, right_side_;
  LaggedCholesky::Report report_;
};

extern template class PressureEquation<2>;
extern template class PressureEquation<3>;

}  // namespace sluice
