#include "core/particles/fill.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace sluice {

namespace {

constexpr double on_edge = 1e-6;  // closer to a surface than this share of a cell counts as on it

/// A lattice point that some body has taken.
struct Claim {
  std::size_t body;
  std::int32_t material;
  Vector<3> x;
};

int points_per_axis(int particles_per_cell, int dimension) {
  return static_cast<int>(std::lround(std::pow(particles_per_cell, 1.0 / dimension)));
}

bool replaces(const BodyCase& body, const std::string& material) {
  return std::find(body.replaces.begin(), body.replaces.end(), material) != body.replaces.end();
}

/// The cells that the bounding box of a region touches: [low, high) on each axis.
template <int Dim>
std::array<Index<Dim>, 2> cells_around(const Region& region, const GridGeometry<Dim>& grid) {
  const auto bounds = region.bounds(Dim);
  std::array<Index<Dim>, 2> range;
  for (std::size_t a = 0; a < Dim; ++a) {
    const double low = std::floor((bounds[0][a] - grid.min[a]) / grid.cell[a]);
    const double high = std::ceil((bounds[1][a] - grid.min[a]) / grid.cell[a]);
    range[0][a] = static_cast<int>(std::clamp(low - 1, 0.0, double(grid.cells[a])));
    range[1][a] = static_cast<int>(std::clamp(high + 1, 0.0, double(grid.cells[a])));
  }
  return range;
}

/// Calls visit(x, number of the lattice point) for every lattice point of these cells, first axis fastest.
template <int Dim, class Visit>
void for_lattice_points(const std::array<Index<Dim>, 2>& range, const GridGeometry<Dim>& grid, int per_axis,
                        const Visit& visit) {
  Index<Dim> i;
  for (int a = 0; a < Dim; ++a) {
    i[a] = range[0][a] * per_axis;
    if (range[0][a] >= range[1][a]) return;
  }
  for (;;) {
    Vector<Dim> x;
    std::int64_t number = 0;
    for (int a = Dim - 1; a >= 0; --a) {
      x[a] = grid.min[a] + (i[a] + 0.5) * grid.cell[a] / per_axis;
      number = number * (std::int64_t{grid.cells[a]} * per_axis) + i[a];
    }
    visit(x, number);
    int a = 0;
    while (a < Dim && ++i[a] == range[1][a] * per_axis) i[a] = range[0][a] * per_axis, ++a;
    if (a == Dim) return;
  }
}

/// All bodies share one lattice; its points are claimed body after body.
template <int Dim>
class Claims {
 public:
  Claims(const Case& definition, const GridGeometry<Dim>& grid) : case_(definition), grid_(grid) {
    for (std::size_t m = 0; m < definition.materials.size(); ++m)
      material_index_[definition.materials[m].first] = static_cast<std::int32_t>(m);
  }

  void claim(std::size_t body_number) {
    const BodyCase& body = case_.bodies[body_number];
    const int per_axis = points_per_axis(body.particles_per_cell, Dim);
    auto& lattice = lattices_[per_axis];
    std::size_t found = 0;
    for_lattice_points<Dim>(cells_around<Dim>(body.region, grid_), grid_, per_axis,
                            [&](const Vector<Dim>& x, std::int64_t number) {
                              const Membership membership = body.region.membership(x);
                              if (membership == Membership::unknown) no_height(body, x);
                              if (membership == Membership::no) return;
                              ++found;
                              const Claim claim{body_number, material_index_.at(body.material), pad(x)};
                              const auto [place, fresh] = lattice.emplace(number, claim);
                              if (!fresh) contest(place->second, claim);
                            });
    if (found == 0)
      throw CaseError(body.place, fmt::format("the body of material '{}' holds no material points: it lies between the "
                                              "lattice points, or is empty",
                                              body.material));
  }

  const std::map<int, std::map<std::int64_t, Claim>>& lattices() const { return lattices_; }

 private:
  static Vector<3> pad(const Vector<Dim>& x) {
    Vector<3> padded{};
    std::copy(x.begin(), x.end(), padded.begin());
    return padded;
  }

  /// Whether the point belongs to the body depends on a height that its raster does not have.
  [[noreturn]] static void no_height(const BodyCase& body, const Vector<Dim>& x) {
    const Raster& raster = *body.region.raster_without_value(x);
    const auto [low, high] = raster.extent();
    throw CaseError(body.place,
                    fmt::format("the raster '{}' has no height at ({:g}, {:g}) m, where this body of '{}' may have "
                                "material: it reaches from ({:g}, {:g}) m to ({:g}, {:g}) m, less what is NODATA; "
                                "confine the body to where there are heights, for example with a box",
                                raster.file(), x[0], x[1], body.material, low[0], low[1], high[0], high[1]));
  }

  void contest(Claim& holder, const Claim& claim) const {
    const BodyCase &body = case_.bodies[claim.body], &other = case_.bodies[holder.body];
    if (replaces(body, other.material)) {
      holder = claim;
      return;
    }
    const std::span<const double> x(claim.x.data(), Dim);
    const double edge = on_edge * grid_.smallest_cell();
    if (body.region.distance_to_surface(x) < edge || other.region.distance_to_surface(x) < edge) return;
    throw CaseError(body.place,
                    fmt::format("bodies overlap: the point ({:g}) m lies in this body of '{}' and in the body of "
                                "'{}' at {}; to cut the former out of the latter write `replaces: {}`",
                                fmt::join(x, ", "), body.material, other.material, other.place.text(), other.material));
  }

  const Case& case_;
  const GridGeometry<Dim>& grid_;
  std::map<std::string, std::int32_t> material_index_;
  std::map<int, std::map<std::int64_t, Claim>> lattices_;  // by points per axis, then by number of the lattice point
};

}  // namespace

template <int Dim>
void fill_bodies(const Case& definition, const GridGeometry<Dim>& grid, const std::function<double(int)>& density,
                 Particles& particles) {
  Claims<Dim> claims(definition, grid);
  for (std::size_t b = 0; b < definition.bodies.size(); ++b) claims.claim(b);
  std::size_t count = 0;
  for (const auto& [per_axis, lattice] : claims.lattices()) count += lattice.size();
  if (count == 0) throw CaseError(definition.source.place, "the case has no material points: `bodies` is empty");

  particles.material_names.clear();
  for (const auto& material : definition.materials) particles.material_names.push_back(material.first);
  particles.resize(count);
  Columns& columns = particles.columns;
  std::size_t p = 0;
  for (const auto& [per_axis, lattice] : claims.lattices()) {
    const double volume = grid.cell_volume() / power(per_axis, Dim);
    for (const auto& [number, claim] : lattice) {
      const BodyCase& body = definition.bodies[claim.body];
      for (int a = 0; a < Dim; ++a) {
        columns.data(particles.position, a)[p] = claim.x[static_cast<std::size_t>(a)];
        columns.data(particles.initial_position, a)[p] = claim.x[static_cast<std::size_t>(a)];
        if (!body.velocity.empty()) columns.data(particles.velocity, a)[p] = body.velocity[static_cast<std::size_t>(a)];
      }
      columns.data(particles.volume)[p] = volume;
      columns.data(particles.mass)[p] = volume * density(claim.material);
      particles.id[p] = static_cast<std::int32_t>(p);
      particles.material[p] = claim.material;
      ++p;
    }
  }
}

template void fill_bodies<2>(const Case&, const GridGeometry<2>&, const std::function<double(int)>&, Particles&);
template void fill_bodies<3>(const Case&, const GridGeometry<3>&, const std::function<double(int)>&, Particles&);

}  // namespace sluice
