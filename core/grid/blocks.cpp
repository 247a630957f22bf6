#include "core/grid/blocks.h"

#include <algorithm>
#include <cassert>
#include <numeric>
#include <unordered_map>

#include "core/parallel/parallel.h"

namespace sluice {

namespace {

/// A block's place as one number, last axis first, so that numbers follow the rows of the grid.
template <int Dim>
std::int64_t key_of(const Index<Dim>& block) {
  constexpr std::int64_t range = std::int64_t{1} << 20;
  std::int64_t key = 0;
  for (int a = Dim - 1; a >= 0; --a) key = key * range + (block[a] + 1);
  return key;
}

/// The particle's block, and its cell within the block, first axis fastest.
struct Address {
  std::int64_t block;
  int cell;
};

template <int Dim>
class Addresses {
 public:
  Addresses(const Particles& particles, const GridGeometry<Dim>& grid) : grid_(grid) {
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
    return {key_of<Dim>(block), within};
  }

 private:
  const GridGeometry<Dim>& grid_;
  std::array<const double*, Dim> x_;
};

template <int Dim>
Index<Dim> block_of(std::int64_t key) {
  constexpr std::int64_t range = std::int64_t{1} << 20;
  Index<Dim> block;
  for (int a = 0; a < Dim; ++a) {
    block[a] = static_cast<int>(key % range) - 1;
    key /= range;
  }
  return block;
}

/// Calls visit(position in the neighbourhood, shift) for every shift in {-1, 0, 1}^Dim, first axis fastest.
template <int Dim, class Visit>
void for_neighbourhood(const Visit& visit) {
  for (int n = 0; n < neighbourhood<Dim>; ++n) {
    Index<Dim> shift;
    for (int a = 0, rest = n; a < Dim; ++a, rest /= 3) shift[a] = rest % 3 - 1;
    visit(n, shift);
  }
}

}  // namespace

template <int Dim>
void Blocks<Dim>::sort(Particles& particles, const GridGeometry<Dim>& grid, int degree) {
  const std::size_t count = particles.size();
  const Addresses<Dim> address_of(particles, grid);
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
    block.first_cell = block_of<Dim>(keys[r]);
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
  connect(degree);
}

template <int Dim>
void Blocks<Dim>::connect(int degree) {
  constexpr int width = block_width<Dim>;
  const int tile = tile_width<Dim>(degree);
  std::map<std::int64_t, std::int32_t> slot;  // ordered, so that node blocks follow the rows of the grid
  const auto shifted = [](const ParticleBlock<Dim>& block, const Index<Dim>& shift) {
    Index<Dim> b;
    for (int a = 0; a < Dim; ++a) b[a] = block.first_cell[a] / width + shift[a];
    return b;
  };
  for (const auto& block : particle_blocks_)
    for_neighbourhood<Dim>([&](int, const Index<Dim>& shift) { slot.emplace(key_of<Dim>(shifted(block, shift)), 0); });
  node_blocks_.clear();
  for (auto& [key, number] : slot) {
    number = static_cast<std::int32_t>(node_blocks_.size());
    NodeBlock<Dim> nodes{};
    nodes.first_node = block_of<Dim>(key);
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
      const std::int32_t number = slot.at(key_of<Dim>(shifted(block, shift)));
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
void Blocks<Dim>::restore(const std::vector<std::int64_t>& record, const Particles& particles, int degree) {
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
  connect(degree);
}

template class Blocks<2>;
template class Blocks<3>;

}  // namespace sluice
