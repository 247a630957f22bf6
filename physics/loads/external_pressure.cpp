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
    declared.table("pressure", &SurfaceLoad::pressure, unit::stress, any_number,
                   "Pressure on the surface, in time: a value or points [[time, value], …].");
    return with_place(declared);
  }();
  return schema;
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

std::vector<SurfaceLoad> read_surface_loads(const Node& section, int dimension) {
  std::vector<SurfaceLoad> loads;
  if (!section) return loads;
  if (section.kind != Node::Kind::list)
    throw CaseError(section.place, "surface_loads: found " + description(section) +
                                       "; expected a list of sections, each beginning with a dash");
  Problems problems;
  for (const Node& item : section.items) loads.push_back(surface_load_schema().read(item, {}, problems));
  check_regions(loads, section, dimension, problems);
  problems.throw_if_any();
  return loads;
}

Node resolved_surface_loads(const std::vector<SurfaceLoad>& loads) {
  if (loads.empty()) return {};
  Node list = Node::list();
  for (const SurfaceLoad& load : loads) list.items.push_back(surface_load_schema().write(load));
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
    sum += unit_weight_ * std::max(0.0, pond.level.at(t) - x[Dim - 1]) * share<Dim>(pond.region, pond.fade, x);
  return sum;
}

template <int Dim>
double ExternalPressure<Dim>::at(const Vector<Dim>& x, double t) const {
  double sum = of_ponds(x, t);
  for (const SurfaceLoad& load : loads_) sum += load.pressure.at(t) * share<Dim>(load.region, load.fade, x);
  return sum;
}

template <int Dim>
void ExternalPressure<Dim>::load(const Index<Dim>& first_cell, double t, Lane* tile) const {
  constexpr int width = tile_width<Dim>(1);
  for (int n = 0; n < power(width, Dim); ++n) {
    Index<Dim> place;
    for (int a = 0, rest = n; a < Dim; ++a, rest /= width) place[a] = first_cell[a] - tile_margin + rest % width;
    tile[n * motion_lanes<Dim>] = Lane{at(grid_.vertex(place), t), 0, 0, 0};
  }
}

template class ExternalPressure<2>;
template class ExternalPressure<3>;

}  // namespace sluice
