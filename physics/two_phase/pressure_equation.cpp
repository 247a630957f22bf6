#include "physics/two_phase/pressure_equation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/case/case_schema.h"
#include "core/parallel/multitarget.h"
#include "core/parallel/parallel.h"
#include "physics/two_phase/steady_seepage.h"

namespace sluice {

namespace {

/// A cell with less water than this has no coefficients of its own.
constexpr double least_fill = 0.05;
/// The surface is not found nearer to a vertex than this, in cells: keeps the system well conditioned.
constexpr double least_share = 0.05;
/// The pressure is continued beyond the surface as if that were no nearer to a vertex than this, in cells. A steeper
/// continuation would let a vertex at the surface move the particles outside more than its own equation knows.
constexpr double least_continued_share = 0.25;
/// Volume that may go astray in a cell in a step, as share of the cell.
constexpr double volume_tolerance = 1e-9;
constexpr std::size_t items_a_share = 256;

/// Calls body(i) for i < count in parallel, in shares of many items.
template <class Body>
void parallel_items(std::size_t count, const Body& body) {
  parallel_shares(count, items_a_share, [&](std::size_t begin, std::size_t end, std::size_t) {
    for (std::size_t i = begin; i < end; ++i) body(i);
  });
}

}  // namespace

template <int Dim>
PressureEquation<Dim>::PressureEquation(const WaterCase& water, const GridGeometry<Dim>& grid, double gravity)
    : water_(water), geometry_(grid), unit_weight_(-water.density * gravity), integrals_(grid), solver_(water.solver) {
  const auto names = face_words(Dim);
  for (std::size_t f = 0; f < names.size(); ++f) {
    const auto found = water.faces.find(names[f]);
    if (found != water.faces.end()) faces_[f] = &found->second;
  }
}

// ---- which cells take part ----

template <int Dim>
void PressureEquation<Dim>::prepare(const Scene<Dim>& scene, const std::vector<char>& wet) {
  wet_ = wet;
  const std::size_t blocks = scene.blocks.particle_blocks().size();
  // Dry blocks keep their zeros.
  cell_sums_.assign(blocks * cell_tile<Dim>, {});
  vertex_tiles_.resize(blocks * Grid::vertex_tile);
  std::fill_n(vertex_tiles_.data(), blocks * Grid::vertex_tile, Lane{});
  if (!grid_.empty()) grid_.locate(scene.blocks);
}

/// Whether all cells with water are in the set.
template <int Dim>
bool PressureEquation<Dim>::covered(const Scene<Dim>& scene) const {
  if (grid_.empty()) return false;
  for (std::size_t b = 0; b < scene.blocks.particle_blocks().size(); ++b) {
    if (!is_wet(b) || !grid_.has_gaps(b)) continue;
    const std::int32_t* const cell = grid_.cells_of_tile(b);
    for (std::size_t n = 0; n < cell_tile<Dim>; ++n)
      if (cell[n] < 0 && cell_sums_[b * cell_tile<Dim> + n].volume > 0) return false;
  }
  return true;
}

template <int Dim>
void PressureEquation<Dim>::rebuild(const Scene<Dim>& scene) {
  std::vector<Index<Dim>> places;
  for (std::size_t b = 0; b < scene.blocks.particle_blocks().size(); ++b) {
    if (!is_wet(b)) continue;
    for (std::size_t n = 0; n < cell_tile<Dim>; ++n) {
      if (!(cell_sums_[b * cell_tile<Dim> + n].volume > 0)) continue;
      Index<Dim> place = scene.blocks.particle_blocks()[b].first_cell;
      for (int a = 0, rest = static_cast<int>(n); a < Dim; ++a, rest /= cell_tile_width<Dim>)
        place[a] += rest % cell_tile_width<Dim> - tile_margin;
      places.push_back(place);
    }
  }
  if (places.empty()) return;
  build(places);
  grid_.locate(scene.blocks);
}

template <int Dim>
void PressureEquation<Dim>::build(const std::vector<Index<Dim>>& wet_cells) {
  built_from_ = wet_cells;
  grid_.build(wet_cells, geometry_);
  const auto lattice = grid_.places();
  solver_.analyze(grid_.pattern(), nested_dissection<Dim>(lattice));
  change_.assign(grid_.vertices().size(), 0);
}

template <int Dim>
void PressureEquation<Dim>::store(Archive& archive) const {
  auto& cells = archive.integers["pressure_cells"];
  for (const auto& place : built_from_) cells.insert(cells.end(), place.begin(), place.end());
  const auto state = solver_.state();
  archive.reals["pressure_change"] = change_;
  archive.reals["pressure_factorized"] = state.factorized_values;
  archive.reals["pressure_counters"] = state.counters;
}

template <int Dim>
void PressureEquation<Dim>::restore(const Archive& archive) {
  const auto& cells = archive.integers.at("pressure_cells");
  std::vector<Index<Dim>> places(cells.size() / Dim);
  for (std::size_t i = 0; i < cells.size(); ++i) places[i / Dim][i % Dim] = static_cast<int>(cells[i]);
  if (places.empty()) return;
  build(places);
  change_ = archive.reals.at("pressure_change");
  solver_.restore({archive.reals.at("pressure_factorized"), archive.reals.at("pressure_counters")});
}

namespace {

/// Calls add(entry) for the entries of tiles that belong to one cell or vertex, in the order of the blocks.
template <std::size_t Most, class Add>
SLUICE_ALWAYS_INLINE void for_entries(const std::array<std::int32_t, Most>& entries, const Add& add) {
  for (const std::int32_t entry : entries) {
    if (entry < 0) return;
    add(static_cast<std::size_t>(entry));
  }
}

}  // namespace

template <int Dim>
void PressureEquation<Dim>::sum_cells() {
  sums_.resize(grid_.cells().size());
  parallel_items(sums_.size(), [&](std::size_t c) {
    CellSums<Dim> sum;
    for_entries(grid_.cell_entries(c), [&](std::size_t at) { sum.add(cell_sums_[at]); });
    sums_[c] = sum;
  });
}

template <int Dim>
Lane PressureEquation<Dim>::vertex_sum(std::size_t v) const {
  Lane sum{};
  for_entries(grid_.vertex_entries(v), [&](std::size_t at) { sum += vertex_tiles_.data()[at]; });
  return sum;
}

// ---- coefficients ----

/// Eqs. (44) and (47): what multiplies the Laplacian of the new and of the old pressure.
template <int Dim>
SLUICE_ALWAYS_INLINE typename PressureEquation<Dim>::CellState PressureEquation<Dim>::cell_state(
    const CellSums<Dim>& sums, const StepConstants& step) const {
  CellState cell;
  if (!(sums.volume > 0)) return cell;
  const double inverse = 1 / sums.volume, specific = sums.inverse_density * inverse;
  const double lightness = water_.density * specific;  // rho_w / rho
  const double inertial = step.kick * specific;
  cell.storage = sums.storage * inverse * step.corner_volume_per_dt;
  // At most as soft as a skeleton in which an elastic wave crosses a fiftieth of a cell.
  const double compliance = sums.compliance * inverse;
  cell.steadied = compliance > 0 ? inertial * step.steadied : 0;
  for (std::size_t a = 0; a < Dim; ++a) {
    const double mobility = sums.mobility[a] * inverse, push = sums.push[a] * inverse;
    const double projection = inertial + mobility * (1 - lightness);
    const double wanted = step.stabilised[a] * std::min(compliance, step.softest[a] * specific);
    // The acceleration in Darcy's law holds the old pressure; explicitly, that is unstable where rho < 2 rho_w and the
    // soil is coarse.
    const double lagged = (lightness - 0.4) * mobility - inertial;
    const double stabilisation = std::max(0.0, std::max(wanted - projection, lagged));
    const double implicit = projection + stabilisation;
    const double old = water_.increment * (projection - mobility) + stabilisation;
    for (std::size_t n = 0; n < Grid::corners; ++n) {
      cell.implicit[n] += implicit * integrals_.laplacian[a][n];
      cell.old[n] += old * integrals_.laplacian[a][n];
      cell.push[n] += push * integrals_.slope[a][n];
    }
  }
  return cell;
}

template <int Dim>
typename PressureEquation<Dim>::StepConstants PressureEquation<Dim>::constants(const PressureStep& step) const {
  const double corner_volume = geometry_.cell_volume() / Grid::corners;
  StepConstants constants{.kick = step.kick,
                          .corner_volume_per_dt = corner_volume / step.dt,
                          .steadied = step.stabilised ? 1.5 * corner_volume : 0};
  for (std::size_t a = 0; a < Dim; ++a) {
    const double h = geometry_.cell[a];
    constants.stabilised[a] = step.stabilised ? h * h / (4 * step.dt) : 0;
    constants.softest[a] = 2500 * step.dt * step.dt / (h * h);
  }
  return constants;
}

template <int Dim>
SLUICE_MULTITARGET void PressureEquation<Dim>::set_states(const StepConstants& step, std::size_t begin,
                                                          std::size_t end) {
  for (std::size_t c = begin; c < end; ++c) cells_[c] = cell_state(sums_[c], step);
}

/// A cell with little or no water beside a vertex that is inside takes the coefficients of the cells around it.
template <int Dim>
void PressureEquation<Dim>::set_cells(const PressureStep& step) {
  const double least = least_fill * geometry_.cell_volume();
  const StepConstants of_step = constants(step);
  cells_.resize(sums_.size());
  parallel_shares(cells_.size(), items_a_share, [&](std::size_t begin, std::size_t end, std::size_t) {
    set_states(of_step, begin, end);
    for (std::size_t c = begin; c < end; ++c) {
      if (sums_[c].volume >= least) continue;
      CellSums<Dim> sums = sums_[c];
      for (const std::int32_t v : grid_.cells()[c].vertex)
        for (const std::int32_t other : grid_.vertices()[static_cast<std::size_t>(v)].cell)
          if (other >= 0) sums.add(sums_[static_cast<std::size_t>(other)]);
      cells_[c] = cell_state(sums, of_step);
    }
  });
}

// ---- kinds of vertices ----

template <int Dim>
bool PressureEquation<Dim>::on_face(const Index<Dim>& place, int axis, int side) const {
  return place[axis] == (side == 0 ? 0 : geometry_.cells[axis]);
}

/// Sums of the vertices, and what they make of them. Inside is a vertex more than half of whose surroundings, in the
/// grid, are wet: on a flat surface, that lies below it.
template <int Dim>
void PressureEquation<Dim>::classify(const PressureStep& step) {
  const std::size_t count = grid_.vertices().size();
  const double g = unit_weight_;
  fill_.resize(count), kind_.resize(count), given_.resize(count), old_.resize(count), pressure_.resize(count);
  lanes_.resize(count);
  parallel_items(count, [&](std::size_t v) {
    const auto& vertex = grid_.vertices()[v];
    lanes_[v] = vertex_sum(v);
    const double volume = lanes_[v][0];
    fill_[v] = volume / (vertex.share * geometry_.cell_volume());
    kind_[v] = fill_[v] > 0.5 + 1e-6 ? Kind::inside : Kind::outside;
    old_[v] = volume > 0 ? lanes_[v][1] / volume : 0;
    if (kind_[v] == Kind::outside) return;
    for (int a = 0; a < Dim; ++a)
      for (int side = 0; side < 2; ++side) {
        const WaterFace* const face = faces_[static_cast<std::size_t>(2 * a + side)];
        if (face == nullptr || !on_face(vertex.place, a, side)) continue;
        const double head = face->head ? face->head->at(step.time) - geometry_.vertex(vertex.place)[Dim - 1] : 0;
        // Above its level, water leaves through the face where it has pressure: a seepage face.
        const bool seeps = face->head && head <= 0 && old_[v] > 0;
        if (face->pressure || head > 0 || seeps) {
          kind_[v] = Kind::given;
          given_[v] = face->pressure ? face->pressure->at(step.time) : g * std::max(0.0, head);
        }
      }
  });
}

// ---- the system ----

namespace {

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

}  // namespace

/// Written out for each place of the stencil when compiled: no branches, and sums in registers.
template <int Dim>
SLUICE_ALWAYS_INLINE typename PressureEquation<Dim>::Row PressureEquation<Dim>::row(
    const typename Grid::Vertex& vertex) const {
  static const CellState nothing{};
  std::array<const CellState*, Grid::corners> cell;
  for (std::size_t k = 0; k < Grid::corners; ++k)
    cell[k] = vertex.cell[k] >= 0 ? cells_.data() + vertex.cell[k] : &nothing;
  const auto coupling = [&]<std::size_t n>(const auto CellState::*kind) {
    double sum = 0;
    [&]<std::size_t... k>(std::index_sequence<k...>) {
      (
          [&] {
            constexpr int c = couplings_of_cells<Dim>[n][k];
            if constexpr (c >= 0) sum += (cell[k]->*kind)[static_cast<std::size_t>(c)];
          }(),
          ...);
    }
    (std::make_index_sequence<Grid::corners>());
    return sum;
  };
  Row row;
  [&]<std::size_t... n>(std::index_sequence<n...>) {
    ((row.implicit[n] = coupling.template operator()<n>(&CellState::implicit)), ...);
    ((row.old[n] = coupling.template operator()<n>(&CellState::old)), ...);
  }
  (std::make_index_sequence<Grid::stencil>());
  for (std::size_t k = 0; k < Grid::corners; ++k) {
    row.storage += cell[k]->storage;
    row.steadied += cell[k]->steadied;
    row.push += cell[k]->push[Grid::corners - 1 - k];
  }
  return row;
}

/// How unevenly particles lie around a vertex inside, eq. (47a): from the slopes of the fill, unless those are the
/// surface's [1/m2].
template <int Dim>
SLUICE_ALWAYS_INLINE double PressureEquation<Dim>::unevenness(std::size_t i) const {
  const auto& vertex = grid_.vertices()[i];
  double sum = 0;
  for (int a = 0, step = 1; a < Dim; ++a, step *= 3) {
    const double per_cell = 1 / geometry_.cell[a];
    for (const int side : {-step, step}) {
      const std::int32_t j = vertex.neighbour[static_cast<std::size_t>(Grid::centre + side)];
      if (j < 0 || kind_[static_cast<std::size_t>(j)] == Kind::outside) continue;
      const double slope = (fill_[static_cast<std::size_t>(j)] - fill_[i]) * per_cell;
      sum += 0.5 * slope * slope;
    }
  }
  return sum;
}

/// Where the fill passes one half between two vertices, linearly: the share of the line that is inside.
template <int Dim>
double PressureEquation<Dim>::surface_share(std::size_t inside, std::size_t neighbour) const {
  return std::clamp((fill_[inside] - 0.5) / (fill_[inside] - fill_[neighbour]), least_share, 1.0);
}

template <int Dim>
typename PressureEquation<Dim>::Crossing PressureEquation<Dim>::crossing(std::size_t inside, std::size_t neighbour,
                                                                         const ExternalPressure<Dim>& outside,
                                                                         double time) const {
  const double share = surface_share(inside, neighbour);
  if (!outside.any()) return {share, 0};
  const Vector<Dim> from = geometry_.vertex(grid_.vertices()[inside].place),
                    to = geometry_.vertex(grid_.vertices()[neighbour].place);
  Vector<Dim> x;
  for (int a = 0; a < Dim; ++a) x[a] = from[a] + share * (to[a] - from[a]);
  return {share, outside.of_ponds(x, time)};
}

/// Water that leaves through faces with a prescribed flux at a vertex [m3/s]. Where the water has an inertia of its
/// own, the share rho_w / rho of it moves with the mixture, whose nodes are free at such a face, and has been counted
/// there.
template <int Dim>
double PressureEquation<Dim>::face_flux(const typename Grid::Vertex& vertex, double time) const {
  double flux = 0;
  for (int a = 0; a < Dim; ++a)
    for (int side = 0; side < 2; ++side) {
      const WaterFace* const face = faces_[static_cast<std::size_t>(2 * a + side)];
      if (face == nullptr || !face->flux || !on_face(vertex.place, a, side)) continue;
      flux += face->flux->at(time) * Grid::area_on_face(vertex, geometry_, a);
    }
  if (flux == 0 || water_.formulation != Formulation::v_w_p) return flux;
  CellSums<Dim> around;
  for (const std::int32_t cell : vertex.cell)
    if (cell >= 0) around.add(sums_[static_cast<std::size_t>(cell)]);
  return around.volume > 0 ? flux * (1 - water_.density * around.inverse_density / around.volume) : flux;
}

/// Eqs. (46) and (48). A line that leaves the water is continued to the vertex outside by the straight line through the
/// surface (Gibou et al. 2002): it changes the diagonal only, so the matrix stays symmetric. Volume is balanced with
/// the same continuation: what expands around the vertex outside counts with the share that the pressure inside has in
/// the one there. So what a vertex balances is what it moves, and a step never feeds a motion that the next step wants
/// undone.
template <int Dim>
void PressureEquation<Dim>::write_row(std::size_t i, const Row& row, const ExternalPressure<Dim>& outside,
                                      double time) {
  const auto& vertex = grid_.vertices()[i];
  const double storage = row.storage + row.steadied * unevenness(i);
  double diagonal = row.implicit[Grid::centre] + storage;
  double right = row.push - face_flux(vertex, time) + (row.old[Grid::centre] + storage) * old_[i];
  double expansion = lanes_[i][2];
  bool at_surface = false;
  for (std::size_t n = 0; n < Grid::stencil; ++n) {
    if (n == Grid::centre || vertex.neighbour[n] < 0) continue;
    const auto j = static_cast<std::size_t>(vertex.neighbour[n]);
    const std::int32_t slot = vertex.slot[n];
    if (kind_[j] == Kind::inside) {
      if (slot >= 0) values_[static_cast<std::size_t>(slot)] = row.implicit[n];
      right += row.old[n] * old_[j];
      continue;
    }
    if (slot >= 0) values_[static_cast<std::size_t>(slot)] = 0;
    if (kind_[j] == Kind::given) {
      right += row.old[n] * old_[j] - row.implicit[n] * given_[j];
      continue;
    }
    at_surface = true;
    expansion += continuation(i, j, n) * lanes_[j][2];
    const Crossing c = crossing(i, j, outside, time);
    // With unequal permeabilities some couplings are positive; continuing those would take from the diagonal.
    const double share = row.implicit[n] < 0 ? c.share : 1;
    diagonal += row.implicit[n] * (1 - 1 / share);
    right += row.old[n] * (old_[i] * (1 - 1 / share) + c.pressure / share) - row.implicit[n] * c.pressure / share;
  }
  values_[static_cast<std::size_t>(vertex.slot[Grid::centre])] = diagonal;
  // Inside, particles that lie unevenly fill the surroundings of the vertex to more or less than the whole.
  right_side_[i] = right - (at_surface ? expansion : expansion / fill_[i]);
}

/// The same where all vertices around are inside and no face is near: nothing but the sums.
template <int Dim>
SLUICE_ALWAYS_INLINE void PressureEquation<Dim>::write_inner_row(std::size_t i, const Row& row) {
  const auto& vertex = grid_.vertices()[i];
  const double storage = row.storage + row.steadied * unevenness(i);
  double right = row.push + storage * old_[i];
  for (std::size_t n = 0; n < Grid::stencil; ++n)
    right += row.old[n] * old_[static_cast<std::size_t>(vertex.neighbour[n])];
  // The couplings with the vertices behind have places that follow each other.
  double* const values = values_.data() + vertex.slot[Grid::centre];
  for (std::size_t n = Grid::centre; n < Grid::stencil; ++n) values[n - Grid::centre] = row.implicit[n];
  values[0] += storage;
  right_side_[i] = right - lanes_[i][2] / fill_[i];
}

template <int Dim>
SLUICE_ALWAYS_INLINE bool PressureEquation<Dim>::is_inner(const typename Grid::Vertex& vertex) const {
  bool inner = vertex.share == 1;
  for (const std::int32_t j : vertex.neighbour) {
    inner = inner && j >= 0 && kind_[static_cast<std::size_t>(j)] == Kind::inside;
    if (!inner) return false;
  }
  return true;
}

template <int Dim>
void PressureEquation<Dim>::assemble(const ExternalPressure<Dim>& outside, const PressureStep& step) {
  const std::size_t count = grid_.vertices().size();
  values_.resize(grid_.pattern().row.size());
  right_side_.resize(count);
  parallel_shares(count, items_a_share,
                  [&](std::size_t begin, std::size_t end, std::size_t) { write_rows(begin, end, outside, step.time); });
}

template <int Dim>
SLUICE_MULTITARGET void PressureEquation<Dim>::write_rows(std::size_t begin, std::size_t end,
                                                          const ExternalPressure<Dim>& outside, double time) {
  for (std::size_t i = begin; i < end; ++i) {
    const auto& vertex = grid_.vertices()[i];
    const Row own = row(vertex);
    if (is_inner(vertex))
      write_inner_row(i, own);
    else if (kind_[i] == Kind::inside)
      write_row(i, own, outside, time);
    else
      write_own_equation(i, own);
  }
}

/// A vertex without an unknown: an equation of its own, of about the size of the others.
template <int Dim>
void PressureEquation<Dim>::write_own_equation(std::size_t i, const Row& row) {
  const auto& vertex = grid_.vertices()[i];
  for (const std::int32_t slot : vertex.slot)
    if (slot >= 0) values_[static_cast<std::size_t>(slot)] = 0;
  const double diagonal = row.implicit[Grid::centre] > 0 ? row.implicit[Grid::centre] : 1;
  values_[static_cast<std::size_t>(vertex.slot[Grid::centre])] = diagonal;
  right_side_[i] = kind_[i] == Kind::given ? diagonal * given_[i] : 0;
}

template <int Dim>
void PressureEquation<Dim>::explain(const NotPositiveDefinite& error) const {
  const Vector<Dim> x = geometry_.vertex(grid_.vertices()[static_cast<std::size_t>(error.column())].place);
  std::string where = fmt::format("{:.4g}", x[0]);
  for (int a = 1; a < Dim; ++a) where += fmt::format(", {:.4g}", x[a]);
  throw CaseError(
      fmt::format("the pore pressure around ({}) m is not determined: this water is incompressible and closed in, with "
                  "no drained face and no free surface; give the water a bulk_modulus, or drain it",
                  where));
}

template <int Dim>
void PressureEquation<Dim>::solve_system(double dt) {
  const double largest = volume_tolerance * geometry_.cell_volume() / dt;
  try {
    report_ = solver_.solve(values_, right_side_, pressure_, largest);
  } catch (const NotPositiveDefinite& error) {
    explain(error);
  }
}

template <int Dim>
void PressureEquation<Dim>::solve(Scene<Dim>& scene, const ExternalPressure<Dim>& outside, const PressureStep& step) {
  {
    const auto timing = scene.clock.time(Stage::pressure_assembly);
    if (!covered(scene)) rebuild(scene);
    if (grid_.empty()) return;
    sum_cells();
    set_cells(step);
    classify(step);
    assemble(outside, step);
  }
  const auto timing = scene.clock.time(Stage::pressure_solve);
  // The pressure is guessed to change as it did in the last step.
  for (std::size_t v = 0; v < pressure_.size(); ++v)
    pressure_[v] = kind_[v] == Kind::inside ? old_[v] + change_[v] : kind_[v] == Kind::given ? given_[v] : 0;
  solve_system(step.dt);
  for (std::size_t v = 0; v < pressure_.size(); ++v) change_[v] = kind_[v] == Kind::inside ? pressure_[v] - old_[v] : 0;
  extrapolate(outside, step.time);
}

namespace {

/// Weight of the line to the place n of a stencil when lines meet: those along axes; where there are none, the others.
template <int Dim>
double line_weight(std::size_t n) {
  int steps = 0;
  for (int a = 0, rest = static_cast<int>(n); a < Dim; ++a, rest /= 3) steps += rest % 3 != 1 ? 1 : 0;
  return steps == 1 ? 1 : 1e-9;
}

}  // namespace

/// Of all lines that reach a vertex outside from vertices inside.
template <int Dim>
double PressureEquation<Dim>::line_weights(std::size_t j) const {
  double weight = 0;
  for (std::size_t n = 0; n < Grid::stencil; ++n) {
    const std::int32_t i = grid_.vertices()[j].neighbour[n];
    if (i >= 0 && kind_[static_cast<std::size_t>(i)] == Kind::inside) weight += line_weight<Dim>(n);
  }
  return weight;
}

/// Share of the pressure of vertex i in that of vertex j outside, which lies at place n of its stencil.
template <int Dim>
double PressureEquation<Dim>::continuation(std::size_t i, std::size_t j, std::size_t n) const {
  return line_weight<Dim>(n) / line_weights(j) * (1 - 1 / std::max(surface_share(i, j), least_continued_share));
}

/// Vertices outside continue the pressure through the surface, the mean over the lines that reach them.
template <int Dim>
void PressureEquation<Dim>::extrapolate(const ExternalPressure<Dim>& outside, double time) {
  parallel_items(kind_.size(), [&](std::size_t j) {
    if (kind_[j] != Kind::outside) return;
    const auto& vertex = grid_.vertices()[j];
    const double all_lines = line_weights(j);
    double sum = 0;
    for (std::size_t n = 0; n < Grid::stencil && all_lines > 0; ++n) {
      if (vertex.neighbour[n] < 0) continue;
      const auto i = static_cast<std::size_t>(vertex.neighbour[n]);
      if (kind_[i] != Kind::inside) continue;
      const double share = continuation(i, j, n), weight = line_weight<Dim>(n) / all_lines;
      sum += share * pressure_[i] + (weight - share) * crossing(i, j, outside, time).pressure;
    }
    pressure_[j] = all_lines > 0 ? sum : outside.of_ponds(geometry_.vertex(vertex.place), time);
  });
}

template <int Dim>
double PressureEquation<Dim>::solve_steady(Scene<Dim>& scene, const ExternalPressure<Dim>& outside) {
  if (!covered(scene)) rebuild(scene);
  if (grid_.empty()) return 0;
  sum_cells();
  SteadySeepage found = solve_steady_seepage(grid_, sums_, geometry_, water_, outside, unit_weight_, scene.time);
  pressure_ = std::move(found.pressure);
  return found.discharge;
}

template <int Dim>
void PressureEquation<Dim>::load(std::size_t block, Lane* tile) const {
  if (grid_.empty()) {
    std::fill_n(tile, Grid::vertex_tile * motion_lanes<Dim>, Lane{});
    return;
  }
  const std::int32_t* const vertex = grid_.vertices_of_tile(block);
  for (std::size_t n = 0; n < Grid::vertex_tile; ++n)
    tile[n * motion_lanes<Dim>] = Lane{vertex[n] >= 0 ? pressure_[static_cast<std::size_t>(vertex[n])] : 0, 0, 0, 0};
}

template class PressureEquation<2>;
template class PressureEquation<3>;

}  // namespace sluice
