#include "core/simulation/velocity_filter.h"

#include <algorithm>

namespace sluice {

namespace {

/// (-1)^(k+1) m! / (k! (m - k)!)
double coefficient(int m, int k) {
  double c = k % 2 == 1 ? 1 : -1;
  for (int i = 1; i <= k; ++i) c *= static_cast<double>(m - k + i) / i;
  return c;
}

}  // namespace

template <int Dim>
void VelocityFilter<Dim>::resize(const Scene<Dim>& scene) {
  nodes_.resize(static_cast<std::size_t>(scene.bodies()));
  for (auto& of_body : nodes_)
    for (auto& nodes : of_body) nodes.resize(scene.blocks, scene.shape->reach());
}

/// A face that fixes a velocity fixes it in every u_k. (Obstacles do not: they would take momentum that is not in their
/// forces.)
template <int Dim>
void VelocityFilter<Dim>::take(Scene<Dim>& scene, std::size_t node_block, int body, const Lane* momentum,
                               const Faces<Dim>& faces) {
  const auto& block = scene.blocks.node_blocks()[node_block];
  Lane* const motion = nodes_[static_cast<std::size_t>(body)][0].motion(node_block);
  divide_by_mass<Dim>(block, momentum, motion);
  faces.fix(block, motion, Moment::before);
}

template <int Dim>
void VelocityFilter<Dim>::add(Sweep<Dim>& sweep, Scene<Dim>& scene) {
  if (!wanted(scene)) return;
  resize(scene);
  sweep.over_nodes([this, &scene](Items some) {
    const auto timing = scene.clock.time(Stage::nodes);
    parallel_for(some.within(scene.blocks.node_blocks().size()), [&](std::size_t b) {
      for_bodies_of_nodes(scene, b,
                          [&](int body) { take(scene, b, body, scene.nodes_of(body).momentum(b), scene.faces); });
    });
  });
  Targets targets;
  for (std::size_t g = 0; g < nodes_.size(); ++g) targets.push_back(&scene.nodes_of(static_cast<int>(g)));
  add_maps(sweep, scene, scene.particles.mass, scene.faces, targets);
}

template <int Dim>
void VelocityFilter<Dim>::add_maps(Sweep<Dim>& sweep, Scene<Dim>& scene, ColumnId mass, const Faces<Dim>& faces,
                                   const Targets& targets) {
  for (int k = 2; k <= scene.scheme.xpic_order; ++k) {
    sweep.over_particles([this, &scene, k, mass](Items some) { map(scene, k, mass, some); });
    sweep.over_nodes([this, &scene, k, &faces, targets](Items some) { collect(scene, k, faces, targets, some); });
  }
}

/// From u_{k-1} to the tiles of u_k.
template <int Dim>
void VelocityFilter<Dim>::map(Scene<Dim>& scene, int k, ColumnId mass, Items some) {
  const auto timing = scene.clock.time(Stage::gather);
  const std::size_t from = static_cast<std::size_t>(k % 2), to = 1 - from;
  const double* const masses = scene.particles.columns.data(mass);
  const auto body = [&](std::size_t b, const ParticleBlock<Dim>& block, Workspace<Dim>& work) {
    fill_tiles_of_bodies(
        scene, block, [&](int own) { return nodes_[static_cast<std::size_t>(own)][to].momentum_tile(b); },
        [&](int own, const BlockParticles<Dim>& particles, Lane* tile) {
          nodes_[static_cast<std::size_t>(own)][from].load_motion(scene.blocks, b, work.motion_tile.data());
          scene.shape->map_again(particles, masses, work.motion_tile.data(), tile);
        });
  };
  for_each_block(scene, workspaces_, body, some);
}

template <int Dim>
void VelocityFilter<Dim>::collect(Scene<Dim>& scene, int k, const Faces<Dim>& faces, const Targets& targets,
                                  Items some) {
  const auto timing = scene.clock.time(Stage::nodes);
  parallel_for(some.within(scene.blocks.node_blocks().size()), [&](std::size_t b) {
    for_bodies_of_nodes(
        scene, b, [&](int body) { collect_body(scene, k, faces, body, *targets[static_cast<std::size_t>(body)], b); });
  });
}

template <int Dim>
void VelocityFilter<Dim>::collect_body(Scene<Dim>& scene, int k, const Faces<Dim>& faces, int body,
                                       NodeFields<Dim>& target, std::size_t b) {
  constexpr int lanes = motion_lanes<Dim>, change = Dim == 2 ? 2 : 4;
  const int m = scene.scheme.xpic_order;
  const double share = coefficient(m, k), first = coefficient(m, 1) - 1;
  auto& both = nodes_[static_cast<std::size_t>(body)];
  NodeFields<Dim>& nodes = both[static_cast<std::size_t>(1 - k % 2)];
  const auto& block = scene.blocks.node_blocks()[b];
  nodes.collect_momentum(scene.blocks, b);
  divide_by_mass<Dim>(block, nodes.momentum(b), nodes.motion(b));
  faces.fix(block, nodes.motion(b), Moment::before);
  const auto* const u = reinterpret_cast<const double*>(nodes.motion(b));
  const auto* const u_1 = reinterpret_cast<const double*>(both[0].motion(b));  // at k = 2
  auto* const sum = reinterpret_cast<double*>(target.motion(b)) + change;
  for (std::size_t n = 0; n < block_nodes<Dim>; ++n)
    for (std::size_t a = 0; a < Dim; ++a) {
      const std::size_t at = n * lanes * lane_width + a;
      sum[at] = (k == 2 ? first * u_1[at] : sum[at]) + share * u[at];
    }
}

template class VelocityFilter<2>;
template class VelocityFilter<3>;

}  // namespace sluice
