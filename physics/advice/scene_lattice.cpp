#include "physics/advice/scene_lattice.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <span>

namespace sluice::advice {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
/// Large grids are looked at with fewer points.
constexpr double most_points = 2e6;

}  // namespace

SceneLattice::SceneLattice(const Case& definition) : dimension_(definition.dimension()) {
  const GridCase& grid = definition.grid;
  const auto dimension = static_cast<std::size_t>(dimension_);
  double points = 1;
  for (std::size_t a = 0; a < dimension; ++a) points *= 2 * (grid.max[a] - grid.min[a]) / grid.cell[a];
  const double coarser = std::max(1.0, std::ceil(std::pow(points / most_points, 1.0 / dimension_)));
  std::size_t total = 1;
  for (std::size_t a = 0; a < dimension; ++a) {
    const double extent = grid.max[a] - grid.min[a];
    count_[a] = static_cast<std::size_t>(std::max(1.0, std::round(2 * extent / grid.cell[a] / coarser)));
    spacing_[a] = extent / static_cast<double>(count_[a]);
    origin_[a] = grid.min[a] + 0.5 * spacing_[a];
    total *= count_[a];
  }
  for (const BodyCase& body : definition.bodies)
    material_.push_back(
        static_cast<int>(std::ranges::find(definition.materials, body.material,
                                           [](const auto& named) -> const std::string& { return named.first; }) -
                         definition.materials.begin()));
  body_.assign(total, -1);
  for (std::size_t b = 0; b < definition.bodies.size(); ++b) {
    const BodyCase& body = definition.bodies[b];
    const auto bounds = body.region.bounds(dimension_);
    for (std::size_t i = 0; i < total; ++i) {
      const auto x = point(i);
      bool near = true;
      for (std::size_t a = 0; a < dimension; ++a) near = near && x[a] >= bounds[0][a] && x[a] <= bounds[1][a];
      if (!near || !body.region.contains(std::span(x).first(dimension))) continue;
      const int earlier = body_[i];
      const bool replaces =
          earlier >= 0 &&
          std::ranges::count(body.replaces, definition.bodies[static_cast<std::size_t>(earlier)].material);
      if (earlier < 0 || replaces) body_[i] = static_cast<std::int16_t>(b);
    }
  }
}

std::array<std::size_t, 3> SceneLattice::index(std::size_t i) const {
  return {i % count_[0], i / count_[0] % count_[1], i / (count_[0] * count_[1])};
}

std::array<double, 3> SceneLattice::point(std::size_t i) const {
  const auto at = index(i);
  std::array<double, 3> x{};
  for (std::size_t a = 0; a < static_cast<std::size_t>(dimension_); ++a)
    x[a] = origin_[a] + static_cast<double>(at[a]) * spacing_[a];
  return x;
}

bool SceneLattice::neighbour(std::size_t i, const Step& step, std::size_t& found) const {
  const auto at = index(i);
  std::size_t stride = 1;
  found = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto moved = static_cast<std::int64_t>(at[a]) + step[a];
    if (moved < 0 || moved >= static_cast<std::int64_t>(count_[a])) return false;
    found += stride * static_cast<std::size_t>(moved);
    stride *= count_[a];
  }
  return true;
}

double SceneLattice::length(const Step& step) const {
  double squared = 0;
  for (std::size_t a = 0; a < 3; ++a) squared += std::pow(step[a] * spacing_[a], 2);
  return std::sqrt(squared);
}

/// Those that come after the point in the order of indices.
std::vector<SceneLattice::Step> SceneLattice::directions() const {
  std::vector<Step> all;
  const int deep = dimension_ == 3 ? 1 : 0;
  for (int z = -deep; z <= deep; ++z)
    for (int y = -1; y <= 1; ++y)
      for (int x = -1; x <= 1; ++x)
        if (z > 0 || (z == 0 && (y > 0 || (y == 0 && x > 0)))) all.push_back({x, y, z});
  return all;
}

double SceneLattice::drainage_length(int wanted, const std::function<Passage(std::size_t)>& passage,
                                     const std::function<bool(int, bool)>& face) const {
  std::vector<Passage> pass(size());
  for (std::size_t i = 0; i < size(); ++i) pass[i] = passage(i);
  std::vector<double> way(size(), infinity);
  using Entry = std::pair<double, std::size_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> front;
  std::size_t other = 0;
  for (std::size_t i = 0; i < size(); ++i) {
    if (pass[i] != Passage::through) continue;
    for (int a = 0; a < dimension_; ++a)
      for (const int side : {-1, 1}) {
        Step step{};
        step[static_cast<std::size_t>(a)] = side;
        const bool inside = neighbour(i, step, other);
        if (inside ? pass[other] == Passage::open : face(a, side > 0)) way[i] = std::min(way[i], 0.5 * spacing(a));
      }
    if (way[i] < infinity) front.emplace(way[i], i);
  }
  std::vector<Step> steps = directions();
  for (const Step& step : directions()) steps.push_back({-step[0], -step[1], -step[2]});
  while (!front.empty()) {
    const auto [far, i] = front.top();
    front.pop();
    if (far > way[i]) continue;
    for (const Step& step : steps) {
      if (!neighbour(i, step, other) || pass[other] != Passage::through) continue;
      const double there = far + length(step);
      if (there >= way[other] * (1 - 1e-12)) continue;
      way[other] = there;
      front.emplace(there, other);
    }
  }
  double longest = 0;
  for (std::size_t i = 0; i < size(); ++i)
    if (material(i) == wanted && pass[i] == Passage::through) longest = std::max(longest, way[i]);
  const double edge = *std::max_element(spacing_.begin(), spacing_.begin() + dimension_) / 2;
  return longest + edge;  // to the far edge of the last point
}

std::vector<double> SceneLattice::thickness() const {
  std::vector<double> shortest(size(), infinity);
  std::vector<std::uint32_t> before(size()), after(size());
  std::vector<bool> from_face(size()), to_face(size());
  std::size_t other = 0;
  for (const Step& step : directions()) {
    const Step back{-step[0], -step[1], -step[2]};
    const auto run = [&](std::size_t i, const Step& to, std::vector<std::uint32_t>& count, std::vector<bool>& ends) {
      const bool inside = neighbour(i, to, other);
      const bool goes_on = inside && material(other) == material(i);
      count[i] = goes_on ? count[other] + 1 : 0;
      ends[i] = goes_on ? ends[other] : !inside;
    };
    for (std::size_t i = 0; i < size(); ++i) run(i, back, before, from_face);
    for (std::size_t i = size(); i-- > 0;) run(i, step, after, to_face);
    const double one = length(step);
    for (std::size_t i = 0; i < size(); ++i)
      if (!(from_face[i] && to_face[i])) shortest[i] = std::min(shortest[i], one * (before[i] + after[i] + 1));
  }
  std::vector<double> thickest(material_.size(), 0.0);
  for (std::size_t i = 0; i < size(); ++i)
    if (body_[i] >= 0) {
      double& t = thickest[static_cast<std::size_t>(body_[i])];
      t = std::max(t, shortest[i]);
    }
  return thickest;
}

bool SceneLattice::same_along(int axis, const std::function<double(std::size_t)>& key) const {
  Step back{};
  back[static_cast<std::size_t>(axis)] = -1;
  std::size_t other = 0;
  for (std::size_t i = 0; i < size(); ++i)
    if (neighbour(i, back, other) && key(i) != key(other)) return false;
  return true;
}

double SceneLattice::extent(int axis) const {
  const auto a = static_cast<std::size_t>(axis);
  std::size_t low = count_[a], high = 0;
  for (std::size_t i = 0; i < size(); ++i)
    if (body_[i] >= 0) {
      low = std::min(low, index(i)[a]);
      high = std::max(high, index(i)[a] + 1);
    }
  return high > low ? static_cast<double>(high - low) * spacing_[a] : 0;
}

}  // namespace sluice::advice
