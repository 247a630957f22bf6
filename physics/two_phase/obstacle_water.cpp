#include "physics/two_phase/obstacle_water.h"

#include <algorithm>

#include "core/transfer/cell_tile.h"

namespace sluice {

template <int Dim>
ObstacleWater<Dim>::ObstacleWater(const Case& definition, const PoreWater<Dim>& pores)
    : pores_(pores), active_(!definition.obstacles.empty()) {}

template <int Dim>
void ObstacleWater<Dim>::declare(Particles& particles) {
  if (!active_) return;
  Columns& columns = particles.columns;
  using enum Role;
  volume_ = columns.declare({"wet_volume", "m3", 1, derived, "Volume where the pores hold water.", false});
  pressure_column_ = columns.declare({"pressure_on_obstacles", "Pa", 1, derived, "Pore pressure above ponds.", false});
  slope_ = columns.declare({"pressure_slope", "Pa/m", Dim, derived, "Gradient of the same.", false});
  flow_divergence_ = columns.declare({"flow_divergence", "1/s", 1, derived, "Divergence of the following.", false});
  flow_ = columns.declare({"flow_at_obstacles", "m/s", Dim, derived, "Velocity relative to obstacles.", false});
}

template <int Dim>
void ObstacleWater<Dim>::begin_step(Scene<Dim>& scene) {
  if (!active_) return;
  pressure_.resize(scene.blocks, scene.shape->reach());
  parted_.resize(scene.blocks, scene.shape->reach());
  const auto& node_blocks = scene.blocks.node_blocks();
  parallel_for(node_blocks.size(), [&](std::size_t b) { scene.obstacles.surroundings(node_blocks[b], b); });
  near_.clear();
  for (const ParticleBlock<Dim>& block : scene.blocks.particle_blocks())
    near_.push_back(std::ranges::any_of(block.nodes, [&](std::int32_t n) {
      const auto b = static_cast<std::size_t>(n);
      return n >= 0 && !scene.obstacles.surroundings(node_blocks[b], b).empty();
    }));
}

// ---- the pressure on surfaces ----

template <int Dim>
void ObstacleWater<Dim>::take(Scene<Dim>& scene, const ParticleBlock<Dim>& block, double share,
                              const ExternalPressure<Dim>& outside) {
  Columns& columns = scene.particles.columns;
  const double* wet = columns.data(pores_.wet());
  FieldAtParticles<Dim> pond{columns.data(pressure_column_), {}};
  for (int a = 0; a < Dim; ++a) pond.gradient[a] = columns.data(slope_, a);
  if (outside.any_ponds()) {
    VertexTile<Dim> tile;
    outside.load(block.first_cell, scene.time, tile, ExternalPressure<Dim>::Of::ponds);
    interpolate<Dim>(tile, scene.view(block), pond);
  }
  const auto set = [&](double* to, const double* from) {
    for (std::uint32_t p = block.begin; p < block.end; ++p)
      to[p] = wet[p] * (share * from[p] - (outside.any_ponds() ? to[p] : 0));
  };
  set(pond.value, columns.data(pores_.pressure()));
  for (int a = 0; a < Dim; ++a) set(pond.gradient[a], columns.data(pores_.pressure_gradient(), a));
  const double* volume = columns.data(scene.particles.volume);
  for (std::uint32_t p = block.begin; p < block.end; ++p) columns.data(volume_)[p] = wet[p] * volume[p];
}

template <int Dim>
void ObstacleWater<Dim>::scatter(Scene<Dim>& scene, std::size_t b, const ParticleBlock<Dim>& block, double share,
                                 const ExternalPressure<Dim>& outside) {
  if (!active_) return;
  if (near_[b] == 0) {
    std::fill_n(pressure_.momentum_tile(b), pressure_.tile_size(), Lane{});
    std::fill_n(pressure_.force_tile(b), pressure_.tile_size(), Lane{});
    return;
  }
  take(scene, block, share, outside);
  const Columns& columns = scene.particles.columns;
  ScatterInput<Dim> in = scene.scatter_input(block);
  in.mass = columns.data(volume_);
  in.affine.fill(nullptr);
  in.stress.fill(columns.data(pores_.zero()));
  for (int a = 0; a < Dim; ++a) {
    in.velocity[a] = columns.data(slope_, a);
    in.stress[a] = columns.data(pressure_column_);
  }
  scene.shape->scatter(ScatterWhat::momentum_and_force, in, 0, pressure_.momentum_tile(b), pressure_.force_tile(b));
}

template <int Dim>
void ObstacleWater<Dim>::add_at_rest(Scene<Dim>& scene, const ExternalPressure<Dim>& outside,
                                     std::vector<Workspace<Dim>>& workspaces, SkeletonLoads<Dim>& loads) {
  if (!active_) return;
  for_each_block(scene, workspaces,
                 [&](std::size_t, const auto& block, Workspace<Dim>&) { take(scene, block, 1, outside); });
  loads.on_obstacles = scene.particles.columns.data(pressure_column_);
  for (int a = 0; a < Dim; ++a) loads.slope[a] = scene.particles.columns.data(slope_, a);
}

// ---- the water that does not pass ----

template <int Dim>
void ObstacleWater<Dim>::part(Scene<Dim>& scene, Items some) {
  const auto timing = scene.clock.time(Stage::nodes);
  const auto& blocks = scene.blocks.node_blocks();
  parallel_for(some.within(blocks.size()), [&](std::size_t b) {
    constexpr int lanes = motion_lanes<Dim>, change = Dim == 2 ? 2 : 4;
    const Lane* const from = scene.nodes.motion(b);
    Lane* const to = parted_.motion(b);
    for (int n = 0; n < block_nodes<Dim> * lanes; ++n) to[n] = from[n];
    auto* const numbers = reinterpret_cast<double*>(to);
    for (int n = 0; n < block_nodes<Dim>; ++n)
      for (int a = 0; a < Dim; ++a) numbers[n * lanes * lane_width + change + a] = 0;
    for (const auto& near : scene.obstacles.surroundings(blocks[b], b)) {
      const Vector<Dim> wall = scene.obstacles.velocity(near.obstacle);
      double* const own = numbers + near.node * lanes * lane_width;
      // Along the axis of a face that holds the node nothing flows: the other axes carry what leaves the surface.
      double away = 0, squared = 0;
      const auto flows = [&](int a) {
        const auto axis = static_cast<std::size_t>(a);
        return near.bound[axis] && !near.held[axis];
      };
      for (int a = 0; a < Dim; ++a) {
        if (near.bound[static_cast<std::size_t>(a)]) away += (own[a] - wall[a]) * near.normal[a];
        if (flows(a)) squared += near.normal[a] * near.normal[a];
      }
      for (int a = 0; a < Dim && squared > 1e-6; ++a) {
        if (!flows(a)) continue;
        own[change + a] = away * near.normal[a] / squared;
        own[a] -= own[change + a];
      }
    }
  });
}

template <int Dim>
void ObstacleWater<Dim>::take_divergence(Scene<Dim>& scene, std::size_t b, const ParticleBlock<Dim>& block,
                                         Workspace<Dim>& work) {
  if (!active_ || near_[b] == 0) return;
  Columns& columns = scene.particles.columns;
  std::array<double*, Dim> flow;
  for (int a = 0; a < Dim; ++a) flow[a] = columns.data(flow_, a);
  double* const divergence = columns.data(pores_.divergence());
  double* const of_flow = columns.data(flow_divergence_);
  std::copy(divergence + block.begin, divergence + block.end, of_flow + block.begin);
  parted_.load_motion(scene.blocks, b, work.motion_tile.data());
  scene.shape->gather_divergence(scene.view(block), work.motion_tile.data(), divergence, flow);
  for (std::uint32_t p = block.begin; p < block.end; ++p) of_flow[p] -= divergence[p];
}

template <int Dim>
void ObstacleWater<Dim>::add_flow(Scene<Dim>& scene, std::size_t b, const ParticleBlock<Dim>& block,
                                  Lane* vertices) const {
  if (!active_ || near_[b] == 0) return;
  const Columns& columns = scene.particles.columns;
  const BlockParticles<Dim> particles = scene.view(block);
  constexpr int corners = power(2, Dim), row = tile_width<Dim>(1);
  const double* const wet = columns.data(pores_.wet());
  const double* const volume = columns.data(scene.particles.volume);
  for (std::uint32_t p = block.begin; p < block.end; ++p) {
    Vector<Dim> in_cell;
    int first = 0;
    for (int a = Dim - 1; a >= 0; --a) {
      std::int32_t number = 0;
      locate_in_tile<Dim, true>(particles, a, p, 1, &number, &in_cell[a]);
      first = first * row + number;
    }
    for (int m = 0; m < corners; ++m) {
      double outflow = 0, value = 1;
      int at = first;
      for (int a = 0; a < Dim; ++a) {
        double slope = ((m >> a & 1) != 0 ? 1 : -1) / particles.grid->cell[a];
        for (int o = 0; o < Dim; ++o)
          if (o != a) slope *= (m >> o & 1) != 0 ? in_cell[o] : 1 - in_cell[o];
        outflow -= slope * columns.data(flow_, a)[p];
        at += (m >> a & 1) != 0 ? power(row, a) : 0;
        value *= (m >> a & 1) != 0 ? in_cell[a] : 1 - in_cell[a];
      }
      const double held = wet[p] * volume[p];
      vertices[at] += held * Lane{0, 0, outflow, outflow - value * columns.data(flow_divergence_)[p]};
    }
  }
}

template class ObstacleWater<2>;
template class ObstacleWater<3>;

}  // namespace sluice
