#include "core/case/geometry.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sluice {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
using Bounds = std::array<std::vector<double>, 2>;

Bounds everywhere(std::size_t dimension) {
  return {std::vector<double>(dimension, -infinity), std::vector<double>(dimension, infinity)};
}

// ---- box
// ---------------------------------------------------------------------------------------------------------------

bool contains(const Box& box, std::span<const double> x) {
  for (std::size_t a = 0; a < x.size(); ++a)
    if (!(box.min[a] <= x[a] && x[a] < box.max[a])) return false;
  return true;
}

double distance(const Box& box, std::span<const double> x) {
  double outside = 0, inside = infinity;
  for (std::size_t a = 0; a < x.size(); ++a) {
    const double depth = std::min(x[a] - box.min[a], box.max[a] - x[a]);
    inside = std::min(inside, depth);
    if (depth < 0) outside += depth * depth;
  }
  return inside < 0 ? std::sqrt(outside) : inside;
}

SignedDistance signed_distance(const Box& box, std::span<const double> x) {
  SignedDistance nearest{-infinity, {}};
  std::array<double, 3> outside{};
  double squared = 0;
  for (std::size_t a = x.size(); a-- > 0;) {
    const double low = box.min[a] - x[a], high = x[a] - box.max[a], depth = std::max(low, high);
    const double sign = low > high ? -1 : 1, hair = 1e-9 * (box.max[a] - box.min[a]);
    if (depth > 0) outside[a] = sign * depth, squared += depth * depth;
    if (depth <= nearest.distance + hair) continue;
    nearest = {depth, {}};
    nearest.normal[a] = sign;
  }
  if (squared == 0) return nearest;
  const double length = std::sqrt(squared);
  for (double& component : outside) component /= length;
  return {length, outside};
}

Bounds bounds_of(const Box& box, std::size_t) { return {box.min, box.max}; }

// ---- polygon
// -----------------------------------------------------------------------------------------------------------

/// Calls visit(a, b) for every edge.
template <class Visit>
void for_edges(const Polygon& polygon, const Visit& visit) {
  for (std::size_t i = 0, j = polygon.vertices.size() - 1; i < polygon.vertices.size(); j = i++)
    visit(polygon.vertices[j], polygon.vertices[i]);
}

/// Even-odd rule: counts the edges that a ray to the right of the point crosses. Edges hold their lower end only, and
/// are always walked upwards, so that polygons on both sides of an edge compute the very same numbers for it.
bool contains(const Polygon& polygon, std::span<const double> x) {
  const double px = x.front(), pz = x.back();
  bool inside = false;
  for_edges(polygon, [&](const std::array<double, 2>& a, const std::array<double, 2>& b) {
    const auto& low = a[1] <= b[1] ? a : b;
    const auto& high = a[1] <= b[1] ? b : a;
    if (!(low[1] <= pz && pz < high[1])) return;
    const double side = (high[0] - low[0]) * (pz - low[1]) - (high[1] - low[1]) * (px - low[0]);
    if (side > 0) inside = !inside;
  });
  return inside;
}

/// Calls visit(distance, way, edge) for every edge, with the vectors from its nearest point to x and along it.
template <class Visit>
void for_distances(const Polygon& polygon, std::span<const double> x, const Visit& visit) {
  for_edges(polygon, [&](const std::array<double, 2>& a, const std::array<double, 2>& b) {
    const double ex = b[0] - a[0], ez = b[1] - a[1], dx = x.front() - a[0], dz = x.back() - a[1];
    const double length2 = ex * ex + ez * ez;
    const double t = length2 > 0 ? std::clamp((ex * dx + ez * dz) / length2, 0.0, 1.0) : 0.0;
    const std::array<double, 2> way{dx - t * ex, dz - t * ez};
    visit(std::hypot(way[0], way[1]), way, std::array<double, 2>{ex, ez});
  });
}

double distance(const Polygon& polygon, std::span<const double> x) {
  double least = infinity;
  for_distances(polygon, x, [&](double distance, const auto&, const auto&) { least = std::min(least, distance); });
  return least;
}

SignedDistance signed_distance(const Polygon& polygon, std::span<const double> x) {
  const bool inside = contains(polygon, x);
  const double turn = polygon.signed_area() > 0 ? 1 : -1;
  SignedDistance nearest{infinity, {}};
  for_distances(polygon, x, [&](double distance, const std::array<double, 2>& way, const std::array<double, 2>& edge) {
    const double length = std::hypot(edge[0], edge[1]);
    if (distance >= nearest.distance || length == 0) return;
    nearest.distance = distance;
    // On the edge itself the way has no direction: then the edge has it.
    const bool on_edge = distance < 1e-9 * length;
    const double scale = on_edge ? turn / length : (inside ? -1 : 1) / distance;
    nearest.normal[0] = scale * (on_edge ? edge[1] : way[0]);
    nearest.normal[x.size() - 1] = scale * (on_edge ? -edge[0] : way[1]);
  });
  if (inside) nearest.distance = -nearest.distance;
  return nearest;
}

Bounds bounds_of(const Polygon& polygon, std::size_t dimension) {
  Bounds bounds = everywhere(dimension);
  for (const std::size_t c : {std::size_t{0}, std::size_t{1}}) {
    const auto [low, high] = std::minmax_element(polygon.vertices.begin(), polygon.vertices.end(),
                                                 [c](const auto& a, const auto& b) { return a[c] < b[c]; });
    const std::size_t axis = c == 0 ? 0 : dimension - 1;
    bounds[0][axis] = (*low)[c];
    bounds[1][axis] = (*high)[c];
  }
  return bounds;
}

// ---- half-space
// --------------------------------------------------------------------------------------------------------

/// normal · (x - point)
double height(const HalfSpace& half_space, std::span<const double> x) {
  double sum = 0;
  for (std::size_t a = 0; a < x.size(); ++a) sum += half_space.normal[a] * (x[a] - half_space.point[a]);
  return sum;
}

bool contains(const HalfSpace& half_space, std::span<const double> x) { return height(half_space, x) <= 0; }

double distance(const HalfSpace& half_space, std::span<const double> x) {
  double length2 = 0;
  for (const double n : half_space.normal) length2 += n * n;
  return std::abs(height(half_space, x)) / std::sqrt(length2);
}

SignedDistance signed_distance(const HalfSpace& half_space, std::span<const double> x) {
  double length2 = 0;
  for (const double n : half_space.normal) length2 += n * n;
  const double length = std::sqrt(length2);
  SignedDistance found{height(half_space, x) / length, {}};
  for (std::size_t a = 0; a < x.size(); ++a) found.normal[a] = half_space.normal[a] / length;
  return found;
}

/// Bounded on one side of one axis if the normal is parallel to that axis.
Bounds bounds_of(const HalfSpace& half_space, std::size_t dimension) {
  Bounds bounds = everywhere(dimension);
  std::size_t axis = dimension, components = 0;
  for (std::size_t a = 0; a < dimension; ++a) {
    if (half_space.normal[a] == 0) continue;
    axis = a;
    ++components;
  }
  if (components == 1) bounds[half_space.normal[axis] > 0 ? 1 : 0][axis] = half_space.point[axis];
  return bounds;
}

// ---- sphere ----

double distance_from_centre(const Sphere& sphere, std::span<const double> x) {
  double squared = 0;
  for (std::size_t a = 0; a < x.size(); ++a) squared += (x[a] - sphere.centre[a]) * (x[a] - sphere.centre[a]);
  return std::sqrt(squared);
}

bool contains(const Sphere& sphere, std::span<const double> x) {
  return distance_from_centre(sphere, x) <= sphere.radius;
}

double distance(const Sphere& sphere, std::span<const double> x) {
  return std::abs(distance_from_centre(sphere, x) - sphere.radius);
}

SignedDistance signed_distance(const Sphere& sphere, std::span<const double> x) {
  const double from_centre = distance_from_centre(sphere, x);
  SignedDistance found{from_centre - sphere.radius, {}};
  for (std::size_t a = 0; a < x.size(); ++a)
    found.normal[a] = from_centre > 0 ? (x[a] - sphere.centre[a]) / from_centre : a + 1 == x.size();
  return found;
}

Bounds bounds_of(const Sphere& sphere, std::size_t) {
  Bounds bounds{sphere.centre, sphere.centre};
  for (double& low : bounds[0]) low -= sphere.radius;
  for (double& high : bounds[1]) high += sphere.radius;
  return bounds;
}

// ---- circle: along all axes but the first two without end ----

bool contains(const Circle& circle, std::span<const double> x) {
  return contains(static_cast<const Sphere&>(circle), x.first(2));
}

double distance(const Circle& circle, std::span<const double> x) {
  return distance(static_cast<const Sphere&>(circle), x.first(2));
}

Bounds bounds_of(const Circle& circle, std::size_t dimension) {
  Bounds bounds = everywhere(dimension);
  const Bounds disc = bounds_of(static_cast<const Sphere&>(circle), 2);
  for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) std::ranges::copy(disc[side], bounds[side].begin());
  return bounds;
}

// ---- layer ----

bool contains(const Layer& layer, std::span<const double> x) {
  return !(layer.bottom && x.back() < *layer.bottom) && !(layer.top && x.back() >= *layer.top);
}

double distance(const Layer& layer, std::span<const double> x) {
  double least = infinity;
  for (const auto& level : {layer.bottom, layer.top})
    if (level) least = std::min(least, std::abs(x.back() - *level));
  return least;
}

SignedDistance signed_distance(const Layer& layer, std::span<const double> x) {
  SignedDistance nearest{-infinity, {}};
  nearest.normal[x.size() - 1] = 1;
  if (layer.top) nearest.distance = x.back() - *layer.top;
  if (layer.bottom && *layer.bottom - x.back() > nearest.distance) {
    nearest.distance = *layer.bottom - x.back();
    nearest.normal[x.size() - 1] = -1;
  }
  return nearest;
}

Bounds bounds_of(const Layer& layer, std::size_t dimension) {
  Bounds bounds = everywhere(dimension);
  if (layer.bottom) bounds[0].back() = *layer.bottom;
  if (layer.top) bounds[1].back() = *layer.top;
  return bounds;
}

// ---- raster ----

/// To the plane that touches the surface above or below x; infinite where there is no surface.
double distance(const RasterSide& side, std::span<const double> x) {
  const auto surface = side.raster->height(x[0], x[1]);
  if (!surface) return infinity;
  const auto [slope_x, slope_y] = side.raster->slope(x[0], x[1]);
  return std::abs(x.back() - *surface) / std::sqrt(1 + slope_x * slope_x + slope_y * slope_y);
}

SignedDistance signed_distance(const RasterSide& side, std::span<const double> x) {
  const auto surface = side.raster->height(x[0], x[1]);
  if (!surface) return {infinity, {0, 0, 1}};
  const auto [slope_x, slope_y] = side.raster->slope(x[0], x[1]);
  const double sign = side.below ? 1 : -1, scale = sign / std::sqrt(1 + slope_x * slope_x + slope_y * slope_y);
  return {scale * (x.back() - *surface), {-scale * slope_x, -scale * slope_y, scale}};
}

/// The raster does not end the region sideways: beyond its edges it is unknown.
Bounds bounds_of(const RasterSide& side, std::size_t dimension) {
  Bounds bounds = everywhere(dimension);
  const auto [lowest, highest] = side.raster->extremes();
  if (side.below)
    bounds[1].back() = highest;
  else
    bounds[0].back() = lowest;
  return bounds;
}

// ---- what holds for every shape, and how regions are combined: Kleene's logic of three values ----

template <class Shape>
Membership membership(const Shape& shape, std::span<const double> x) {
  return contains(shape, x) ? Membership::yes : Membership::no;
}

Membership membership(const RasterSide& side, std::span<const double> x) {
  const auto surface = side.raster->height(x[0], x[1]);
  if (!surface) return Membership::unknown;
  return (x.back() < *surface) == side.below ? Membership::yes : Membership::no;
}

Membership opposite(Membership m) {
  return m == Membership::yes ? Membership::no : m == Membership::no ? Membership::yes : Membership::unknown;
}

Membership membership(const Union& all, std::span<const double> x) {
  Membership found = Membership::no;
  for (const Region& region : all.of) found = std::max(found, region.membership(x));
  return found;
}

Membership membership(const Intersection& all, std::span<const double> x) {
  Membership found = Membership::yes;
  for (const Region& region : all.of) found = std::min(found, region.membership(x));
  return found;
}

Membership membership(const Difference& difference, std::span<const double> x) {
  Membership found = difference.of.front().membership(x);
  for (std::size_t i = 1; i < difference.of.size(); ++i)
    found = std::min(found, opposite(difference.of[i].membership(x)));
  return found;
}

template <class Shape>
double distance_outside_of(const Shape& shape, std::span<const double> x) {
  return membership(shape, x) == Membership::yes ? 0 : distance(shape, x);
}

double distance_outside_of(const Union& all, std::span<const double> x) {
  double least = infinity;
  for (const Region& region : all.of) least = std::min(least, region.distance_outside(x));
  return least;
}

double distance_outside_of(const Intersection& all, std::span<const double> x) {
  double largest = 0;
  for (const Region& region : all.of) largest = std::max(largest, region.distance_outside(x));
  return largest;
}

double distance_outside_of(const Difference& difference, std::span<const double> x) {
  double largest = difference.of.front().distance_outside(x);
  for (std::size_t i = 1; i < difference.of.size(); ++i)
    if (difference.of[i].contains(x)) largest = std::max(largest, difference.of[i].distance_to_surface(x));
  return largest;
}

/// Shapes that are made of regions.
template <class Shape>
concept Combination = requires(const Shape& shape) {
  shape.of;
};

double distance(const Combination auto& combination, std::span<const double> x) {
  double least = infinity;
  for (const Region& region : combination.of) least = std::min(least, region.distance_to_surface(x));
  return least;
}

SignedDistance signed_distance(const Union& all, std::span<const double> x) {
  SignedDistance nearest{infinity, {}};
  for (const Region& region : all.of) {
    const SignedDistance own = region.signed_distance(x);
    if (own.distance < nearest.distance) nearest = own;
  }
  return nearest;
}

SignedDistance signed_distance(const Intersection& all, std::span<const double> x) {
  SignedDistance furthest{-infinity, {}};
  for (const Region& region : all.of) {
    const SignedDistance own = region.signed_distance(x);
    if (own.distance > furthest.distance) furthest = own;
  }
  return furthest;
}

SignedDistance signed_distance(const Difference& difference, std::span<const double> x) {
  SignedDistance furthest = difference.of.front().signed_distance(x);
  for (std::size_t i = 1; i < difference.of.size(); ++i) {
    SignedDistance own = difference.of[i].signed_distance(x);
    if (-own.distance <= furthest.distance) continue;
    for (double& component : own.normal) component = -component;
    furthest = {-own.distance, own.normal};
  }
  return furthest;
}

/// Cuts `all` down to what `more` bounds.
void intersect(Bounds& all, const Bounds& more) {
  for (std::size_t a = 0; a < all[0].size(); ++a) {
    all[0][a] = std::max(all[0][a], more[0][a]);
    all[1][a] = std::min(all[1][a], more[1][a]);
  }
}

bool empty(const Bounds& bounds) {
  for (std::size_t a = 0; a < bounds[0].size(); ++a)
    if (bounds[0][a] >= bounds[1][a]) return true;
  return false;
}

Bounds bounds_of(const Union& all, std::size_t dimension) {
  Bounds hull{std::vector<double>(dimension, infinity), std::vector<double>(dimension, -infinity)};
  for (const Region& region : all.of) {
    const Bounds bounds = region.bounds(static_cast<int>(dimension));
    if (empty(bounds)) continue;
    for (std::size_t a = 0; a < dimension; ++a) {
      hull[0][a] = std::min(hull[0][a], bounds[0][a]);
      hull[1][a] = std::max(hull[1][a], bounds[1][a]);
    }
  }
  return hull;
}

Bounds bounds_of(const Intersection& all, std::size_t dimension) {
  Bounds bounds = everywhere(dimension);
  for (const Region& region : all.of) intersect(bounds, region.bounds(static_cast<int>(dimension)));
  return bounds;
}

Bounds bounds_of(const Difference& difference, std::size_t dimension) {
  return difference.of.front().bounds(static_cast<int>(dimension));
}

}  // namespace

double Polygon::area() const { return std::abs(signed_area()); }

double Polygon::signed_area() const {
  double twice = 0;
  // From the first vertex: far from the origin the products would cancel.
  const auto& o = vertices.front();
  for_edges(*this, [&](const std::array<double, 2>& a, const std::array<double, 2>& b) {
    twice += (a[0] - o[0]) * (b[1] - o[1]) - (b[0] - o[0]) * (a[1] - o[1]);
  });
  return twice / 2;
}

Membership Region::membership(std::span<const double> x) const {
  Membership found = Membership::yes;
  for (const Primitive& part : parts) {
    found = std::min(found, std::visit([&](const auto& shape) { return sluice::membership(shape, x); }, part));
    if (found == Membership::no) break;
  }
  return found;
}

const Raster* Region::raster_without_value(std::span<const double> x) const {
  const Raster* found = nullptr;
  const auto look = [&]<class Shape>(const Shape& shape) {
    if constexpr (std::is_same_v<Shape, RasterSide>) {
      if (!shape.raster->height(x[0], x[1])) found = shape.raster.get();
    } else if constexpr (Combination<Shape>) {
      for (const Region& region : shape.of)
        if (found == nullptr) found = region.raster_without_value(x);
    }
  };
  for (const Primitive& part : parts)
    if (found == nullptr) std::visit(look, part);
  return found;
}

double Region::distance_to_surface(std::span<const double> x) const {
  double least = infinity;
  for (const Primitive& part : parts)
    least = std::min(least, std::visit([&](const auto& shape) { return distance(shape, x); }, part));
  return least;
}

double Region::distance_outside(std::span<const double> x) const {
  double largest = 0;
  for (const Primitive& part : parts)
    largest = std::max(largest, std::visit([&](const auto& shape) { return distance_outside_of(shape, x); }, part));
  return largest;
}

SignedDistance Region::signed_distance(std::span<const double> x) const {
  SignedDistance furthest{-infinity, {}};
  for (const Primitive& part : parts) {
    const SignedDistance own = std::visit([&](const auto& shape) { return sluice::signed_distance(shape, x); }, part);
    if (own.distance > furthest.distance) furthest = own;
  }
  return furthest;
}

std::array<std::vector<double>, 2> Region::bounds(int dimension) const {
  const auto n = static_cast<std::size_t>(dimension);
  Bounds all = everywhere(n);
  for (const Primitive& part : parts)
    intersect(all, std::visit([&](const auto& shape) { return bounds_of(shape, n); }, part));
  return all;
}

}  // namespace sluice
