/// Regions of space in a case file: boxes, polygons, half-spaces, spheres, layers, what lies below or above a raster,
/// and unions, intersections and differences of them.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "core/case/raster.h"

namespace sluice {

/// Axis-aligned box, half-open: min <= x < max.
struct Box {
  std::vector<double> min, max;
};

/// Closed polygon in the plane of the first and last axis; in 3-D a prism along the middle axis. A point on an edge
/// that two polygons share belongs to exactly one of them.
struct Polygon {
  std::vector<std::array<double, 2>> vertices;
  double area() const;         ///< positive, whatever the orientation
  double signed_area() const;  ///< positive where the vertices go round counter-clockwise
};

/// All x with normal · (x - point) <= 0.
struct HalfSpace {
  std::vector<double> point, normal;
};

/// All x within `radius` of the centre; a circle in 2-D.
struct Sphere {
  std::vector<double> centre;
  double radius = 0;
};
/// The same in the plane of the first two axes: in 3-D an upright cylinder without end.
struct Circle : Sphere {};

/// Between two levels along the last axis, half-open: bottom <= x < top. One of them may be absent.
struct Layer {
  std::optional<double> bottom, top;
};

/// What lies below the surface that a raster gives, or the rest: the surface itself, and all above. 3-D only.
struct RasterSide {
  std::shared_ptr<const Raster> raster;
  bool below = true;
};

struct Region;

struct Union {
  std::vector<Region> of;
};
struct Intersection {
  std::vector<Region> of;
};
/// The first less the others.
struct Difference {
  std::vector<Region> of;
};

using Primitive =
    std::variant<Box, Polygon, HalfSpace, Sphere, Circle, Layer, RasterSide, Union, Intersection, Difference>;

/// `unknown`: a raster has no value there, and it depends on that.
enum class Membership { no, unknown, yes };

/// Where a point lies to a surface: how far outside [m], negative inside, and the shortest way out.
struct SignedDistance {
  double distance = 0;
  std::array<double, 3> normal{};  ///< unit vector, out of the region; as many components as the point has
};

/// The intersection of its parts.
struct Region {
  std::vector<Primitive> parts;
  bool contains(std::span<const double> x) const { return membership(x) == Membership::yes; }
  Membership membership(std::span<const double> x) const;
  /// A raster of this region that has no value at x; null if all have.
  const Raster* raster_without_value(std::span<const double> x) const;
  /// Distance from x to the nearest surface of any part [m].
  double distance_to_surface(std::span<const double> x) const;
  /// How far x lies outside: the largest distance to a part that does not hold it, 0 inside [m]. With several parts no
  /// more than the distance to what they have in common.
  double distance_outside(std::span<const double> x) const;
  /// Distance to the surface and its normal there. Of several parts the one counts that the point is least inside of,
  /// or furthest outside; of a union, that which it is furthest inside of. Where two surfaces are equally near, the one
  /// across the later axis counts (box), or the first edge (polygon). Infinitely far where a raster has no value.
  SignedDistance signed_distance(std::span<const double> x) const;
  /// Corners of the bounding box; infinite where the region is unbounded. `dimension` is 2 or 3.
  std::array<std::vector<double>, 2> bounds(int dimension) const;
};

}  // namespace sluice
