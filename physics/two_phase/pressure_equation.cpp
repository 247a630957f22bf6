#include "physics/two_phase/pressure_equation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/case/case_schema.h"
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
constexpr double no_room = 1e-9;  // cells: round-off
/// A vertex to which obstacles leave little room follows with a share of a step's delay: water that an obstacle has
/// closed in has a pressure then.
constexpr double little_lag = 0.1;
/// A pressure that is less than this share of those around is none: particles bring zero back with some error.
constexpr double no_pressure = 1e-3;
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
  outside_set_.assign(blocks, 0);
  // One place more, which stays zero: where no further tile holds a part of a vertex.
  vertex_tiles_.resize(blocks * vertex_tile<Dim> + 1);
  std::fill_n(vertex_tiles_.data(), blocks * vertex_tile<Dim> + 1, Lane{});
  if (!grid_.empty()) grid_.locate(scene.blocks);
}

template <int Dim>
void PressureEquation<Dim>::check_cover(std::size_t b) {
  outside_set_[b] = 0;
  if (grid_.empty() || !grid_.has_gaps(b)) return;
  const std::int32_t* const cell = grid_.cells_of_tile(b);
  for (std::size_t n = 0; n < cell_tile<Dim>; ++n)
    if (cell[n] < 0 && cell_sums_[b * cell_tile<Dim> + n].volume > 0) outside_set_[b] = 1;
}

/// Whether all cells with water are in the set.
template <int Dim>
bool PressureEquation<Dim>::covered() const {
  return !grid_.empty() && std::ranges::all_of(outside_set_, [](char outside) { return outside == 0; });
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
      places.push_back(geometry_.wrapped(place));
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
  open_.forget();
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

template <int Dim>
CellSums<Dim> PressureEquation<Dim>::cell_sum(std::size_t c) const {
  CellSums<Dim> sum;
  for (const std::int32_t entry : grid_.cell_entries(c)) {
    if (entry < 0) break;
    sum.add(cell_sums_[static_cast<std::size_t>(entry)]);
  }
  return sum;
}

template <int Dim>
Lane PressureEquation<Dim>::vertex_sum(std::size_t v) const {
  Lane sum{};
  for (const std::int32_t at : grid_.vertex_entries(v)) sum += vertex_tiles_.data()[at];
  return sum;
}

// ---- coefficients ----

template <int Dim>
StepCoefficients<Dim> PressureEquation<Dim>::coefficients(const PressureStep& step) const {
  const double corner_volume = geometry_.cell_volume() / Grid::corners;
  StepCoefficients<Dim> of_step{.density = water_.density,
                                .increment = water_.increment,
                                .kick = step.kick,
                                .corner_volume_per_dt = corner_volume / step.dt,
                                .steadied = step.stabilised ? 1.5 * corner_volume : 0};
  for (std::size_t a = 0; a < Dim; ++a) {
    const double h = geometry_.cell[a];
    of_step.stabilised[a] = step.stabilised ? h * h / (4 * step.dt) : 0;
    of_step.softest[a] = 2500 * step.dt * step.dt / (h * h);
  }
  return of_step;
}

/// A cell with little or no water beside a vertex that is inside takes the coefficients of the cells around it.
template <int Dim>
void PressureEquation<Dim>::set_cells(const PressureStep& step) {
  const double least = least_fill * geometry_.cell_volume();
  const StepCoefficients<Dim> of_step = coefficients(step);
  cells_.resize(sums_.size());
  parallel_shares(sums_.size(), items_a_share, [&](std::size_t begin, std::size_t end, std::size_t) {
    cells_.set(begin, std::span(sums_).subspan(begin, end - begin), of_step);
    for (std::size_t c = begin; c < end; ++c) {
      if (sums_[c].volume >= least) continue;
      CellSums<Dim> sums = sums_[c];
      for (const std::int32_t v : grid_.cells()[c].vertex)
        for (const std::int32_t other : grid_.vertices()[static_cast<std::size_t>(v)].cell)
          if (other >= 0) sums.add(sums_[static_cast<std::size_t>(other)]);
      cells_.set(c, {&sums, 1}, of_step);
    }
  });
}

// ---- kinds of vertices ----

template <int Dim>
bool PressureEquation<Dim>::on_face(const Index<Dim>& place, int axis, int side) const {
  return place[axis] == (side == 0 ? 0 : geometry_.cells[axis]);
}

/// Sums of a vertex, and what they make of it. Inside is a vertex more than half of whose surroundings, in the grid,
/// are wet: on a flat surface, that lies below it.
template <int Dim>
void PressureEquation<Dim>::classify(std::size_t v, double time) {
  // Vertices of a run are not looked up: they have all their surroundings, and lie on no face.
  const bool in_run = grid_.run_end(v) > v;
  lanes_[v] = vertex_sum(v);
  const double volume = lanes_[v][0];
  fill_[v] = volume / ((in_run ? 1 : grid_.vertices()[v].share) * geometry_.cell_volume());
  kind_[v] = fill_[v] > 0.5 + 1e-6 ? Kind::inside : Kind::outside;
  old_[v] = volume > 0 ? lanes_[v][1] / volume : 0;
  if (beside_obstacle(v)) classify_beside_obstacle(v);
  if (in_run || kind_[v] != Kind::inside) return;
  const auto& vertex = grid_.vertices()[v];
  for (int a = 0; a < Dim; ++a)
    for (int side = 0; side < 2; ++side) {
      const WaterFace* const face = faces_[static_cast<std::size_t>(2 * a + side)];
      if (face == nullptr || !on_face(vertex.place, a, side)) continue;
      const double head = face->head ? face->head->at(time) - geometry_.vertex(vertex.place)[Dim - 1] : 0;
      // Above its level, water leaves through the face where it has pressure: a seepage face.
      const bool seeps = face->head && head <= 0 && old_[v] > 0;
      if (face->pressure || head > 0 || seeps) {
        kind_[v] = Kind::given;
        given_[v] = face->pressure ? face->pressure->at(time) : unit_weight_ * std::max(0.0, head);
      }
    }
}

/// What lies in an obstacle counts neither as water nor as missing water. A vertex with little room around it does not
/// know whether it is wet, and has its neighbours say so.
template <int Dim>
void PressureEquation<Dim>::classify_beside_obstacle(std::size_t v) {
  const auto& vertex = grid_.vertices()[v];
  const double room = open_.around(vertex, geometry_);
  if (room < no_room * geometry_.cell_volume()) {
    kind_[v] = Kind::closed;
    fill_[v] = 0;
    return;
  }
  double water = vertex_sum(v)[0], all = room;
  little_[v] = open_.leaves_little(vertex, geometry_) ? 1 : 0;
  if (little_[v] != 0)
    for (const std::int32_t other : vertex.neighbour) {
      if (other < 0) continue;
      water += vertex_sum(static_cast<std::size_t>(other))[0];
      all += open_.around(grid_.vertices()[static_cast<std::size_t>(other)], geometry_);
    }
  fill_[v] = water / all;
  kind_[v] = fill_[v] > 0.5 + 1e-6 ? Kind::inside : Kind::outside;
}

/// The old pressure at a vertex that no particle reaches: straight on along the lines of the grid.
template <int Dim>
double PressureEquation<Dim>::continued_old(std::size_t v) const {
  double sum = 0, weights = 0;
  for (std::size_t n = 0; n < Grid::stencil; ++n) {
    const std::int32_t next = n == Grid::centre ? -1 : grid_.vertices()[v].neighbour[n];
    if (next < 0 || !(lanes_[static_cast<std::size_t>(next)][0] > 0)) continue;
    const std::int32_t second = grid_.vertices()[static_cast<std::size_t>(next)].neighbour[n];
    const bool straight = second >= 0 && lanes_[static_cast<std::size_t>(second)][0] > 0;
    const double weight = straight ? 1 : 1e-9, here = old_[static_cast<std::size_t>(next)];
    sum += weight * (straight ? 2 * here - old_[static_cast<std::size_t>(second)] : here);
    weights += weight;
  }
  return weights > 0 ? sum / weights : 0;
}

/// Whether the material leaves a surface that does not hold it, with no pressure left between the two: it parts from
/// the surface then, rather than be sucked back.
template <int Dim>
bool PressureEquation<Dim>::parts(std::size_t v) const {
  if (open_.may_part()[v] == 0 || !(lanes_[v][3] > 0)) return false;
  double around = 0;
  for (const std::int32_t other : grid_.vertices()[v].neighbour)
    if (other >= 0) around = std::max(around, std::abs(old_[static_cast<std::size_t>(other)]));
  return old_[v] <= no_pressure * around;
}

/// All cells and vertices, those of like numbers by one thread: they lie together, and meet again in the rows.
template <int Dim>
void PressureEquation<Dim>::sum_up(double time) {
  const std::size_t cells = grid_.cells().size(), vertices = grid_.vertices().size();
  sums_.resize(cells);
  fill_.resize(vertices), kind_.resize(vertices), given_.resize(vertices);
  old_.resize(vertices), pressure_.resize(vertices), lanes_.resize(vertices);
  // With obstacles the vertices have to know what room the cells have.
  if (open_.any()) {
    parallel_items(cells, [&](std::size_t c) { sums_[c] = cell_sum(c); });
    open_.make_room(sums_, geometry_, integrals_);
    little_.assign(vertices, 0);
    parallel_items(vertices, [&](std::size_t v) { classify(v, time); });
    for (std::size_t v = 0; v < vertices; ++v) {
      if (kind_[v] == Kind::inside && !(lanes_[v][0] > 0)) old_[v] = continued_old(v);
      if (kind_[v] == Kind::inside && parts(v)) kind_[v] = Kind::given, given_[v] = 0;
    }
    return;
  }
  parallel_shares(std::max(cells, vertices), items_a_share, [&](std::size_t begin, std::size_t end, std::size_t) {
    for (std::size_t c = begin; c < std::min(end, cells); ++c) sums_[c] = cell_sum(c);
    for (std::size_t v = begin; v < std::min(end, vertices); ++v) classify(v, time);
  });
}

// ---- the system ----

/// How unevenly particles lie around a vertex inside, eq. (47a): from the slopes of the fill, unless those are the
/// surface's [1/m2].
template <int Dim>
double PressureEquation<Dim>::unevenness(std::size_t i) const {
  if (beside_obstacle(i)) return 0;  // there the gradient pushes, eq. (49a)
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

/// Where the fill passes one half between two vertices, linearly: the share of the line that is inside. All of it where
/// the surface is taken at whole vertices: a staircase.
template <int Dim>
double PressureEquation<Dim>::surface_share(std::size_t inside, std::size_t neighbour) const {
  if (!water_.surface_within_cells) return 1;
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
  for (int a = 0; a < Dim; ++a) x[a] = from[a] + share * geometry_.shortest(a, to[a] - from[a]);
  return {share, outside.of_ponds(x, time)};
}

template <int Dim>
CellSums<Dim> PressureEquation<Dim>::sums_around(const typename Grid::Vertex& vertex) const {
  CellSums<Dim> around;
  for (const std::int32_t cell : vertex.cell)
    if (cell >= 0) around.add(sums_[static_cast<std::size_t>(cell)]);
  return around;
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
  const CellSums<Dim> around = sums_around(vertex);
  return around.volume > 0 ? flux * (1 - water_.density * around.inverse_density / around.volume) : flux;
}

template <int Dim>
void PressureEquation<Dim>::find_absorbing_faces(const Scene<Dim>& scene) {
  if (std::exchange(knows_absorbing_, true)) return;
  constexpr int points = 8;
  for (int axis = 0; axis < Dim; ++axis)
    for (int side = 0; side < 2; ++side) {
      const FaceCase& face = scene.faces.face(axis, side);
      if (!face.absorbing) continue;
      std::array<double, domain_capacity<Dim>> domain{};
      scene.shape->fill_domain(geometry_, 0.5, domain);
      const double h = geometry_.cell[axis];
      double depth = 0;
      for (int k = 0; k < points; ++k) {
        Vector<Dim> x;
        for (int a = 0; a < Dim; ++a) x[a] = 0.5 * (geometry_.min[a] + geometry_.max[a]);
        const double from_face = (k + 0.5) / points * h;
        x[axis] = side == 0 ? geometry_.min[axis] + from_face : geometry_.max[axis] - from_face;
        const Stencil<Dim> s = scene.stencil(x, {domain.data(), static_cast<std::size_t>(scene.domain_components())});
        for (int n = 0; n < s.count; ++n)
          if (s.node[static_cast<std::size_t>(n)][axis] == scene.faces.wall_node(axis, side))
            depth += s.value[static_cast<std::size_t>(n)] * h / points;
      }
      absorbing_.push_back({axis, side, face.absorbing->density * face.absorbing->p_wave, depth});
    }
}

/// What a pressure on faces that let waves out makes them give way, times their area: eq. (49c) [m3/(s Pa)].
template <int Dim>
double PressureEquation<Dim>::give(const typename Grid::Vertex& vertex, double kick) const {
  double sum = 0;
  for (const AbsorbingFace& face : absorbing_) {
    if (!on_face(vertex.place, face.axis, face.side)) continue;
    const CellSums<Dim> around = sums_around(vertex);
    if (!(around.volume > 0)) continue;
    const double lightness = around.inverse_density / around.volume / face.depth;
    sum += kick * lightness / (1 + 0.5 * kick * face.impedance * lightness) *
           Grid::area_on_face(vertex, geometry_, face.axis);
  }
  return sum;
}

/// Eqs. (46) and (48). A line that leaves the water is continued to the vertex outside by the straight line through the
/// surface (Gibou et al. 2002): it changes the diagonal only, so the matrix stays symmetric. Volume is balanced with
/// the same continuation: what expands around the vertex outside counts with the share that the pressure inside has in
/// the one there. So what a vertex balances is what it moves, and a step never feeds a motion that the next step wants
/// undone.
template <int Dim>
void PressureEquation<Dim>::write_row(std::size_t i, const ExternalPressure<Dim>& outside, const PressureStep& step) {
  const auto& vertex = grid_.vertices()[i];
  const double time = step.time;
  const PressureRow<Dim> row = pressure_row<Dim>(vertex, cells_, integrals_, open_);
  const double lag = open_.any() && little_[i] != 0 ? little_lag * row.implicit[Grid::centre] : 0;
  const double storage = row.storage + row.steadied * unevenness(i) + lag;
  const double gives = step.first || absorbing_.empty() ? 0 : give(vertex, step.kick);
  double diagonal = row.implicit[Grid::centre] + storage + gives;
  double right =
      row.push - face_flux(vertex, time) + (row.old[Grid::centre] + storage + water_.increment * gives) * old_[i];
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
    if (kind_[j] == Kind::closed) continue;
    at_surface = true;
    if (continues(i)) expansion += continuation(i, j, n) * lanes_[j][2];
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

/// The pressure is guessed to change as it did in the last step.
template <int Dim>
void PressureEquation<Dim>::guess(std::size_t begin, std::size_t end) {
  for (std::size_t v = begin; v < end; ++v)
    pressure_[v] = kind_[v] == Kind::inside ? old_[v] + change_[v] : kind_[v] == Kind::given ? given_[v] : 0;
}

template <int Dim>
void PressureEquation<Dim>::assemble(const ExternalPressure<Dim>& outside, const PressureStep& step) {
  const std::size_t count = grid_.vertices().size();
  values_.resize(grid_.pattern().row.size());
  right_side_.resize(count);
  parallel_shares(count, items_a_share, [&](std::size_t begin, std::size_t end, std::size_t) {
    write_rows(begin, end, outside, step);
    guess(begin, end);
  });
}

/// Inner vertices of a run together, the others one by one.
template <int Dim>
void PressureEquation<Dim>::write_rows(std::size_t begin, std::size_t end, const ExternalPressure<Dim>& outside,
                                       const PressureStep& step) {
  const InnerRows<Dim> rows{cells_,      integrals_,    geometry_.cell, fill_.data(),
                            old_.data(), lanes_.data(), values_.data(), right_side_.data()};
  for (std::size_t i = begin; i < end;) {
    if (const std::size_t inner = inner_vertices(i, end); inner > 0) {
      write_inner_rows<Dim>(grid_.vertices()[i], i, inner, rows);
      i += inner;
      continue;
    }
    if (kind_[i] == Kind::inside)
      write_row(i, outside, step);
    else
      write_own_equation(i);
    ++i;
  }
}

namespace {

/// How many of `count` bytes, from the first on, are `wanted`: eight at a time.
template <class Byte>
std::size_t leading(const Byte* bytes, std::size_t count, Byte wanted) {
  static_assert(sizeof(Byte) == 1);
  const std::uint64_t eight_wanted = 0x0101010101010101u * static_cast<std::uint64_t>(wanted);
  std::size_t n = 0;
  for (std::uint64_t eight; n + 8 <= count; n += 8) {
    std::memcpy(&eight, bytes + n, 8);
    if (eight != eight_wanted) break;
  }
  while (n < count && bytes[n] == wanted) ++n;
  return n;
}

}  // namespace

/// How many of the run from i on, before `end`, have vertices inside around them and nothing else.
template <int Dim>
std::size_t PressureEquation<Dim>::inner_vertices(std::size_t i, std::size_t end) const {
  const std::size_t last = std::min(end, grid_.run_end(i));
  if (last <= i) return 0;
  std::size_t count = last - i;
  for (const std::int32_t neighbour : grid_.vertices()[i].neighbour)
    count = leading(kind_.data() + neighbour, count, Kind::inside);
  if (open_.any()) count = leading(open_.beside().data() + i, count, char{0});
  return count;
}

/// A vertex without an unknown: an equation of its own, of about the size of the others.
template <int Dim>
void PressureEquation<Dim>::write_own_equation(std::size_t i) {
  const auto& vertex = grid_.vertices()[i];
  for (const std::int32_t slot : vertex.slot)
    if (slot >= 0) values_[static_cast<std::size_t>(slot)] = 0;
  double diagonal = 0;
  for (const std::int32_t cell : vertex.cell)
    for (std::size_t a = 0; cell >= 0 && a < Dim; ++a)
      diagonal += integrals_.laplacian[a][0] * cells_.implicit[a][static_cast<std::size_t>(cell)];
  if (!(diagonal > 0)) diagonal = 1;
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
    if (!covered()) rebuild(scene);
    if (grid_.empty()) return;
    find_absorbing_faces(scene);
    open_.find(scene.obstacles, grid_, geometry_);
    sum_up(step.time);
    set_cells(step);
    assemble(outside, step);
  }
  const auto timing = scene.clock.time(Stage::pressure_solve);
  solve_system(step.dt);
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

/// Whether a vertex continues its pressure to those outside. One with little room does not: it would have to move all
/// that lies there.
template <int Dim>
bool PressureEquation<Dim>::continues(std::size_t i) const {
  return kind_[i] == Kind::inside && (!open_.any() || little_[i] == 0);
}

/// Of all lines that reach a vertex outside from vertices inside.
template <int Dim>
double PressureEquation<Dim>::line_weights(std::size_t j) const {
  double weight = 0;
  for (std::size_t n = 0; n < Grid::stencil; ++n) {
    const std::int32_t i = grid_.vertices()[j].neighbour[n];
    if (i >= 0 && continues(static_cast<std::size_t>(i))) weight += line_weight<Dim>(n);
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
    change_[j] = kind_[j] == Kind::inside ? pressure_[j] - old_[j] : 0;
    if (kind_[j] != Kind::outside) return;
    const auto& vertex = grid_.vertices()[j];
    const double all_lines = line_weights(j);
    double sum = 0;
    for (std::size_t n = 0; n < Grid::stencil && all_lines > 0; ++n) {
      if (vertex.neighbour[n] < 0) continue;
      const auto i = static_cast<std::size_t>(vertex.neighbour[n]);
      if (!continues(i)) continue;
      const double share = continuation(i, j, n), weight = line_weight<Dim>(n) / all_lines;
      sum += share * pressure_[i] + (weight - share) * crossing(i, j, outside, time).pressure;
    }
    pressure_[j] = all_lines > 0 ? sum : outside.of_ponds(geometry_.vertex(vertex.place), time);
  });
}

template <int Dim>
double PressureEquation<Dim>::solve_steady(Scene<Dim>& scene, const ExternalPressure<Dim>& outside) {
  if (!covered()) rebuild(scene);
  if (grid_.empty()) return 0;
  open_.find(scene.obstacles, grid_, geometry_);
  sum_up(scene.time);
  SteadySeepage found = solve_steady_seepage(grid_, sums_, open_, geometry_, water_, outside, unit_weight_, scene.time);
  pressure_ = std::move(found.pressure);
  return found.discharge;
}

template <int Dim>
void PressureEquation<Dim>::load(std::size_t block, VertexTile<Dim>& tile) const {
  if (grid_.empty()) {
    tile.fill(0);
    return;
  }
  const std::int32_t* const vertex = grid_.vertices_of_tile(block);
  for (std::size_t n = 0; n < tile.size(); ++n)
    tile[n] = vertex[n] >= 0 ? pressure_[static_cast<std::size_t>(vertex[n])] : 0;
}

template class PressureEquation<2>;
template class PressureEquation<3>;

}  // namespace sluice
