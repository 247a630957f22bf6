/// Blocks: sorting particles into blocks, neighbours, and the record of a checkpoint.
#include "core/grid/blocks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace sluice {
namespace {

template <int Dim>
GridGeometry<Dim> grid() {
  GridGeometry<Dim> g;
  g.min.fill(-3);
  g.cell.fill(0.5);
  g.cells.fill(Dim == 2 ? 60 : 25);
  for (int a = 0; a < Dim; ++a) g.max[a] = g.min[a] + g.cell[a] * g.cells[a];
  return g;
}

/// Random points, some of them on the faces of the grid, of three materials.
template <int Dim>
Particles scattered(const GridGeometry<Dim>& g, std::size_t count) {
  Particles particles(Dim);
  particles.material_names = {"a", "b", "c"};
  particles.resize(count);
  std::mt19937 generator(5);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (std::size_t p = 0; p < count; ++p) {
    particles.id[p] = static_cast<std::int32_t>(p);
    particles.material[p] = static_cast<std::int32_t>(generator() % 3);
    for (int a = 0; a < Dim; ++a) {
      const double share = uniform(generator);
      particles.columns.data(particles.position, a)[p] = g.min[a] + (share < 0.05   ? 0
                                                                     : share > 0.95 ? 1
                                                                                    : share) *
                                                                        (g.max[a] - g.min[a]);
    }
    particles.columns.data(particles.mass)[p] = static_cast<double>(p);
  }
  return particles;
}

template <int Dim>
Index<Dim> cell_at(const Particles& particles, const GridGeometry<Dim>& g, std::size_t p) {
  Vector<Dim> x;
  for (int a = 0; a < Dim; ++a) x[a] = particles.columns.data(particles.position, a)[p];
  return g.cell_of(x);
}

template <int Dim>
void expect_sorted(int degree) {
  const auto g = grid<Dim>();
  Particles particles = scattered<Dim>(g, 5000);
  Blocks<Dim> blocks;
  blocks.sort(particles, g, degree);

  // Every particle is there once, and took its columns along.
  std::vector<std::int32_t> ids = particles.id;
  std::sort(ids.begin(), ids.end());
  for (std::size_t p = 0; p < ids.size(); ++p) ASSERT_EQ(ids[p], static_cast<std::int32_t>(p));
  for (std::size_t p = 0; p < ids.size(); ++p) ASSERT_EQ(particles.columns.data(particles.mass)[p], particles.id[p]);

  // Every particle lies in its block; batches cover a block and hold one material each.
  std::uint32_t next = 0;
  std::size_t largest = 0;
  for (const auto& block : blocks.particle_blocks()) {
    ASSERT_EQ(block.begin, next);
    ASSERT_GT(block.end, block.begin) << "an empty block";
    for (std::uint32_t p = block.begin; p < block.end; ++p) {
      const auto cell = cell_at<Dim>(particles, g, p);
      for (int a = 0; a < Dim; ++a) {
        ASSERT_GE(cell[a], block.first_cell[a]);
        ASSERT_LT(cell[a], block.first_cell[a] + block_width<Dim>);
      }
    }
    std::uint32_t at = block.begin;
    for (std::uint32_t b = block.first_batch; b < block.last_batch; ++b) {
      const Batch& batch = blocks.batches()[b];
      ASSERT_EQ(batch.begin, at);
      for (at = batch.begin; at < batch.end; ++at) ASSERT_EQ(particles.material[at], batch.material);
    }
    ASSERT_EQ(at, block.end);
    next = block.end;
    largest = std::max<std::size_t>(largest, block.end - block.begin);
  }
  EXPECT_EQ(next, particles.size());
  EXPECT_EQ(blocks.largest_block(), largest);

  // Neighbours are where the shifts say, and know each other.
  for (std::size_t b = 0; b < blocks.particle_blocks().size(); ++b) {
    const auto& block = blocks.particle_blocks()[b];
    for (std::size_t n = 0; n < static_cast<std::size_t>(neighbourhood<Dim>); ++n) {
      const auto& nodes = blocks.node_blocks()[static_cast<std::size_t>(block.nodes[n])];
      int rest = static_cast<int>(n);
      for (int a = 0; a < Dim; ++a, rest /= 3)
        ASSERT_EQ(nodes.first_node[a], block.first_cell[a] + block_width<Dim> * (rest % 3 - 1));
      ASSERT_EQ(nodes.particles[static_cast<std::size_t>(neighbourhood<Dim>) - 1 - n], static_cast<std::int32_t>(b));
    }
  }
}

TEST(Blocks, SortPutsEveryParticleIntoItsBlock) {
  for (const int degree : {1, 2}) {
    expect_sorted<2>(degree);
    expect_sorted<3>(degree);
  }
}

// Sorting what is sorted changes nothing: the order within a cell is kept.
TEST(Blocks, SortIsStable) {
  const auto g = grid<2>();
  Particles particles = scattered<2>(g, 3000);
  Blocks<2> blocks;
  blocks.sort(particles, g, 2);
  const auto ids = particles.id;
  blocks.sort(particles, g, 2);
  EXPECT_EQ(particles.id, ids);
}

template <int Dim>
void expect_round_trip() {
  const auto g = grid<Dim>();
  Particles particles = scattered<Dim>(g, 2000);
  Blocks<Dim> blocks, again;
  blocks.sort(particles, g, 2);
  // Particles wander; the record is of what was.
  for (double& x : particles.columns.values(particles.position)) x += 0.3;
  again.restore(blocks.record(), particles, g, 2);
  EXPECT_EQ(again.record(), blocks.record());
  ASSERT_EQ(again.particle_blocks().size(), blocks.particle_blocks().size());
  ASSERT_EQ(again.batches().size(), blocks.batches().size());
  ASSERT_EQ(again.node_blocks().size(), blocks.node_blocks().size());
  EXPECT_EQ(again.largest_block(), blocks.largest_block());
  for (std::size_t b = 0; b < blocks.particle_blocks().size(); ++b) {
    const auto &u = blocks.particle_blocks()[b], &v = again.particle_blocks()[b];
    EXPECT_EQ(u.first_cell, v.first_cell);
    EXPECT_EQ(u.begin, v.begin);
    EXPECT_EQ(u.end, v.end);
    EXPECT_EQ(u.first_batch, v.first_batch);
    EXPECT_EQ(u.last_batch, v.last_batch);
    EXPECT_EQ(u.nodes, v.nodes);
  }
  for (std::size_t b = 0; b < blocks.batches().size(); ++b) {
    EXPECT_EQ(again.batches()[b].end, blocks.batches()[b].end);
    EXPECT_EQ(again.batches()[b].material, blocks.batches()[b].material);
  }
}

TEST(Blocks, RecordAndRestore) {
  expect_round_trip<2>();
  expect_round_trip<3>();
}

TEST(Blocks, NoParticlesNoBlocks) {
  Particles particles(2);
  Blocks<2> blocks;
  blocks.sort(particles, grid<2>(), 2);
  EXPECT_TRUE(blocks.particle_blocks().empty());
  EXPECT_TRUE(blocks.node_blocks().empty());
}

}  // namespace
}  // namespace sluice
