#include "physics/loads/external_pressure.h"

#include <algorithm>

#include "core/case/case_schema.h"
#include "core/grid/nodes.h"

namespace sluice {

namespace {

/// 1 in the region, going to 0 linearly over `fade` outside of it.
template <int Dim>
double share(const std::optional<Region>& region, double fade, const Vector<Dim>& x) {
  if (!region || region->contains(x)) return 1;
  return fade > 0 ? std::max(0.0, 1 - region->distance_outside(x) / fade) : 0;
}

/// Pressure of a liquid of this level and unit weight.
template <int Dim>
double hydrostatic(const Table& level, double unit_weight, const Vector<Dim>& x, double t) {
  return unit_weight * std::max(0.0, level.at(t) - x[Dim - 1]);
}

template <class T>
Schema<T>& with_place(Schema<T>& schema) {
  return schema.section("region", &T::region, region_schema(), "Where it acts: one shape.", Absent{"everywhere"})
      .quantity("fade", &T::fade, unit::length, at_least(0),
                "Distance outside of the region over which the pressure goes to zero. Where the region ends inside the "
                "material, let it fade over several cells.",
                0.0);
}

}  // namespace

const Schema<SurfaceLoad>& surface_load_schema() {
  static const Schema<SurfaceLoad> schema = [] {
    Schema<SurfaceLoad> declared("surface load");
    declared
        .table("pressure", &SurfaceLoad::pressure, unit::stress, any_number,
               "Pressure on the surface, in time: a value or points [[time, value], …]. Give this or `level`.")
        .table("level", &SurfaceLoad::level, unit::length, any_number,
               "Height along the last axis, in time, of a liquid that stands on the surface and does not enter the "
               "material: a reservoir. Needs gravity along the last axis.")
        .quantity("density", &SurfaceLoad::density, unit::density, above(0), "Of the liquid.", 1000);
    return with_place(declared);
  }();
  return schema;
}

FieldDoc surface_loads_doc() {
  return {.name = "surface_loads",
          .type = field_type::sections,
          .default_text = "none",
          .sentence = "Top-level section of the case: pressures on the surface of the material, with no water in them.",
          .nested = surface_load_schema().docs()};
}

const Schema<Pond>& pond_schema() {
  static const Schema<Pond> schema = [] {
    Schema<Pond> declared("pond");
    declared.table("level", &Pond::level, unit::length, any_number,
                   "Height of the water along the last axis, in time: a value or points [[time, value], …].");
    return with_place(declared);
  }();
  return schema;
}

namespace {

void check_load(const SurfaceLoad& load, const Node& section, Problems& problems) {
  const bool pressure = section.find("pressure") != nullptr, level = section.find("level") != nullptr;
  if (!pressure && !level)
    problems.add(section.place, "surface load: 'pressure' is missing, and so is 'level'; give one of them");
  if (pressure && level)
    problems.add(section.find("level")->place, "surface load: give `pressure` or `level`, not both");
  if (!level && section.find("density") != nullptr)
    problems.add(section.find("density")->place, "surface load: density belongs to a liquid; it needs `level`");
  if (level && load.unit_weight <= 0)
    problems.add(section.find("level")->place,
                 "surface load: a level needs gravity that points down along the last axis");
}

}  // namespace

std::vector<SurfaceLoad> read_surface_loads(const Case& definition) {
  const Node& section = definition.surface_loads;
  const int dimension = definition.dimension();
  std::vector<SurfaceLoad> loads;
  if (!section) return loads;
  if (section.kind != Node::Kind::list)
    throw CaseError(section.place, "surface_loads: found " + description(section) +
                                       "; expected a list of sections, each beginning with a dash");
  Problems problems;
  const double gravity = definition.gravity.empty() ? 0 : -definition.gravity.back();
  for (const Node& item : section.items) {
    SurfaceLoad load = surface_load_schema().read(item, {}, problems);
    load.unit_weight = load.density * gravity;
    if (item.kind == Node::Kind::map) check_load(load, item, problems);
    loads.push_back(std::move(load));
  }
  check_regions(loads, section, dimension, problems);
  problems.throw_if_any();
  return loads;
}

Node resolved_surface_loads(const std::vector<SurfaceLoad>& loads) {
  if (loads.empty()) return {};
  Node list = Node::list();
  for (const SurfaceLoad& load : loads) {
    const Node all = surface_load_schema().write(load);
    Node own = Node::map();
    for (std::size_t i = 0; i < all.items.size(); ++i)
      if (load.level || all.keys[i].first != "density") own.set(all.keys[i].first, all.items[i]);
    list.items.push_back(own);
  }
  return list;
}

template <int Dim>
ExternalPressure<Dim>::ExternalPressure(std::vector<SurfaceLoad> loads, std::vector<Pond> ponds, double unit_weight,
                                        const GridGeometry<Dim>& grid)
    : loads_(std::move(loads)), ponds_(std::move(ponds)), unit_weight_(unit_weight), grid_(grid) {}

template <int Dim>
double ExternalPressure<Dim>::of_ponds(const Vector<Dim>& x, double t) const {
  double sum = 0;
  for (const Pond& pond : ponds_)
    sum += hydrostatic<Dim>(pond.level, unit_weight_, x, t) * share<Dim>(pond.region, pond.fade, x);
  return sum;
}

template <int Dim>
double ExternalPressure<Dim>::at(const Vector<Dim>& x, double t) const {
  double sum = of_ponds(x, t);
  for (const SurfaceLoad& load : loads_) {
    const double here = load.pressure ? load.pressure->at(t) : hydrostatic<Dim>(*load.level, load.unit_weight, x, t);
    sum += here * share<Dim>(load.region, load.fade, x);
  }
  return sum;
}

template <int Dim>
void ExternalPressure<Dim>::load(const Index<Dim>& first_cell, double t, VertexTile<Dim>& tile, Of which) const {
  constexpr int width = tile_width<Dim>(1);
  for (std::size_t n = 0; n < tile.size(); ++n) {
    Index<Dim> place;
    for (int a = 0, rest = static_cast<int>(n); a < Dim; ++a, rest /= width)
      place[a] = first_cell[a] - tile_margin + rest % width;
    const Vector<Dim> x = grid_.vertex(grid_.wrapped(place));
    tile[n] = which == Of::all ? at(x, t) : of_ponds(x, t);
  }
}

template class ExternalPressure<2>;
template class ExternalPressure<3>;

}  // namespace sluice
