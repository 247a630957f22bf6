#include "core/output/main_body.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>

namespace sluice {

namespace {

/// A cell as one number: 21 bits an axis, so that a neighbour is a sum away. Unsigned, so that a particle that was
/// thrown beyond a million cells wraps around.
using CellKey = std::uint64_t;
constexpr CellKey axis_step(std::size_t axis) { return CellKey{1} << (21 * axis); }

/// Occupied cells, numbered in the order in which particles meet them. Open addressing: a third of the time of
/// std::unordered_map.
class OccupiedCells {
 public:
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

  OccupiedCells() : slots_(1024, none) {}

  std::uint32_t find(CellKey cell) const { return slots_[slot_of(cell)]; }
  std::uint32_t find_or_add(CellKey cell) {
    std::size_t slot = slot_of(cell);
    if (slots_[slot] != none) return slots_[slot];
    if (2 * (cells_.size() + 1) > slots_.size()) {
      grow();
      slot = slot_of(cell);
    }
    slots_[slot] = static_cast<std::uint32_t>(cells_.size());
    cells_.push_back(cell);
    return slots_[slot];
  }
  const std::vector<CellKey>& cells() const { return cells_; }

 private:
  std::size_t slot_of(CellKey cell) const {
    const std::uint64_t hash = static_cast<std::uint64_t>(cell) * 0x9e3779b97f4a7c15ULL;
    std::size_t slot = (hash >> 32) & (slots_.size() - 1);
    while (slots_[slot] != none && cells_[slots_[slot]] != cell) slot = (slot + 1) & (slots_.size() - 1);
    return slot;
  }
  void grow() {
    slots_.assign(2 * slots_.size(), none);
    for (std::uint32_t i = 0; i < cells_.size(); ++i) slots_[slot_of(cells_[i])] = i;
  }

  std::vector<std::uint32_t> slots_;  // a power of two of them, at most half of them taken
  std::vector<CellKey> cells_;
};

/// Disjoint sets with path halving.
class Components {
 public:
  explicit Components(std::size_t size) : parent_(size) { std::iota(parent_.begin(), parent_.end(), 0u); }
  std::uint32_t root(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    const auto [low, high] = std::minmax({root(a), root(b)});
    parent_[high] = low;
  }

 private:
  std::vector<std::uint32_t> parent_;
};

void join_neighbours(const OccupiedCells& cells, int dimension, Components& components) {
  const std::int64_t reach = dimension == 3 ? 1 : 0;
  for (std::uint32_t c = 0; c < cells.cells().size(); ++c)
    for (std::int64_t k = -reach; k <= 0; ++k)
      for (std::int64_t j = -1; j <= 1; ++j)
        for (std::int64_t i = -1; i <= 1; ++i) {
          const std::int64_t shift =
              i + j * static_cast<std::int64_t>(axis_step(1)) + k * static_cast<std::int64_t>(axis_step(2));
          if (shift >= 0) continue;  // the other half joins from the other side
          const std::uint32_t other = cells.find(cells.cells()[c] + static_cast<CellKey>(shift));
          if (other != OccupiedCells::none) components.join(c, other);
        }
}

}  // namespace

std::vector<std::uint8_t> main_body(const Particles& particles, ColumnId place, std::span<const double> cell) {
  const std::size_t size = particles.size();
  const auto dimension = static_cast<std::size_t>(particles.dimension);
  assert(cell.size() == dimension);
  OccupiedCells cells;
  std::vector<std::uint32_t> cell_of(size);
  std::array<const double*, 3> x{};
  for (std::size_t k = 0; k < dimension; ++k) x[k] = particles.columns.data(place, static_cast<int>(k));
  constexpr CellKey middle = axis_step(1) / 2;  // indices may be negative
  CellKey last = ~CellKey{0};
  for (std::size_t i = 0; i < size; ++i) {
    CellKey at = 0;
    for (std::size_t k = 0; k < dimension; ++k)
      at += (static_cast<CellKey>(static_cast<std::int64_t>(std::floor(x[k][i] / cell[k]))) + middle) * axis_step(k);
    // Neighbours in memory are neighbours in space: mostly the cell is the one of the particle before.
    cell_of[i] = at == last ? cell_of[i - 1] : cells.find_or_add(at);
    last = at;
  }
  Components components(cells.cells().size());
  join_neighbours(cells, particles.dimension, components);

  struct Sum {
    double mass = 0;
    std::int32_t lowest_id = std::numeric_limits<std::int32_t>::max();
  };
  std::vector<Sum> sums(cells.cells().size());
  const double* mass = particles.columns.data(particles.mass);
  for (std::size_t i = 0; i < size; ++i) {
    cell_of[i] = components.root(cell_of[i]);
    Sum& sum = sums[cell_of[i]];
    sum.mass += mass[i];
    sum.lowest_id = std::min(sum.lowest_id, particles.id[i]);
  }
  const auto heaviest = std::max_element(sums.begin(), sums.end(), [](const Sum& a, const Sum& b) {
    return a.mass != b.mass ? a.mass < b.mass : a.lowest_id > b.lowest_id;
  });
  const auto chosen = static_cast<std::uint32_t>(heaviest - sums.begin());
  std::vector<std::uint8_t> inside(size);
  std::transform(cell_of.begin(), cell_of.end(), inside.begin(), [&](std::uint32_t c) { return c == chosen; });
  return inside;
}

double front_of_main_body(const Particles& particles, ColumnId place, std::span<const double> direction,
                          std::span<const double> cell) {
  const auto inside = main_body(particles, place, cell);
  std::array<const double*, 3> x{};
  for (std::size_t k = 0; k < direction.size(); ++k) x[k] = particles.columns.data(place, static_cast<int>(k));
  double front = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t i = 0; i < particles.size(); ++i) {
    if (!inside[i]) continue;
    double along = 0;
    for (std::size_t k = 0; k < direction.size(); ++k) along += x[k][i] * direction[k];
    if (!(front >= along)) front = along;  // true for the first one too
  }
  return front;
}

}  // namespace sluice
