#include "physics/two_phase/relative_motion.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/case/case_schema.h"

namespace sluice {

namespace {

/// A face is closed to the relative motion where it holds the solid, or absorbs, and lets no water through.
std::map<std::string, FaceCase> closed_faces(const Case& definition, const WaterCase& water) {
  std::map<std::string, FaceCase> faces;
  for (const auto& [name, face] : definition.faces) {
    FaceCase closed;
    const auto found = water.faces.find(name);
    const bool open =
        found != water.faces.end() && (found->second.pressure || found->second.head || found->second.flux);
    if (!open && (face.normal != FaceCase::Normal::free || face.absorbing)) closed.normal = FaceCase::Normal::fixed;
    faces[name] = closed;
  }
  return faces;
}

/// Components of the velocity of a node, and of its change.
template <int Dim>
struct Motion {
  double* velocity;
  double* change;
  explicit Motion(Lane* lanes) : velocity(reinterpret_cast<double*>(lanes)), change(velocity + (Dim == 2 ? 2 : 4)) {}
};

}  // namespace

template <int Dim>
RelativeMotion<Dim>::RelativeMotion(const Case& definition, const WaterCase& water, PoreWater<Dim>& pores)
    : water_(water),
      pores_(pores),
      active_(water.formulation != Formulation::u_p),
      projected_(water.formulation == Formulation::v_w_p) {
  for (std::size_t m = 0; active_ && m < pores.spaces().size(); ++m) {
    const auto& k = pores.spaces()[m].permeability;
    if (std::ranges::adjacent_find(k, std::not_equal_to()) == k.end()) continue;
    const auto& [name, section] = definition.materials[m];
    throw CaseError(
        section.find("water")->find("permeability")->place,
        fmt::format("material '{}': only `formulation: u-p` takes permeabilities that differ between axes", name));
  }
  if (!active_) return;
  const auto shape = shape_registry<Dim>().find(definition.scheme.shape, {})();
  faces_ = std::make_unique<Faces<Dim>>(closed_faces(definition, water), grid_of<Dim>(definition.grid), shape->reach(),
                                        shape->outside());
}

template <int Dim>
void RelativeMotion<Dim>::declare(Particles& particles, bool affine) {
  if (!active_) return;
  Columns& columns = particles.columns;
  velocity_ = columns.declare(
      {"relative_velocity", "m/s", Dim, Role::state, "Velocity of the pore water relative to the solid."});
  if (affine)
    affine_ = columns.declare({"affine_relative_velocity", "1/s", Dim * Dim, Role::state,
                               "Affine field of the relative velocity, row by row.", false});
  water_mass_ = columns.declare({"water_mass", "kg", 1, Role::derived, "Mass of the pore water.", false});
  drag_ = columns.declare({"drag", "kg/s", 1, Role::derived, "Drag of the pore water.", false});
  drive_ =
      columns.declare({"drag_velocity", "m/s", Dim, Role::derived, "Velocity at which drag balances drive.", false});
  scratch_ = columns.declare({"unused_position", "m", Dim, Role::derived, "Where the water would go.", false});
  if (projected_) return;
  partial_stress_ = columns.declare({"water_stress", "Pa", 1, Role::derived, "Minus porosity times pressure.", false});
  relative_divergence_ =
      columns.declare({"relative_divergence", "1/s", 1, Role::derived, "Divergence of the relative velocity.", false});
}

template <int Dim>
std::array<const double*, Dim> RelativeMotion<Dim>::velocity(const Particles& particles) const {
  std::array<const double*, Dim> velocity{};
  if (active_)
    for (int a = 0; a < Dim; ++a) velocity[a] = particles.columns.data(velocity_, a);
  return velocity;
}

/// m_w (v + r)^2 / 2 - m_w v^2 / 2 of the pore water.
template <int Dim>
double RelativeMotion<Dim>::kinetic_energy(const Particles& particles) const {
  if (!active_) return 0;
  const Columns& columns = particles.columns;
  double sum = 0;
  for (std::size_t p = 0; p < particles.size(); ++p) {
    if (pores_.spaces()[static_cast<std::size_t>(particles.material[p])].liquid) continue;
    const double mass = columns.data(pores_.wet())[p] * columns.data(pores_.porosity())[p] * water_.density *
                        columns.data(particles.volume)[p];
    for (int a = 0; a < Dim; ++a) {
      const double r = columns.data(velocity_, a)[p], v = columns.data(particles.velocity, a)[p];
      sum += mass * r * (v + 0.5 * r);
    }
  }
  return sum;
}

template <int Dim>
ScatterInput<Dim> RelativeMotion<Dim>::water_input(Scene<Dim>& scene, const ParticleBlock<Dim>& block) {
  Columns& columns = scene.particles.columns;
  ScatterInput<Dim> in = scene.scatter_input(block);
  const double* volume = columns.data(scene.particles.volume);
  double* mass = columns.data(water_mass_);
  for (std::uint32_t k = block.first_batch; k < block.last_batch; ++k) {
    const Batch& batch = scene.blocks.batches()[k];
    const double density = pores_.spaces()[static_cast<std::size_t>(batch.material)].liquid ? 0 : water_.density;
    const double* porosity = columns.data(pores_.porosity());
    const double* wet = columns.data(pores_.wet());
    for (std::uint32_t p = batch.begin; p < batch.end; ++p) mass[p] = wet[p] * porosity[p] * density * volume[p];
  }
  in.mass = mass;
  for (int a = 0; a < Dim; ++a) in.velocity[a] = columns.data(velocity_, a);
  if (scene.transfer.affine)
    for (int c = 0; c < Dim * Dim; ++c) in.affine[c] = columns.data(affine_, c);
  return in;
}

template <int Dim>
void RelativeMotion<Dim>::begin_step(const Scene<Dim>& scene) {
  nodes_.resize(scene.blocks, scene.shape->reach());
  if (VelocityFilter<Dim>::wanted(scene)) filter_.resize(scene);
  before_.resize(scene.blocks.node_blocks().size() * block_nodes<Dim>);
}

template <int Dim>
void RelativeMotion<Dim>::scatter(Scene<Dim>& scene, Items some) {
  const auto timing = scene.clock.time(Stage::scatter);
  parallel_for(some.within(scene.blocks.particle_blocks().size()), [&](std::size_t b) {
    scene.shape->scatter(ScatterWhat::momentum, water_input(scene, scene.blocks.particle_blocks()[b]), 0,
                         nodes_.momentum_tile(b), nullptr);
  });
}

template <int Dim>
void RelativeMotion<Dim>::collect(Scene<Dim>& scene, Items some) {
  const auto timing = scene.clock.time(Stage::nodes);
  const bool filtered = VelocityFilter<Dim>::wanted(scene);
  parallel_for(some.within(scene.blocks.node_blocks().size()), [&](std::size_t b) {
    nodes_.collect_momentum(scene.blocks, b);
    if (filtered) filter_.take(scene, b, 0, nodes_.momentum(b), *faces_);
    for (std::size_t n = 0; n < block_nodes<Dim>; ++n) {
      const Lane water = nodes_.momentum(b)[n], mixture = scene.nodes.momentum(b)[n];
      const double share = mixture[0] > 0 ? water[0] / mixture[0] : 0;
      Lane& before = before_[b * block_nodes<Dim> + n];
      before = water[0] > 0 ? water / water[0] : Lane{};
      before[0] = share;
      if (!projected_) continue;
      const Motion<Dim> motion(scene.nodes.motion(b) + n * motion_lanes<Dim>);
      for (int a = 0; a < Dim; ++a) motion.velocity[a] += share * before[1 + a];
    }
  });
}

/// Drag n^2 gamma_w / k and what drives the water, -grad p + rho_w g, both times the volume: eq. (52).
template <int Dim>
void RelativeMotion<Dim>::set_drag(Scene<Dim>& scene, const ParticleBlock<Dim>& block) {
  Columns& columns = scene.particles.columns;
  const double* volume = columns.data(scene.particles.volume);
  const double* porosity = columns.data(pores_.porosity());
  const double* wet = columns.data(pores_.wet());
  double* drag = columns.data(drag_);
  for (std::uint32_t k = block.first_batch; k < block.last_batch; ++k) {
    const Batch& batch = scene.blocks.batches()[k];
    const PoreSpace& space = pores_.spaces()[static_cast<std::size_t>(batch.material)];
    const Mobility<Dim> mobilities = pores_.mobility(space);
    for (std::uint32_t p = batch.begin; p < batch.end; ++p) {
      const bool porous = wet[p] != 0 && !space.liquid;
      const double n = porosity[p], mobility = porous ? mobilities.along(0, mobilities.factor(n)) : 1;
      drag[p] = porous ? volume[p] * n * n / mobility : 0;
      for (int a = 0; a < Dim; ++a) {
        const double slope = columns.data(pores_.pressure_gradient(), a)[p];
        columns.data(drive_, a)[p] = porous ? mobility / n * (water_.density * scene.gravity[a] - slope) : 0;
      }
    }
  }
}

/// With the projection the drive comes from the gradient of the pressure; explicitly, from the divergence of the
/// water's share of the stress, -n p.
template <int Dim>
void RelativeMotion<Dim>::scatter_drag(Scene<Dim>& scene, std::size_t b, const ParticleBlock<Dim>& block) {
  Columns& columns = scene.particles.columns;
  set_drag(scene, block);
  ScatterInput<Dim> in = scene.scatter_input(block);
  in.mass = columns.data(drag_);
  in.affine.fill(nullptr);
  for (int a = 0; a < Dim; ++a) in.velocity[a] = columns.data(drive_, a);
  if (projected_) {
    scene.shape->scatter(ScatterWhat::momentum, in, 0, nodes_.momentum_tile(b), nullptr);
    return;
  }
  double* stress = columns.data(partial_stress_);
  const double* wet = columns.data(pores_.wet());
  for (std::uint32_t p = block.begin; p < block.end; ++p) {
    stress[p] = -wet[p] * columns.data(pores_.porosity())[p] * columns.data(pores_.pressure())[p];
    for (int a = 0; a < Dim; ++a) columns.data(drive_, a)[p] = 0;
  }
  in.stress.fill(columns.data(drive_));
  for (int a = 0; a < Dim; ++a) in.stress[a] = stress;
  scene.shape->scatter(ScatterWhat::momentum_and_force, in, 0, nodes_.momentum_tile(b), nodes_.force_tile(b));
}

template <int Dim>
void RelativeMotion<Dim>::advance(Sweep<Dim>& sweep, Scene<Dim>& scene, std::vector<Workspace<Dim>>& workspaces,
                                  double kick) {
  sweep.over_particles([this, &scene, &workspaces](Items some) {
    const auto timing = scene.clock.time(Stage::scatter);
    const auto body = [&](std::size_t b, const auto& block, Workspace<Dim>&) { scatter_drag(scene, b, block); };
    for_each_block(scene, workspaces, body, some);
  });
  sweep.over_nodes([this, &scene, kick](Items some) {
    const auto timing = scene.clock.time(Stage::nodes);
    parallel_for(some.within(scene.blocks.node_blocks().size()), [&](std::size_t b) { advance_nodes(scene, b, kick); });
  });
}

/// Eqs. (52) and (53) at the nodes of a block.
template <int Dim>
void RelativeMotion<Dim>::advance_nodes(Scene<Dim>& scene, std::size_t b, double kick) {
  nodes_.collect_momentum(scene.blocks, b);
  if (!projected_) nodes_.collect_force(scene.blocks, b);
  for (std::size_t n = 0; n < block_nodes<Dim>; ++n) {
    const Lane before = before_[b * block_nodes<Dim> + n];
    Lane drag = nodes_.momentum(b)[n];
    const double share = before[0], water = share * scene.nodes.momentum(b)[n][0], reduced = water * (1 - share);
    if (!projected_) {
      drag += nodes_.force(b)[n];
      for (int a = 0; a < Dim; ++a) drag[1 + a] += water * scene.gravity[a];
    }
    const Motion<Dim> solid(scene.nodes.motion(b) + n * motion_lanes<Dim>);
    const Motion<Dim> relative(nodes_.motion(b) + n * motion_lanes<Dim>);
    for (int a = 0; a < Dim; ++a) {
      const double push = kick * drag[1 + a] - water * solid.change[a];  // the mixture's change, up to here
      const double after = water > 0 ? (reduced * before[1 + a] + push) / (reduced + kick * drag[0]) : 0;
      relative.velocity[a] = after;
      relative.change[a] = after - before[1 + a];
    }
  }
  const NodeBlock<Dim>& block = scene.blocks.node_blocks()[b];
  scene.obstacles.close(block, b, nodes_.motion(b));
  faces_->fix(block, nodes_.motion(b));
  for (std::size_t n = 0; n < block_nodes<Dim>; ++n) {
    const double share = before_[b * block_nodes<Dim> + n][0];
    const Motion<Dim> solid(scene.nodes.motion(b) + n * motion_lanes<Dim>);
    const Motion<Dim> relative(nodes_.motion(b) + n * motion_lanes<Dim>);
    for (int a = 0; a < Dim; ++a) {
      solid.velocity[a] -= share * relative.change[a];
      solid.change[a] -= share * relative.change[a];
    }
  }
  scene.obstacles.fix(block, b, scene.nodes.momentum(b), scene.nodes.motion(b), Moment::now);
  scene.faces.fix(block, scene.nodes.motion(b));
}

template <int Dim>
void RelativeMotion<Dim>::compress(Scene<Dim>& scene, std::vector<Workspace<Dim>>& workspaces, double dt, Items some) {
  Columns& columns = scene.particles.columns;
  double* solid = columns.data(pores_.divergence());
  double* relative = columns.data(relative_divergence_);
  std::array<double*, Dim> unused;
  for (int a = 0; a < Dim; ++a) unused[a] = columns.data(pores_.acceleration(), a);
  const auto body = [&](std::size_t b, const ParticleBlock<Dim>& block, Workspace<Dim>& work) {
    nodes_.load_motion(scene.blocks, b, work.motion_tile.data());
    scene.shape->gather_divergence(scene.view(block), work.motion_tile.data(), relative, unused);
    scene.nodes.load_motion(scene.blocks, b, work.motion_tile.data());
    scene.shape->gather_divergence(scene.view(block), work.motion_tile.data(), solid, unused);
    pores_.compress(scene, block, solid, relative, dt);
  };
  for_each_block(scene, workspaces, body, some);
}

template <int Dim>
void RelativeMotion<Dim>::gather(Sweep<Dim>& sweep, Scene<Dim>& scene, std::vector<Workspace<Dim>>& workspaces,
                                 double dt) {
  if (VelocityFilter<Dim>::wanted(scene)) filter_.add_maps(sweep, scene, water_mass_, *faces_, {&nodes_});
  sweep.over_particles([this, &scene, &workspaces, dt](Items some) { take_from_nodes(scene, workspaces, dt, some); });
}

template <int Dim>
void RelativeMotion<Dim>::take_from_nodes(Scene<Dim>& scene, std::vector<Workspace<Dim>>& workspaces, double dt,
                                          Items some) {
  const auto timing = scene.clock.time(Stage::gather);
  Columns& columns = scene.particles.columns;
  MotionUpdate<Dim> update = motion_update(scene, dt, scratch_);
  for (int a = 0; a < Dim; ++a) update.velocity[a] = columns.data(velocity_, a);
  if (scene.transfer.affine)
    for (int c = 0; c < Dim * Dim; ++c) update.affine[c] = columns.data(affine_, c);
  const auto body = [&](std::size_t b, const ParticleBlock<Dim>& block, Workspace<Dim>& work) {
    nodes_.load_motion(scene.blocks, b, work.motion_tile.data());
    scene.shape->gather_motion(scene.view(block), work.motion_tile.data(), update);
  };
  for_each_block(scene, workspaces, body, some);
}

template class RelativeMotion<2>;
template class RelativeMotion<3>;

}  // namespace sluice
