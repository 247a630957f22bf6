/// ExternalPressure: pressures on the surface of the material, from surface loads and ponded water.
///
/// The surface is never looked for. With any continuous field P(x, t) that has the wanted values on the surface, the
/// divergence theorem turns the traction -P n into volume terms (docs/theory.md, eqs. (33) and (34)):
///
///   -int_surface N P n dA = -int_volume P grad N dV - int_volume N grad P dV
///
/// so particles scatter the stress sigma + P and the body force -V grad P. On a wall the reaction changes by P.
#pragma once

#include <vector>

#include "core/case/case.h"
#include "core/case/consistency.h"
#include "core/case/geometry.h"
#include "core/case/schema.h"
#include "core/grid/geometry.h"
#include "core/transfer/vertex_field.h"

namespace sluice {

/// A pressure on whatever surface lies in a region: a given one, or that of a liquid which does not enter the pores.
struct SurfaceLoad {
  std::optional<Table> pressure;      ///< [Pa], pushes where positive
  std::optional<Region> region = {};  ///< absent: everywhere
  double fade = 0;                    ///< [m] outside of the region over which it goes to zero
  std::optional<Table> level = {};    ///< of a liquid, in the place of `pressure` [m] along the last axis
  double density = 1000;              ///< of the liquid [kg/m3]
  double unit_weight = 0;             ///< of the liquid, from its density and the gravity of the case [N/m3]
};

/// Water that stands on the soil.
struct Pond {
  Table level;                   ///< [m] along the last axis
  std::optional<Region> region;  ///< absent: everywhere
  double fade = 0;               ///< [m], as above
};

/// The section `surface_loads` of a case. Throws CaseError.
std::vector<SurfaceLoad> read_surface_loads(const Case& definition);
Node resolved_surface_loads(const std::vector<SurfaceLoad>& loads);
const Schema<SurfaceLoad>& surface_load_schema();
/// The section, for the reference of a physics module that reads it.
FieldDoc surface_loads_doc();
const Schema<Pond>& pond_schema();
/// Checks the regions of a list of loads or ponds against the dimension of the grid.
template <class T>
void check_regions(const std::vector<T>& items, const Node& section, int dimension, Problems& problems) {
  for (std::size_t i = 0; i < items.size(); ++i)
    if (items[i].region)
      check_region(*items[i].region, *section.items[i].find("region"), "region", static_cast<std::size_t>(dimension),
                   problems);
}

template <int Dim>
class ExternalPressure {
 public:
  /// `unit_weight` is that of the ponds' water [N/m3].
  ExternalPressure(std::vector<SurfaceLoad> loads, std::vector<Pond> ponds, double unit_weight,
                   const GridGeometry<Dim>& grid);

  bool any() const { return !loads_.empty() || !ponds_.empty(); }
  /// The whole pressure, and that of the ponds alone, which stands in the pores of the surface, too [Pa].
  double at(const Vector<Dim>& x, double t) const;
  double of_ponds(const Vector<Dim>& x, double t) const;
  /// The pressure at the vertices of the cells around a block.
  enum class Of { all, ponds };
  void load(const Index<Dim>& first_cell, double t, VertexTile<Dim>& tile, Of which = Of::all) const;
  bool any_ponds() const { return !ponds_.empty(); }

 private:
  std::vector<SurfaceLoad> loads_;
  std::vector<Pond> ponds_;
  double unit_weight_;
  GridGeometry<Dim> grid_;
};

}  // namespace sluice
