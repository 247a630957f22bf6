/// The stages of a step that every physics shares, in the textbook's words. Equation numbers: docs/theory.md.
#pragma once

#include <vector>

#include "core/parallel/parallel.h"
#include "core/simulation/scene.h"

namespace sluice {

/// Working memory of one thread.
template <int Dim>
struct Workspace {
  LaneArray motion_tile;
  std::vector<double> numbers;
  StrainIncrements<Dim> strain;  ///< views into `numbers`, long enough for the largest block
};

/// Cells that a particle may travel between sorts: not quite the margin of the tiles, for `Scene::travelled` is a sum
/// with round-off.
inline constexpr double travel_allowance = 0.999 * tile_margin;

/// Sorts the particles into blocks if one of them may have left the tile of its block; true if it did.
template <int Dim>
bool activate_blocks(Scene<Dim>& scene);

// Each of the following works on all blocks, or on `some` of them: see Sweep.

/// Particles to nodes, eqs. (14)-(16): fills the tiles of the blocks.
template <int Dim>
void scatter(Scene<Dim>& scene, ScatterWhat what, double impulse_dt = 0, Items some = everything);
/// The same for one block, to be called in parallel; `input`, for all its particles, may differ from
/// Scene::scatter_input.
template <int Dim>
void scatter_block(Scene<Dim>& scene, ScatterWhat what, double impulse_dt, std::size_t b,
                   const ScatterInput<Dim>& input);

/// v = p / m on one block, dv = 0.
template <int Dim>
void divide_by_mass(const NodeBlock<Dim>& nodes, const Lane* momentum, Lane* motion);

/// Sums the tiles and divides: v = p / m, with the velocities that faces and obstacles fix, eq. (17). `moment` says
/// whose velocities they are, those before this step or the new ones.
template <int Dim>
void velocity_from_momentum(Scene<Dim>& scene, Moment moment, Items some = everything);

/// The area of the surface of the material, by node and with its normal, eq. (18b): to be called with every scatter of
/// forces in a scene that wants it.
template <int Dim>
void scatter_surface(Scene<Dim>& scene, Items some = everything);

/// v_new = v + kick (f / m + g), with faces, obstacles and their friction, eq. (18). With `collect_force` the force
/// tiles are summed; without, the momentum holds the impulse already. `without_friction`, or null, has in its force
/// tiles a part of all forces, whose pressure on faces, obstacles and other bodies gives no friction. `at_obstacles`,
/// or null, has a pressure q as Obstacles::press wants it, slopes in the momentum tiles: where the forces have -q in
/// their stress, what it does to the nodes around obstacles becomes what its gradient does.
template <int Dim>
void advance_nodes(Scene<Dim>& scene, double kick, bool collect_momentum, bool collect_force, Items some = everything,
                   FieldsByBody<Dim>* without_friction = nullptr, NodeFields<Dim>* at_obstacles = nullptr);

/// The same once more, from the momentum that the nodes have, with the force tiles added to the forces that they have:
/// a correction, for example by a pressure that was not known before. The pressure `at_obstacles` takes the place of
/// the one before.
template <int Dim>
void correct_nodes(Scene<Dim>& scene, double kick, FieldsByBody<Dim>* without_friction, Items some = everything,
                   NodeFields<Dim>* at_obstacles = nullptr);

/// Calls body(number of the block, block, workspace of the thread) for every block of particles, in parallel.
template <int Dim, class Body>
void for_each_block(Scene<Dim>& scene, std::vector<Workspace<Dim>>& workspaces, const Body& body,
                    Items some = everything) {
  prepare(scene, workspaces);
  parallel_for(some.within(scene.blocks.particle_blocks().size()), [&](std::size_t b, int thread) {
    body(b, scene.blocks.particle_blocks()[b], workspaces[static_cast<std::size_t>(thread)]);
  });
}

/// One workspace a thread, each large enough for any block.
template <int Dim>
void prepare(const Scene<Dim>& scene, std::vector<Workspace<Dim>>& workspaces);

/// Calls visit(body, particles, first) for the particles of a block: all of them for body 0; or, with bodies that do
/// not stick together, run by run those of one body. `first` is the number of the first of them in the block.
template <int Dim, class Visit>
void for_bodies(const Scene<Dim>& scene, const ParticleBlock<Dim>& block, const Visit& visit) {
  BlockParticles<Dim> run = scene.view(block);
  if (scene.contact == nullptr) {
    visit(0, run, 0u);
    return;
  }
  scene.contact->for_runs(scene.blocks, block, [&](int body, std::uint32_t begin, std::uint32_t end) {
    run.begin = begin, run.end = end;
    visit(body, run, begin - block.begin);
  });
}

/// Calls visit(body) for the bodies that have nodes in a block of them.
template <int Dim, class Visit>
void for_bodies_of_nodes(const Scene<Dim>& scene, std::size_t node_block, const Visit& visit) {
  for (int g = 0; g < scene.bodies(); ++g)
    if (scene.contact == nullptr || scene.contact->has(node_block, g)) visit(g);
}

/// Calls gather(particles, first), as for_bodies does, with the motion of their nodes in `tile`.
template <int Dim, class Gather>
void from_nodes(Scene<Dim>& scene, std::size_t b, const ParticleBlock<Dim>& block, Lane* tile, const Gather& gather) {
  for_bodies(scene, block, [&](int body, const BlockParticles<Dim>& particles, std::uint32_t first) {
    scene.nodes_of(body).load_motion(scene.blocks, b, tile);
    gather(particles, first);
  });
}

/// A body may have several runs of particles in a block: the first fills a tile of its nodes, as kernels do, the others
/// are added to it.
class TilesOfRuns {
 public:
  explicit TilesOfRuns(std::size_t tile_size) : size_(tile_size) {}
  bool has_begun(int body) const { return (begun_ >> body & 1) != 0; }
  /// Calls fill(tiles) with the tiles, or with others whose content then goes to them. Null tiles stay null.
  template <std::size_t count, class Fill>
  void add_run(int body, const std::array<Lane*, count>& tiles, const Fill& fill) {
    static_assert(count <= most);
    if (!has_begun(body)) {
      fill(tiles);
    } else {
      std::array<Lane*, count> more;
      for (std::size_t t = 0; t < count; ++t) more[t] = tiles[t] == nullptr ? nullptr : scratch(t);
      fill(more);
      for (std::size_t t = 0; t < count; ++t)
        for (std::size_t n = 0; tiles[t] != nullptr && n < size_; ++n) tiles[t][n] += more[t][n];
    }
  }
  void begin(int body) { begun_ |= std::uint64_t{1} << body; }

 private:
  static constexpr std::size_t most = 2;
  Lane* scratch(std::size_t t) const {
    thread_local std::array<LaneArray, most> memory;
    memory[t].resize(size_);
    return memory[t].data();
  }
  std::size_t size_;
  std::uint64_t begun_ = 0;
};

/// Calls fill(body, particles, tile) for the particles of a block, as for_bodies does, with their body's tile, which is
/// tile_of(body); bodies that have no particles there get zeros.
template <int Dim, class TileOf, class Fill>
void fill_tiles_of_bodies(const Scene<Dim>& scene, const ParticleBlock<Dim>& block, const TileOf& tile_of,
                          const Fill& fill) {
  TilesOfRuns runs(scene.nodes.tile_size());
  for_bodies(scene, block, [&](int body, const BlockParticles<Dim>& particles, std::uint32_t) {
    runs.add_run(body, std::array<Lane*, 1>{tile_of(body)},
                 [&](const std::array<Lane*, 1>& tile) { fill(body, particles, tile[0]); });
    runs.begin(body);
  });
  for (int body = 0; body < scene.bodies(); ++body)
    if (!runs.has_begun(body)) std::fill_n(tile_of(body), scene.nodes.tile_size(), Lane{});
}

/// Nodes to particles: velocity, position, affine field, eqs. (19)-(21). Positions go to `position_column`, domains
/// that deform to `domain_column`; without a column they stay as they are.
template <int Dim>
MotionUpdate<Dim> motion_update(Scene<Dim>& scene, double dt, ColumnId position_column, ColumnId domain_column = {});

}  // namespace sluice
