#include "core/simulation/stages.h"

#include "core/parallel/multitarget.h"

namespace sluice {

template <int Dim>
bool activate_blocks(Scene<Dim>& scene) {
  if (!scene.blocks.particle_blocks().empty() && scene.travelled < travel_allowance) return false;
  const auto timing = scene.clock.time(Stage::sort);
  scene.blocks.sort(scene.particles, scene.grid, scene.shape->reach());
  scene.resize_nodes();
  scene.travelled = 0;
  return true;
}

namespace {

/// The particles of a block to the nodes of their bodies; the surfaces, too, where other bodies are near or somebody
/// else asks for them.
template <int Dim>
void scatter_bodies(Scene<Dim>& scene, ScatterWhat what, double impulse_dt, std::size_t b,
                    const ScatterInput<Dim>& input) {
  BodyContact<Dim>& contact = *scene.contact;
  const ParticleBlock<Dim>& block = scene.blocks.particle_blocks()[b];
  const bool surfaces = what != ScatterWhat::momentum && (contact.at_others(b) || scene.wants_area());
  TilesOfRuns runs(scene.nodes.tile_size());
  for_bodies(scene, block, [&](int body, const BlockParticles<Dim>& particles, std::uint32_t) {
    const auto run = [&](ScatterInput<Dim> in, ScatterWhat which, NodeFields<Dim>& fields) {
      in.particles = particles;
      const bool forces = which == ScatterWhat::momentum_and_force || which == ScatterWhat::force;
      const std::array<Lane*, 2> tiles{which == ScatterWhat::force ? nullptr : fields.momentum_tile(b),
                                       forces ? fields.force_tile(b) : nullptr};
      runs.add_run(body, tiles,
                   [&](const std::array<Lane*, 2>& to) { scene.shape->scatter(which, in, impulse_dt, to[0], to[1]); });
    };
    run(input, what, contact.nodes(body));
    if (surfaces) run(scene.surface_input(block), ScatterWhat::force, contact.surface(body));
    runs.begin(body);
  });
}

}  // namespace

template <int Dim>
void scatter_block(Scene<Dim>& scene, ScatterWhat what, double impulse_dt, std::size_t b,
                   const ScatterInput<Dim>& input) {
  if (scene.contact != nullptr)
    scatter_bodies(scene, what, impulse_dt, b, input);
  else
    scene.shape->scatter(what, input, impulse_dt, scene.nodes.momentum_tile(b), scene.nodes.force_tile(b));
}

template <int Dim>
void scatter(Scene<Dim>& scene, ScatterWhat what, double impulse_dt, Items some) {
  const auto timing = scene.clock.time(Stage::scatter);
  parallel_for(some.within(scene.blocks.particle_blocks().size()), [&](std::size_t b) {
    scatter_block(scene, what, impulse_dt, b, scene.scatter_input(scene.blocks.particle_blocks()[b]));
  });
}

template <int Dim>
void scatter_surface(Scene<Dim>& scene, Items some) {
  if (scene.contact != nullptr) return;  // those of bodies go with their forces
  const auto timing = scene.clock.time(Stage::scatter);
  parallel_for(some.within(scene.blocks.particle_blocks().size()), [&](std::size_t b) {
    const ParticleBlock<Dim>& block = scene.blocks.particle_blocks()[b];
    scene.shape->scatter(ScatterWhat::force, scene.surface_input(block), 0, nullptr, scene.surface.force_tile(b));
  });
}

namespace {

/// Calls body(number) for every node of the block that particles can reach.
template <int Dim, class Body>
SLUICE_ALWAYS_INLINE void for_reached_nodes(const NodeBlock<Dim>& nodes, const Body& body) {
  constexpr int width = block_width<Dim>;
  const int last_plane = Dim == 3 ? nodes.high[Dim - 1] : 1;
  for (int k = Dim == 3 ? nodes.low[Dim - 1] : 0; k < last_plane; ++k)
    for (int j = nodes.low[1]; j < nodes.high[1]; ++j)
      for (int i = nodes.low[0]; i < nodes.high[0]; ++i) body((k * width + j) * width + i);
}

/// Moves the vector part of a momentum lane {m, x, y, (z)} to the front: {x, y, (z), 0}.
template <int Dim>
SLUICE_ALWAYS_INLINE Lane vector_part(Lane lane) {
  using Order = long long __attribute__((vector_size(32)));
  if constexpr (Dim == 2)
    return __builtin_shuffle(lane, Lane{}, Order{1, 2, 4, 4});
  else
    return __builtin_shuffle(lane, Lane{}, Order{1, 2, 3, 4});
}

template <int Dim>
SLUICE_ALWAYS_INLINE void store_motion(Lane velocity, Lane change, Lane* motion) {
  using Order = long long __attribute__((vector_size(32)));
  if constexpr (Dim == 2) {
    motion[0] = __builtin_shuffle(velocity, change, Order{0, 1, 4, 5});
  } else {
    motion[0] = velocity;
    motion[1] = change;
  }
}

}  // namespace

/// v = p / m + kick (f / m + g) and dv = v - p / m on one block; `force` may be null. (Multi-target functions need
/// external linkage: the linker chooses among their clones.)
template <int Dim>
SLUICE_MULTITARGET void accelerate(const NodeBlock<Dim>& nodes, const Lane* momentum, const Lane* force, double kick,
                                   const Vector<Dim>& gravity, double lightest, Lane* motion) {
  Lane gravity_kick{};
  for (int a = 0; a < Dim; ++a) gravity_kick[a] = kick * gravity[a];
  for_reached_nodes(
      nodes, [&](int n) __attribute__((always_inline)) {
        const double mass = momentum[n][0];
        const double inverse = mass > 0 ? 1 / mass : 0;
        const Lane before = inverse * vector_part<Dim>(momentum[n]);
        Lane change = mass > 0 ? gravity_kick : Lane{};
        if (force != nullptr && mass > lightest) change += (kick * inverse) * vector_part<Dim>(force[n]);
        store_motion<Dim>(before + change, change, motion + n * motion_lanes<Dim>);
      });
}

namespace {

/// Forces on nodes lighter than this [kg] are left out: their quotients would be noise. (Velocities are not: momentum
/// and mass go to zero together.)
template <int Dim>
double lightest_node(const Scene<Dim>& scene) {
  return scene.particles.size() == 0
             ? 0
             : scene.shape->negligible_weight() * scene.particles.columns.values(scene.particles.mass)[0];
}

}  // namespace

template <int Dim>
void divide_by_mass(const NodeBlock<Dim>& nodes, const Lane* momentum, Lane* motion) {
  accelerate<Dim>(nodes, momentum, nullptr, 0, {}, 0, motion);
}

template <int Dim>
void velocity_from_momentum(Scene<Dim>& scene, Moment moment, Items some) {
  const auto timing = scene.clock.time(Stage::nodes);
  parallel_for(some.within(scene.blocks.node_blocks().size()), [&](std::size_t b) {
    const auto& block = scene.blocks.node_blocks()[b];
    for_bodies_of_nodes(scene, b, [&](int body) {
      NodeFields<Dim>& nodes = scene.nodes_of(body);
      nodes.collect_momentum(scene.blocks, b);
      divide_by_mass<Dim>(block, nodes.momentum(b), nodes.motion(b));
      scene.obstacles.fix(block, b, nodes.momentum(b), nodes.motion(b), moment);
      scene.faces.fix(block, nodes.motion(b), moment);
    });
  });
}

namespace {

/// What faces and obstacles do to the new velocities of a block. Faces come last: nothing may pass them.
template <int Dim>
void impose_boundaries(Scene<Dim>& scene, int body, std::size_t b, double kick, double lightest,
                       FieldsByBody<Dim>* without_friction) {
  const auto& block = scene.blocks.node_blocks()[b];
  NodeFields<Dim>& nodes = scene.nodes_of(body);
  const Lane* const momentum = nodes.momentum(b);
  std::array<Lane, block_nodes<Dim>> relief, area;
  Beside beside;
  // Velocities, or velocities per Pascal, from forces.
  const auto take = [&](NodeFields<Dim>& fields, double sign, std::array<Lane, block_nodes<Dim>>& out) {
    fields.collect_force(scene.blocks, b);
    for (std::size_t n = 0; n < out.size(); ++n) {
      const double mass = momentum[n][0];
      out[n] = mass > lightest ? (sign * kick / mass) * vector_part<Dim>(fields.force(b)[n]) : Lane{};
    }
    return out.data();
  };
  if (without_friction != nullptr) {
    beside.relief = take((*without_friction)[static_cast<std::size_t>(body)], 1, relief);
    scene.obstacles.add_relief(b, momentum, kick, relief.data());
  }
  if (scene.wants_area()) beside.area = take(scene.surface_of(body), -1, area);
  scene.dashpots.impose(block, body, nodes.motion(b), beside.area, kick, scene.step == 0);
  scene.obstacles.fix_with_friction(block, b, momentum, nodes.motion(b), beside, kick);
  scene.faces.fix_with_friction(block, nodes.motion(b), beside);
}

/// What other bodies and boundaries do to the new velocities of a block.
template <int Dim>
void finish_nodes(Scene<Dim>& scene, std::size_t b, double kick, double lightest, FieldsByBody<Dim>* without_friction) {
  if (scene.contact != nullptr) scene.contact->exchange(scene.blocks, b, kick, lightest, without_friction);
  scene.obstacles.start_force(b);
  for_bodies_of_nodes(scene, b, [&](int body) { impose_boundaries(scene, body, b, kick, lightest, without_friction); });
}

/// Adds the traction of a pressure on obstacles to the forces of a block.
template <int Dim>
void press_on_obstacles(Scene<Dim>& scene, NodeFields<Dim>* pressure, std::size_t b, bool again) {
  if (pressure == nullptr) return;
  pressure->collect_momentum(scene.blocks, b);
  pressure->collect_force(scene.blocks, b);
  scene.obstacles.press(scene.blocks.node_blocks()[b], b, pressure->momentum(b), pressure->force(b),
                        scene.nodes.force(b), again);
}

}  // namespace

template <int Dim>
void advance_nodes(Scene<Dim>& scene, double kick, bool collect_momentum, bool collect_force, Items some,
                   FieldsByBody<Dim>* without_friction, NodeFields<Dim>* at_obstacles) {
  const auto timing = scene.clock.time(Stage::nodes);
  const double lightest = lightest_node(scene);
  parallel_for(some.within(scene.blocks.node_blocks().size()), [&](std::size_t b) {
    const auto& block = scene.blocks.node_blocks()[b];
    for_bodies_of_nodes(scene, b, [&](int body) {
      NodeFields<Dim>& nodes = scene.nodes_of(body);
      if (collect_momentum) nodes.collect_momentum(scene.blocks, b);
      if (collect_force) nodes.collect_force(scene.blocks, b);
      press_on_obstacles(scene, at_obstacles, b, false);
      accelerate<Dim>(block, nodes.momentum(b), collect_force ? nodes.force(b) : nullptr, kick, scene.gravity, lightest,
                      nodes.motion(b));
    });
    finish_nodes(scene, b, kick, lightest, without_friction);
  });
}

template <int Dim>
void correct_nodes(Scene<Dim>& scene, double kick, FieldsByBody<Dim>* without_friction, Items some,
                   NodeFields<Dim>* at_obstacles) {
  const auto timing = scene.clock.time(Stage::nodes);
  const double lightest = lightest_node(scene);
  parallel_for(some.within(scene.blocks.node_blocks().size()), [&](std::size_t b) {
    const auto& block = scene.blocks.node_blocks()[b];
    for_bodies_of_nodes(scene, b, [&](int body) {
      NodeFields<Dim>& nodes = scene.nodes_of(body);
      nodes.add_force(scene.blocks, b);
      press_on_obstacles(scene, at_obstacles, b, true);
      accelerate<Dim>(block, nodes.momentum(b), nodes.force(b), kick, scene.gravity, lightest, nodes.motion(b));
    });
    finish_nodes(scene, b, kick, lightest, without_friction);
  });
}

template <int Dim>
void prepare(const Scene<Dim>& scene, std::vector<Workspace<Dim>>& workspaces) {
  constexpr std::size_t columns = symmetric_components<Dim> + spin_components<Dim>;
  const std::size_t tile = scene.nodes.tile_size() * motion_lanes<Dim>;
  const std::size_t length = (scene.blocks.largest_block() + 15) / 8 * 8;
  workspaces.resize(static_cast<std::size_t>(thread_count()));
  for (auto& w : workspaces) {
    w.motion_tile.resize(tile);
    if (w.numbers.size() < columns * length) w.numbers.resize(columns * length);
    double* next = w.numbers.data();
    for (auto& column : w.strain.strain) column = std::exchange(next, next + length);
    for (auto& column : w.strain.rotation) column = std::exchange(next, next + length);
  }
}

namespace {

/// XPIC: the stages of VelocityFilter have put what PIC would lose into the place of the nodes' change.
template <int Dim>
VelocityShares velocity_shares(const Scene<Dim>& scene) {
  const double flip = scene.scheme.flip_fraction;
  if (!scene.transfer.filtered) return {flip, flip, 1 - flip};
  return {0, scene.scheme.xpic_order > 1 ? 1.0 : 0.0, 1};
}

}  // namespace

template <int Dim>
MotionUpdate<Dim> motion_update(Scene<Dim>& scene, double dt, ColumnId position_column, ColumnId domain_column) {
  Columns& columns = scene.particles.columns;
  MotionUpdate<Dim> update{};
  update.dt = dt;
  update.shares = velocity_shares(scene);
  for (int a = 0; a < Dim; ++a) {
    update.velocity[a] = columns.data(scene.particles.velocity, a);
    update.position[a] = columns.data(position_column, a);
  }
  const int components = domain_column.index < 0 ? 0 : columns.spec(domain_column).components;
  for (int c = 0; c < components; ++c) update.domain[static_cast<std::size_t>(c)] = columns.data(domain_column, c);
  update.affine_is_gradient = scene.transfer.gradient;
  if (scene.transfer.affine)
    for (int c = 0; c < Dim * Dim; ++c) update.affine[c] = columns.data(scene.affine, c);
  return update;
}

#define SLUICE_INSTANTIATE(Dim)                                                                                   \
  template bool activate_blocks<Dim>(Scene<Dim>&);                                                                \
  template void scatter_block<Dim>(Scene<Dim>&, ScatterWhat, double, std::size_t, const ScatterInput<Dim>&);      \
  template void scatter<Dim>(Scene<Dim>&, ScatterWhat, double, Items);                                            \
  template void divide_by_mass<Dim>(const NodeBlock<Dim>&, const Lane*, Lane*);                                   \
  template void velocity_from_momentum<Dim>(Scene<Dim>&, Moment, Items);                                          \
  template void scatter_surface<Dim>(Scene<Dim>&, Items);                                                         \
  template void advance_nodes<Dim>(Scene<Dim>&, double, bool, bool, Items, FieldsByBody<Dim>*, NodeFields<Dim>*); \
  template void correct_nodes<Dim>(Scene<Dim>&, double, FieldsByBody<Dim>*, Items, NodeFields<Dim>*);             \
  template void prepare<Dim>(const Scene<Dim>&, std::vector<Workspace<Dim>>&);                                    \
  template MotionUpdate<Dim> motion_update<Dim>(Scene<Dim>&, double, ColumnId, ColumnId);
SLUICE_INSTANTIATE(2)
SLUICE_INSTANTIATE(3)
#undef SLUICE_INSTANTIATE

}  // namespace sluice
