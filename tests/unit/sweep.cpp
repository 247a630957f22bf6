/// Sweep: every stage meets every block once, in order, and not before what it reads is done.
#include "core/simulation/sweep.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace sluice {
namespace {

/// Blocks of particles strewn over part of an oblong grid, so that the active blocks have a ragged outline.
template <int Dim>
Blocks<Dim> ragged_blocks() {
  GridGeometry<Dim> g;
  g.cell.fill(1);
  for (int a = 0; a < Dim; ++a) g.cells[a] = a == 0 ? 120 : 30;
  for (int a = 0; a < Dim; ++a) g.max[a] = g.cells[a];
  Particles particles(Dim);
  particles.resize(150);
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (double& x : particles.columns.values(particles.position, 0)) x = 120 * uniform(generator);
  for (int a = 1; a < Dim; ++a)
    for (double& x : particles.columns.values(particles.position, a)) x = 30 * uniform(generator) * uniform(generator);
  Blocks<Dim> blocks;
  blocks.sort(particles, g, 2);
  return blocks;
}

/// A stage's record: how many of its blocks are done.
struct Progress {
  std::size_t done = 0;
  void take(Items some) {
    EXPECT_EQ(some.begin, done);
    EXPECT_GT(some.end, some.begin);
    done = some.end;
  }
};

template <int Dim>
void expect_order(std::size_t pace) {
  const Blocks<Dim> blocks = ragged_blocks<Dim>();
  const auto& particles = blocks.particle_blocks();
  const auto& nodes = blocks.node_blocks();
  Progress scattered, summed, gathered, again;
  int turns = 0;
  // Neighbours are numbers of blocks, -1 for none; those below `done` have been met.
  const auto expect_met = [](const auto& neighbours, std::size_t done) {
    for (const std::int32_t number : neighbours) ASSERT_LT(number, static_cast<std::int32_t>(done));
  };
  Sweep<Dim> sweep(blocks);
  sweep.over_particles([&](Items some) { scattered.take(some), ++turns; });
  sweep.over_nodes([&](Items some) {
    summed.take(some);
    for (std::size_t n = some.begin; n < some.end; ++n) expect_met(nodes[n].particles, scattered.done);
  });
  sweep.over_particles([&](Items some) {
    gathered.take(some);
    for (std::size_t b = some.begin; b < some.end; ++b) expect_met(particles[b].nodes, summed.done);
  });
  sweep.over_particles([&](Items some) {
    again.take(some);
    for (std::size_t b = some.begin; b < some.end; ++b)
      for (const std::int32_t n : particles[b].nodes)
        expect_met(nodes[static_cast<std::size_t>(n)].particles, gathered.done);
  });
  sweep.run(pace);
  EXPECT_EQ(scattered.done, particles.size());
  EXPECT_EQ(summed.done, nodes.size());
  EXPECT_EQ(gathered.done, particles.size());
  EXPECT_EQ(again.done, particles.size());
  EXPECT_EQ(static_cast<std::size_t>(turns), (particles.size() + pace - 1) / pace);
}

TEST(Sweep, MeetsEveryBlockOnceAndAfterItsNeighbours) {
  for (const std::size_t pace : {1u, 3u, 10u, 1000u}) {
    expect_order<2>(pace);
    expect_order<3>(pace);
  }
}

// The point of it: the last stage begins long before the first one ends. The grid is oblong and blocks are numbered
// across it, so no more than a few slices of it are in work.
TEST(Sweep, KeepsFewBlocksInWork) {
  const Blocks<2> blocks = ragged_blocks<2>();
  std::size_t scattered = 0, most = 0;
  Sweep<2> sweep(blocks);
  sweep.over_particles([&](Items some) { scattered = some.end; });
  sweep.over_nodes([](Items) {});
  sweep.over_particles([&](Items some) { most = std::max(most, scattered - some.begin); });
  sweep.run(1);
  EXPECT_LE(most, 3u * 4u) << "more than three slices of at most four blocks";
}

TEST(Sweep, NoBlocksNoTurns) {
  const Blocks<2> blocks;
  Sweep<2> sweep(blocks);
  sweep.over_particles([](Items) { FAIL(); });
  sweep.run();
}

}  // namespace
}  // namespace sluice
