#include "core/case/consistency.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/case/case_schema.h"
#include "core/case/region_schema.h"
#include "core/grid/geometry.h"

namespace sluice {

namespace {

/// As in the components of stress: in plane strain y points up, and z out of the plane.
std::string axis_name(std::size_t axis) { return axis == 0 ? "x" : axis == 1 ? "y" : "z"; }

Place place_of(const Node& section, const std::string& key) {
  const Node* const found = section.find(key);
  return found != nullptr ? found->place : section.place;
}

class Consistency {
 public:
  Consistency(Case& definition, Problems& problems) : case_(definition), problems_(problems) {}

  void run() {
    check_materials_of_bodies();
    check_changes();
    if (case_.contact) check_contact();
    const bool has_grid = check_grid();
    if (!has_grid) return;
    dimension_ = case_.grid.min.size();
    if (case_.contact && !case_.contact->normal.empty()) check_normal();
    check_components(case_.gravity, "gravity", case_.source);
    check_faces();
    check_obstacles();
    const Node* const bodies = case_.source.find("bodies");
    for (std::size_t i = 0; i < case_.bodies.size(); ++i) check_body(case_.bodies[i], bodies->items[i]);
    check_observations();
  }

 private:
  /// An empty list becomes zero.
  void check_components(std::vector<double>& values, const std::string& key, const Node& section) {
    if (values.empty()) values.assign(dimension_, 0.0);
    if (values.size() == dimension_) return;
    problems_.add(place_of(section, key),
                  fmt::format("{}: found {} components; the grid has {} dimensions", key, values.size(), dimension_));
  }

  // ---- grid ----

  bool check_grid() {
    GridCase& grid = case_.grid;
    if (grid.min.empty() || grid.max.empty() || grid.cell.empty()) return false;  // reported
    const Node& section = *case_.source.find("grid");
    if (grid.min.size() != grid.max.size()) {
      problems_.add(place_of(section, "max"),
                    fmt::format("grid: min has {} components, max has {}", grid.min.size(), grid.max.size()));
      return false;
    }
    const bool one_for_all = section.find("cell")->kind == Node::Kind::scalar;
    if (one_for_all) grid.cell.assign(grid.min.size(), grid.cell[0]);
    if (grid.cell.size() != grid.min.size()) {
      problems_.add(place_of(section, "cell"),
                    fmt::format("grid: cell has {} components, min has {}", grid.cell.size(), grid.min.size()));
      return false;
    }
    bool good = true;
    for (std::size_t a = 0; a < grid.min.size(); ++a) good = check_axis(a, section) && good;
    return good;
  }

  bool check_axis(std::size_t a, const Node& section) {
    const GridCase& grid = case_.grid;
    const double extent = grid.max[a] - grid.min[a], cell = grid.cell[a], cells = extent / cell;
    const std::string axis = axis_name(a);
    const Place place = place_of(section, "max");
    constexpr double most = 1e6;
    if (extent <= 0) {
      problems_.add(place, fmt::format("grid: max is {:g} m along {}; it must be above min, {:g} m", grid.max[a], axis,
                                       grid.min[a]));
    } else if (std::abs(cells - std::round(cells)) > 1e-6 || std::round(cells) < 1) {
      problems_.add(place,
                    fmt::format("grid: the extent along {} is {:g} m, which is {:g} cells of {:g} m; it must be a "
                                "whole number of cells, for example {:g} m or {:g} m",
                                axis, extent, cells, cell, std::max(std::floor(cells), 1.0) * cell,
                                std::max(std::ceil(cells), 1.0) * cell));
    } else if (cells > most) {
      problems_.add(place_of(section, "cell"),
                    fmt::format("grid: {:g} cells along {}; at most {:g} are possible", cells, axis, most));
    } else {
      return true;
    }
    return false;
  }

  void check_faces() {
    const auto allowed = face_words(static_cast<int>(dimension_));
    const Node* const section = case_.source.find("boundaries");
    if (section != nullptr && section->kind == Node::Kind::map)
      for (const auto& [name, place] : section->keys)
        if (std::find(allowed.begin(), allowed.end(), name) == allowed.end())
          problems_.add(place, fmt::format("unknown face '{}' in boundaries; {}", name, allowed_words(name, allowed)));
    for (const std::string& name : allowed) case_.faces.try_emplace(name);
    for (const auto& [name, face] : case_.faces)
      if (!face.velocity.empty()) check_velocity(face, *section->find(name));
    for (std::size_t a = 0; a < dimension_; ++a) check_periodic(a, allowed[2 * a], allowed[2 * a + 1]);
  }

  /// Both faces of an axis are periodic or none, and blocks fit (core/grid/geometry.h).
  void check_periodic(std::size_t a, const std::string& lower, const std::string& upper) {
    const bool low = case_.faces[lower].periodic, high = case_.faces[upper].periodic;
    if (!low && !high) return;
    const Node& section = *case_.source.find("boundaries");
    if (low != high) {
      const std::string &one = low ? lower : upper, &other = low ? upper : lower;
      problems_.add(place_of(section, one),
                    fmt::format("boundaries.{0}: periodic, but {1} is not; what leaves through one of them comes in at "
                                "the other: give `{1}: periodic`, too",
                                one, other));
      return;
    }
    const GridCase& grid = case_.grid;
    const int width = dimension_ == 2 ? block_width<2> : block_width<3>;
    const auto cells = static_cast<int>(std::lround((grid.max[a] - grid.min[a]) / grid.cell[a]));
    case_.grid.periodic[a] = true;
    if (cells % width == 0) return;
    const int below = cells / width * width;
    const std::string nearest = below == 0 ? std::to_string(width) : fmt::format("{} or {}", below, below + width);
    problems_.add(place_of(section, lower),
                  fmt::format("boundaries.{}: a periodic axis needs a multiple of {} cells in {}-D; there are {} along "
                              "{}; take {}",
                              lower, width, dimension_, cells, axis_name(a), nearest));
  }

  void check_velocity(const FaceCase& face, const Node& section) {
    if (face.velocity.empty() || face.velocity.size() == dimension_) return;
    problems_.add(
        place_of(section, "velocity"),
        fmt::format("velocity: found {} components; the grid has {} dimensions", face.velocity.size(), dimension_));
  }

  void check_obstacles() {
    for (const ObstacleCase& obstacle : case_.obstacles) {
      const Node& section = *case_.source.find("obstacles")->find(obstacle.name);
      check_shapes(obstacle.region, section, "obstacle '" + obstacle.name + "'");
      check_velocity(obstacle.surface, section);
    }
  }

  // ---- bodies ----

  void check_materials_of_bodies() {
    const Node* const bodies = case_.source.find("bodies");
    std::vector<std::string> names, earlier;
    for (const auto& [name, section] : case_.materials) names.push_back(name);
    for (std::size_t i = 0; i < case_.bodies.size(); ++i) {
      const BodyCase& body = case_.bodies[i];
      const Node& section = bodies->items[i];
      const auto known = [&](const std::string& name) {
        return std::find(names.begin(), names.end(), name) != names.end();
      };
      if (!body.material.empty() && !names.empty() && !known(body.material))
        problems_.add(place_of(section, "material"),
                      fmt::format("unknown material '{}'; {}", body.material, allowed_words(body.material, names)));
      for (const std::string& name : body.replaces)
        if (std::find(earlier.begin(), earlier.end(), name) == earlier.end())
          problems_.add(place_of(section, "replaces"),
                        fmt::format("replaces: '{}' is not the material of an earlier body; {}", name,
                                    allowed_words(name, earlier)));
      if (std::find(earlier.begin(), earlier.end(), body.material) == earlier.end()) earlier.push_back(body.material);
    }
  }

  void check_changes() {
    std::vector<std::string> names;
    for (const auto& [name, section] : case_.materials) names.push_back(name);
    if (case_.changes.size() > 64) problems_.add(case_.changes[64].place, "changes: at most 64 are possible");
    for (const ChangeCase& change : case_.changes)
      for (const std::string& name : {change.material, change.becomes})
        if (!name.empty() && std::find(names.begin(), names.end(), name) == names.end())
          problems_.add(change.place,
                        fmt::format("changes: unknown material '{}'; {}", name, allowed_words(name, names)));
  }

  void check_contact() {
    const Node& section = *case_.source.find("contact");
    case_.contact->place = section.place;
    std::vector<std::string> names;
    for (const auto& [name, material] : case_.materials) names.push_back(name);
    constexpr std::size_t most = 63;
    if (case_.contact->materials.empty())
      problems_.add(place_of(section, "materials"),
                    "contact: materials: there are none; name those that are bodies of their own");
    if (case_.contact->materials.size() > most)
      problems_.add(place_of(section, "materials"), fmt::format("contact: at most {} materials are possible", most));
    for (const std::string& name : case_.contact->materials)
      if (std::ranges::find(names, name) == names.end())
        problems_.add(place_of(section, "materials"),
                      fmt::format("contact: unknown material '{}'; {}", name, allowed_words(name, names)));
  }

  void check_normal() {
    const std::vector<double>& normal = case_.contact->normal;
    const Place place = place_of(*case_.source.find("contact"), "normal");
    if (normal.size() != dimension_)
      problems_.add(place, fmt::format("contact: normal: found {} components; the grid has {} dimensions",
                                       normal.size(), dimension_));
    else if (std::ranges::all_of(normal, [](double component) { return component == 0; }))
      problems_.add(place, "contact: normal: all components are 0");
  }

  void check_body(BodyCase& body, const Node& section) {
    check_components(body.velocity, "velocity", section);
    check_particles_per_cell(body, section);
    if (check_shapes(body.region, section, "body")) check_bounds(body);
  }

  void check_particles_per_cell(BodyCase& body, const Node& section) {
    const int power = static_cast<int>(dimension_);
    if (section.find("particles_per_cell") == nullptr) body.particles_per_cell = 1 << power;
    const int n = static_cast<int>(std::lround(std::pow(body.particles_per_cell, 1.0 / power)));
    const auto raised = [&](int base) { return dimension_ == 2 ? base * base : base * base * base; };
    if (raised(n) == body.particles_per_cell) return;
    const int below = raised(n) < body.particles_per_cell ? n : n - 1;
    problems_.add(place_of(section, "particles_per_cell"),
                  fmt::format("particles_per_cell is {}; it must be n^{} in {}-D; nearest: {} and {}",
                              body.particles_per_cell, power, power, raised(std::max(below, 1)), raised(below + 1)));
  }

  bool check_shapes(const Region& region, const Node& section, const std::string& what) {
    return check_region(region, section, what, dimension_, problems_);
  }

  /// Where the region is bounded, it must end inside the grid; where it is not, the grid ends it.
  void check_bounds(const BodyCase& body) {
    const auto bounds = body.region.bounds(static_cast<int>(dimension_));
    const auto faces = face_words(static_cast<int>(dimension_));
    for (std::size_t a = 0; a < dimension_; ++a) {
      const std::string axis = axis_name(a);
      const double low = case_.grid.min[a], high = case_.grid.max[a], tolerance = 1e-9 * (high - low);
      const double from = bounds[0][a], to = bounds[1][a];
      const auto complain = [&](double beyond, const std::string& face, double at, double end) {
        problems_.add(body.place,
                      fmt::format("the body of '{}' reaches {:g} m beyond the {} face of the grid: it extends to "
                                  "{} = {:g} m, the grid ends at {:g} m",
                                  body.material, beyond, face, axis, at, end));
      };
      if (from >= to) {
        problems_.add(body.place, fmt::format("the body of '{}' is empty: its shapes have nothing in common along {}",
                                              body.material, axis));
      } else if (from >= high || to <= low) {
        problems_.add(body.place,
                      fmt::format("the body of '{}' lies outside the grid: it extends from {} = {:g} m to {:g} m, "
                                  "the grid from {:g} m to {:g} m",
                                  body.material, axis, from, to, low, high));
      } else {
        if (std::isfinite(from) && from < low - tolerance) complain(low - from, faces[2 * a], from, low);
        if (std::isfinite(to) && to > high + tolerance) complain(to - high, faces[2 * a + 1], to, high);
      }
    }
  }

  // ---- observations ----

  void check_observations() {
    for (ObservationCase& observation : case_.observe) {
      const Node& section = *case_.source.find("observe")->find(observation.name);
      if (!observation.direction.empty()) normalise(observation, section);
      if (observation.region) check_shapes(*observation.region, *section.find("region"), "region");
    }
  }

  void normalise(ObservationCase& observation, const Node& section) {
    check_components(observation.direction, "direction", section);
    double length = 0;
    for (const double d : observation.direction) length = std::hypot(length, d);
    if (length == 0) {
      problems_.add(place_of(section, "direction"), "direction: all components are 0");
      return;
    }
    // A unit vector stays as it is to the last bit, so that a resolved case reads back as the same case.
    if (std::abs(length - 1) > 1e-14)
      for (double& d : observation.direction) d /= length;
  }

  Case& case_;
  Problems& problems_;
  std::size_t dimension_ = 0;
};

}  // namespace

namespace {

/// What a shape says of the dimension: its components, or 0 if it fits any.
struct Dimension {
  std::size_t components;
  std::string shape;
};

Dimension dimension_of(const Primitive& part) {
  if (const auto* const box = std::get_if<Box>(&part)) return {box->min.size(), "box"};
  if (const auto* const half = std::get_if<HalfSpace>(&part)) return {half->point.size(), "half_space"};
  if (const auto* const ball = std::get_if<Sphere>(&part)) return {ball->centre.size(), "sphere"};
  return {0, ""};
}

/// The regions that a shape is made of, and the key under which they stand.
std::pair<const std::vector<Region>*, std::string> parts_of(const Primitive& part) {
  if (const auto* const all = std::get_if<Union>(&part)) return {&all->of, "union"};
  if (const auto* const all = std::get_if<Intersection>(&part)) return {&all->of, "intersection"};
  if (const auto* const all = std::get_if<Difference>(&part)) return {&all->of, "difference"};
  return {nullptr, ""};
}

bool check_shape(const Primitive& part, const Node& section, std::size_t dimension, Problems& problems) {
  if (const auto [regions, key] = parts_of(part); regions != nullptr) {
    const Node& list = *section.find(key);
    bool good = true;
    for (std::size_t i = 0; i < regions->size(); ++i)
      good = check_region((*regions)[i], list.items[i], "region", dimension, problems) && good;
    return good;
  }
  if (const auto* const side = std::get_if<RasterSide>(&part); side != nullptr && dimension != 3) {
    const std::string key = side->below ? "below_raster" : "above_raster";
    problems.add(place_of(section, key), key + ": it is for 3-D; in 2-D take polygon");
    return false;
  }
  const auto [found, shape] = dimension_of(part);
  if (found == 0 || found == dimension) return true;
  problems.add(place_of(section, shape),
               fmt::format("{}: found {} components; the grid has {} dimensions", shape, found, dimension));
  return false;
}

}  // namespace

bool check_region(const Region& region, const Node& section, const std::string& what, std::size_t dimension,
                  Problems& problems) {
  require_shape(section, what, problems);
  for (const Primitive& part : region.parts)
    if (!check_shape(part, section, dimension, problems)) return false;
  return !region.parts.empty();
}

void complete_and_check(Case& definition, Problems& problems) { Consistency(definition, problems).run(); }

}  // namespace sluice
