#include "core/grid/blocks.h"

#include <algorithm>
#include <cassert>
#include <numeric>
#include <unordered_map>

#include "core/parallel/parallel.h"

namespace sluice {

namespace {

/// Gives each block a number. Numbers follow the longest axis of the grid slowest: consecutive blocks then form thin
/// slices, and a sweep over them (core/simulation/sweep.h) has few blocks between a block and its neighbours. Periodic
/// axes are the fastest: along one of them the last block is a neighbour of the first.
template <int Dim>
class Numbering {
 public:
  explicit Numbering(const GridGeometry<Dim>& grid) {
    std::iota(axes_.begin(), axes_.end(), 0);
    std::stable_sort(axes_.begin(), axes_.end(), [&](int a, int b) {
      return grid.periodic[a] != grid.periodic[b] ? grid.periodic[a] : grid.cells[a] < grid.cells[b];
    });
  }
  std::int64_t key(const Index<Dim>& block) const {
    std::int64_t key = 0;
    for (int a = Dim - 1; a >= 0; --a) key = key * range + (block[axes_[a]] + 1);
    return key;
  }
  Index<Dim> block(std::int64_t key) const {
    Index<Dim> block;
    for (int a = 0; a < Dim; ++a) {
      block[axes_[a]] = static_cast<int>(key % range) - 1;
      key /= range;
    }
    return block;
  }

 private:
  static constexpr std::int64_t range = std::int64_t{1} << 20;
  Index<Dim> axes_;  // fastest first
};

/// The particle's block, and its cell within the block, first axis fastest.
struct Address {
  std::int64_t block;
  int cell;
};

template <int Dim>
class Addresses {
 public:
  Addresses(const Particles& particles, const GridGeometry<Dim>& grid, const Numbering<Dim>& numbering)
      : grid_(grid), numbering_(numbering) {
    for (int a = 0; a < Dim; ++a) x_[a] = particles.columns.data(particles.position, a);
  }
  Address operator()(std::size_t p) const {
    Vector<Dim> x;
    for (int a = 0; a < Dim; ++a) x[a] = x_[a][p];
    Index<Dim> cell = grid_.cell_of(x), block;
    int within = 0;
    for (int a = Dim - 1; a >= 0; --a) {
      block[a] = cell[a] / block_width<Dim>;
      within = within * block_width<Dim> + cell[a] % block_width<Dim>;
    }
    return {numbering_.key(block), within};
  }

 private:
  const GridGeometry<Dim>& grid_;
  const Numbering<Dim>& numbering_;
  std::array<const double*, Dim> x_;
};

/// Calls visit(position in the neighbourhood, shift) for every shift in {-1, 0, 1}^Dim, first axis fastest.
template <int Dim, class Visit>
void for_neighbourhood(const Visit& visit) {
  for (int n = 0; n < neighbourhood<Dim>; ++n) {
    Index<Dim> shift;
    for (int a = 0, rest = n; a < Dim; ++a, rest /= 3) shift[a] = rest % 3 - 1;
    visit(n, shift);
  }
}

/// Brings particles that have crossed an end of a periodic axis back into the grid, and counts it.
template <int Dim>
void bring_back(Particles& particles, const GridGeometry<Dim>& grid) {
  for (int a = 0; a < Dim; ++a) {
    if (!grid.periodic[a]) continue;
    double* const x = particles.columns.data(particles.position, a);
    double* const crossings = particles.columns.data(particles.crossings, a);
    const double low = grid.min[a], period = grid.max[a] - low;
    parallel_for(particles.size(), [&](std::size_t p) {
      const double turns = std::floor((x[p] - low) / period);
      if (turns == 0) return;
      x[p] -= turns * period;
      crossings[p] += turns;
    });
  }
}

}  // namespace

template <int Dim>
void Blocks<Dim>::sort(Particles& particles, const GridGeometry<Dim>& grid, int reach) {
  bring_back(particles, grid);
  const std::size_t count = particles.size();
  const Numbering<Dim> numbering(grid);
  const Addresses<Dim> address_of(particles, grid, numbering);
  std::vector<Address> address(count);
  parallel_for(count, [&](std::size_t p) { address[p] = address_of(p); });

  // Ranks of the blocks in use. Neighbours in memory are mostly in the same block: look up changes only.
  std::unordered_map<std::int64_t, std::uint32_t> rank;
  for (std::size_t p = 0; p < count; ++p)
    if (p == 0 || address[p].block != address[p - 1].block) rank.emplace(address[p].block, 0);
  std::vector<std::int64_t> keys;
  for (const auto& entry : rank) keys.push_back(entry.first);
  std::sort(keys.begin(), keys.end());
  for (std::size_t r = 0; r < keys.size(); ++r) rank[keys[r]] = static_cast<std::uint32_t>(r);

  // Counting sort by (block, material), stable; then each such batch by cell.
  const std::size_t materials = std::max<std::size_t>(1, particles.material_names.size());
  std::vector<std::uint32_t> bin(count), start(keys.size() * materials + 1, 0), order(count);
  std::uint32_t current = 0;
  for (std::size_t p = 0; p < count; ++p) {
    if (p == 0 || address[p].block != address[p - 1].block) current = rank[address[p].block];
    bin[p] = current * static_cast<std::uint32_t>(materials) + static_cast<std::uint32_t>(particles.material[p]);
    ++start[bin[p] + 1];
  }
  std::partial_sum(start.begin(), start.end(), start.begin());
  std::vector<std::uint32_t> next(start.begin(), start.end() - 1);
  for (std::size_t p = 0; p < count; ++p) order[next[bin[p]]++] = static_cast<std::uint32_t>(p);
  parallel_for(start.size() - 1, [&](std::size_t b) {
    std::stable_sort(order.begin() + start[b], order.begin() + start[b + 1],
                     [&](std::uint32_t p, std::uint32_t q) { return address[p].cell < address[q].cell; });
  });
  particles.permute(order);

  particle_blocks_.clear();
  batches_.clear();
  for (std::size_t r = 0; r < keys.size(); ++r) {
    ParticleBlock<Dim> block{};
    block.first_cell = numbering.block(keys[r]);
    for (int& c : block.first_cell) c *= block_width<Dim>;
    block.begin = start[r * materials];
    block.end = start[(r + 1) * materials];
    block.first_batch = static_cast<std::uint32_t>(batches_.size());
    for (std::size_t m = 0; m < materials; ++m)
      if (start[r * materials + m] != start[r * materials + m + 1])
        batches_.push_back({start[r * materials + m], start[r * materials + m + 1], static_cast<std::int32_t>(m)});
    block.last_batch = static_cast<std::uint32_t>(batches_.size());
    particle_blocks_.push_back(block);
  }
  connect(grid, reach);
}

template <int Dim>
void Blocks<Dim>::connect(const GridGeometry<Dim>& grid, int reach) {
  constexpr int width = block_width<Dim>;
  const int tile = tile_width<Dim>(reach);
  const Numbering<Dim> numbering(grid);
  std::map<std::int64_t, std::int32_t> slot;  // ordered, so that node blocks are numbered as particle blocks are
  const auto shifted = [&](const ParticleBlock<Dim>& block, const Index<Dim>& shift) {
    Index<Dim> cell = block.first_cell;
    for (int a = 0; a < Dim; ++a) cell[a] += width * shift[a];
    cell = grid.wrapped(cell);
    for (int& i : cell) i = i < 0 ? -1 : i / width;
    return cell;
  };
  for (const auto& block : particle_blocks_)
    for_neighbourhood<Dim>(
        [&](int, const Index<Dim>& shift) { slot.emplace(numbering.key(shifted(block, shift)), 0); });
  node_blocks_.clear();
  for (auto& [key, number] : slot) {
    number = static_cast<std::int32_t>(node_blocks_.size());
    NodeBlock<Dim> nodes{};
    nodes.first_node = numbering.block(key);
    for (int& i : nodes.first_node) i *= width;
    nodes.low.fill(width);
    nodes.high.fill(0);
    nodes.particles.fill(-1);
    node_blocks_.push_back(nodes);
  }
  largest_block_ = 0;
  for (std::size_t b = 0; b < particle_blocks_.size(); ++b) {
    auto& block = particle_blocks_[b];
    largest_block_ = std::max<std::size_t>(largest_block_, block.end - block.begin);
    for_neighbourhood<Dim>([&](int n, const Index<Dim>& shift) {
      const std::int32_t number = slot.at(numbering.key(shifted(block, shift)));
      block.nodes[static_cast<std::size_t>(n)] = number;
      auto& nodes = node_blocks_[static_cast<std::size_t>(number)];
      nodes.particles[static_cast<std::size_t>(neighbourhood<Dim> - 1 - n)] = static_cast<std::int32_t>(b);
      for (int a = 0; a < Dim; ++a) {  // the tile's part of this node block: see NodeFields::collect
        const int offset = width * shift[a] + tile_margin;
        nodes.low[a] = std::min(nodes.low[a], std::max(0, -offset));
        nodes.high[a] = std::max(nodes.high[a], std::min(width, tile - offset));
      }
    });
  }
  note_needs();
}

template <int Dim>
void Blocks<Dim>::note_needs() {
  const auto note = [](const auto& blocks, const auto& neighbours, std::vector<std::size_t>& needed) {
    needed.clear();
    std::int32_t last = -1;
    for (const auto& block : blocks) {
      for (const std::int32_t number : block.*neighbours) last = std::max(last, number);
      needed.push_back(static_cast<std::size_t>(last + 1));
    }
  };
  note(particle_blocks_, &ParticleBlock<Dim>::nodes, nodes_needed_);
  note(node_blocks_, &NodeBlock<Dim>::particles, particles_needed_);
}

template <int Dim>
std::size_t Blocks<Dim>::ready(const std::vector<std::size_t>& needed, std::size_t done) {
  return static_cast<std::size_t>(std::upper_bound(needed.begin(), needed.end(), done) - needed.begin());
}

template <int Dim>
std::vector<std::int64_t> Blocks<Dim>::record() const {
  std::vector<std::int64_t> numbers;
  for (const auto& block : particle_blocks_) {
    for (const int c : block.first_cell) numbers.push_back(c);
    numbers.push_back(block.end);
  }
  return numbers;
}

template <int Dim>
void Blocks<Dim>::restore(const std::vector<std::int64_t>& record, const Particles& particles,
                          const GridGeometry<Dim>& grid, int reach) {
  particle_blocks_.clear();
  batches_.clear();
  std::uint32_t p = 0;
  for (std::size_t i = 0; i + Dim < record.size(); i += Dim + 1) {
    ParticleBlock<Dim> block{};
    for (int a = 0; a < Dim; ++a) block.first_cell[a] = static_cast<int>(record[i + static_cast<std::size_t>(a)]);
    block.begin = p;
    block.end = static_cast<std::uint32_t>(record[i + Dim]);
    block.first_batch = static_cast<std::uint32_t>(batches_.size());
    for (; p < block.end; ++p) {
      const std::int32_t material = particles.material[p];
      if (p == block.begin || batches_.back().material != material) batches_.push_back({p, p, material});
      batches_.back().end = p + 1;
    }
    block.last_batch = static_cast<std::uint32_t>(batches_.size());
    particle_blocks_.push_back(block);
  }
  connect(grid, reach);
}

template class Blocks<2>;
template class Blocks<3>;

}  // namespace sluice
