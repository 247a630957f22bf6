#include "physics/two_phase/pore_water.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel/multitarget.h"

namespace sluice {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// What the permeability goes with.
double kozeny_carman(double n) { return n * n * n / ((1 - n) * (1 - n)); }

}  // namespace

/// Loops over consecutive particles. (Multi-target functions need external linkage: the linker chooses among their
/// clones.)
namespace pore_water {

/// sum = x + factor y
SLUICE_MULTITARGET void add_scaled(std::size_t count, const double* __restrict x, double factor,
                                   const double* __restrict y, double* __restrict sum) {
#pragma omp simd
  for (std::size_t p = 0; p < count; ++p) sum[p] = x[p] + factor * y[p];
}

/// Zero for `value`, which may be the pressure itself, where there is no water, or less pressure than `least`.
SLUICE_MULTITARGET void clear_below(std::size_t count, const double* wet, const double* pressure, double least,
                                    double* value) {
#pragma omp simd
  for (std::size_t p = 0; p < count; ++p) value[p] = wet[p] != 0 && pressure[p] >= least ? value[p] : 0;
}

/// Eq. (50) for particles of one material; `grains` and `water` are densities.
SLUICE_MULTITARGET void follow(std::size_t count, double grains, double water, const double* __restrict volume,
                               const double* __restrict solid, const double* __restrict wet,
                               double* __restrict porosity, double* __restrict mass, double* __restrict inertia,
                               bool inertia_follows) {
  const double per_grains = 1 / grains;
#pragma GCC ivdep
  for (std::size_t p = 0; p < count; ++p) {
    const double n = 1 - solid[p] * per_grains / volume[p];
    porosity[p] = n;
    mass[p] = solid[p] + wet[p] * n * water * volume[p];
  }
  if (inertia_follows) std::copy_n(mass, count, inertia);
}

}  // namespace pore_water

template <int Dim>
PoreWater<Dim>::PoreWater(const WaterCase& water, std::vector<PoreSpace> spaces, const Materials<Dim>& materials)
    : water_(water), spaces_(std::move(spaces)), materials_(materials) {
  for (PoreSpace& space : spaces_)
    if (!space.liquid && space.saturated) space.per_initial_kozeny_carman = 1 / kozeny_carman(space.porosity);
}

template <int Dim>
void PoreWater<Dim>::declare(Particles& particles, bool with_body_force) {
  Columns& columns = particles.columns;
  using enum Role;
  pressure_ = columns.declare({"pore_pressure", "Pa", 1, state, "Pressure of the water, positive in compression."});
  pressure_gradient_ =
      columns.declare({"pore_pressure_gradient", "Pa/m", Dim, state, "Gradient of the pore pressure.", false});
  porosity_ = columns.declare({"porosity", "1", 1, state, "Volume of pores per volume."});
  wet_ = columns.declare({"wet", "1", 1, state, "1 where the pores are full of water, 0 where they hold none."});
  solid_mass_ = columns.declare({"solid_mass", "kg", 1, state, "Mass of the grains.", false});
  inertia_ =
      columns.declare({"skeleton_inertia", "kg", 1, state, "Least mass that elastic waves set in motion.", false});
  divergence_ = columns.declare({"divergence", "1/s", 1, derived, "Divergence of the predicted velocity.", false});
  acceleration_ = columns.declare({"predicted_change", "m/s", Dim, derived, "Predicted change of velocity.", false});
  new_pressure_ = columns.declare({"new_pore_pressure", "Pa", 1, derived, "Pressure at the end of the step.", false});
  total_stress_ =
      columns.declare({"total_normal_stress", "Pa", Dim, derived, "Normal stresses that forces come from.", false});
  zero_ = columns.declare({"zero", "1", 1, derived, "Zeros.", false});
  if (with_body_force) pressed_.declare(particles);
}

template <int Dim>
void PoreWater<Dim>::fill(Scene<Dim>& scene) {
  Columns& columns = scene.particles.columns;
  double* mass = columns.data(scene.particles.mass);
  double* volume = columns.data(scene.particles.volume);
  for (std::size_t p = 0; p < scene.particles.size(); ++p) {
    const auto m = static_cast<std::size_t>(scene.particles.material[p]);
    const double x = columns.data(scene.particles.position)[p], z = columns.data(scene.particles.position, Dim - 1)[p];
    const bool wet = spaces_[m].liquid || (spaces_[m].saturated && water_.below_table(x, z));
    const double dry_density = materials_[m].density(), n = spaces_[m].porosity;
    const double solid = dry_density * volume[p];
    columns.data(wet_)[p] = wet ? 1 : 0;
    columns.data(porosity_)[p] = n;
    columns.data(solid_mass_)[p] = solid;
    mass[p] = solid + (wet && !spaces_[m].liquid ? n * water_.density * volume[p] : 0);
    // The shortest waves do not compress the water between vertices: with u-p the whole mass moves, with an inertia of
    // its own the water may stay behind.
    columns.data(inertia_)[p] = water_.formulation == Formulation::u_p ? mass[p] : solid;
  }
}

template <int Dim>
void PoreWater<Dim>::dry_above_zero_pressure(Scene<Dim>& scene) {
  Columns& columns = scene.particles.columns;
  const double* found = columns.data(new_pressure_);
  for (std::size_t p = 0; p < scene.particles.size(); ++p) {
    columns.data(pressure_)[p] = std::max(0.0, found[p]);
    if (found[p] > 0 || columns.data(wet_)[p] == 0) continue;
    columns.data(wet_)[p] = 0;
    columns.data(scene.particles.mass)[p] = columns.data(inertia_)[p] = columns.data(solid_mass_)[p];
    for (int a = 0; a < Dim; ++a) columns.data(pressure_gradient_, a)[p] = 0;
  }
}

template <int Dim>
void PoreWater<Dim>::set_initial_pressure(Scene<Dim>& scene) {
  using enum InitialPressure::Method;
  const InitialPressure& initial = water_.initial;
  const double weight = -water_.density * scene.gravity[Dim - 1];
  Columns& columns = scene.particles.columns;
  for (std::size_t p = 0; p < scene.particles.size(); ++p) {
    if (columns.data(wet_)[p] == 0) continue;
    if (initial.method == uniform) columns.data(pressure_)[p] = initial.pressure;
    if (initial.method != hydrostatic) continue;
    const double x = columns.data(scene.particles.position)[p], z = columns.data(scene.particles.position, Dim - 1)[p];
    const double level = initial.level ? *initial.level : water_.table_level(x);
    const double hydrostatic_pressure = weight * (level - z), least = -initial.suction.value_or(infinity);
    columns.data(pressure_)[p] = std::max(hydrostatic_pressure, least);
    columns.data(pressure_gradient_, Dim - 1)[p] = hydrostatic_pressure > least ? -weight : 0;
  }
}

template <int Dim>
bool PoreWater<Dim>::any_liquid() const {
  return std::any_of(spaces_.begin(), spaces_.end(), [](const PoreSpace& space) { return space.liquid; });
}

template <int Dim>
std::vector<char> PoreWater<Dim>::wet_blocks(const Scene<Dim>& scene) const {
  const double* wet = scene.particles.columns.data(wet_);
  std::vector<char> blocks;
  for (const auto& block : scene.blocks.particle_blocks())
    blocks.push_back(std::any_of(wet + block.begin, wet + block.end, [](double w) { return w != 0; }) ? 1 : 0);
  return blocks;
}

template <int Dim>
SkeletonLoads<Dim> PoreWater<Dim>::skeleton_loads(Scene<Dim>& scene, const ExternalPressure<Dim>& outside,
                                                  std::vector<Workspace<Dim>>& workspaces) {
  Columns& columns = scene.particles.columns;
  double* push = columns.data(new_pressure_);
  std::ranges::copy(columns.values(pressure_), push);
  return outside.any() ? pressed_.at_rest(scene, outside, workspaces, push) : SkeletonLoads<Dim>{push, {}};
}

// ---- forces ----

template <int Dim>
void PoreWater<Dim>::scatter_forces(Scene<Dim>& scene, std::size_t b, const ParticleBlock<Dim>& block,
                                    const ExternalPressure<Dim>& outside, ScatterWhat what) {
  Columns& columns = scene.particles.columns;
  ScatterInput<Dim> in = scene.scatter_input(block);
  const double* pressure = columns.data(pressure_);
  for (int a = 0; a < Dim; ++a) {
    double* total = columns.data(total_stress_, a);
    pore_water::add_scaled(block.end - block.begin, in.stress[a] + block.begin, -water_.increment,
                           pressure + block.begin, total + block.begin);
    in.stress[a] = total;
  }
  if (!outside.any()) {
    scatter_block(scene, what, 0, b, in);
    return;
  }
  pressed_.take(scene, block, outside);
  const double* here = pressed_.pressure(scene.particles);
  for (int a = 0; a < Dim; ++a) {
    double* total = columns.data(total_stress_, a);
    for (std::uint32_t p = block.begin; p < block.end; ++p) total[p] += here[p];
  }
  pressed_.scatter(scene, b, in, what, scene.nodes);
}

template <int Dim>
void PoreWater<Dim>::take_pressure(Scene<Dim>& scene, std::size_t b, const ParticleBlock<Dim>& block,
                                   const PressureEquation<Dim>& equation) {
  Columns& columns = scene.particles.columns;
  double* pressure = columns.data(new_pressure_);
  const double* wet = columns.data(wet_);
  FieldAtParticles<Dim> out{pressure, {}};
  for (int a = 0; a < Dim; ++a) out.gradient[a] = columns.data(pressure_gradient_, a);
  VertexTile<Dim> tile;
  equation.load(b, tile);
  interpolate<Dim>(tile, scene.view(block), out);
  for (std::uint32_t k = block.first_batch; k < block.last_batch; ++k) {
    const Batch& batch = scene.blocks.batches()[k];
    // Free water tears rather than be pulled; the continuation beyond a ragged surface would pull.
    const bool liquid = spaces_[static_cast<std::size_t>(batch.material)].liquid;
    const double least = liquid ? 0 : -infinity;
    for (int a = 0; a < Dim; ++a)
      pore_water::clear_below(batch.end - batch.begin, wet + batch.begin, pressure + batch.begin, least,
                              out.gradient[a] + batch.begin);
    pore_water::clear_below(batch.end - batch.begin, wet + batch.begin, pressure + batch.begin, least,
                            pressure + batch.begin);
  }
}

template <int Dim>
void PoreWater<Dim>::correct(Scene<Dim>& scene, std::size_t b, const ParticleBlock<Dim>& block,
                             const PressureEquation<Dim>& equation) {
  if (!equation.is_wet(b)) {
    for (int body = 0; body < scene.bodies(); ++body)
      std::fill_n(scene.nodes_of(body).force_tile(b), scene.nodes.tile_size(), Lane{});
    return;
  }
  Columns& columns = scene.particles.columns;
  take_pressure(scene, b, block, equation);
  const double* added = columns.data(new_pressure_);
  double* pressure = columns.data(pressure_);
  double* change = columns.data(total_stress_);
  pore_water::add_scaled(block.end - block.begin, added + block.begin, -water_.increment, pressure + block.begin,
                         change + block.begin);
  std::copy(added + block.begin, added + block.end, pressure + block.begin);
  const double* const volume = columns.data(scene.particles.volume);
  fill_tiles_of_bodies(
      scene, block, [&](int body) { return scene.nodes_of(body).force_tile(b); },
      [&](int, const BlockParticles<Dim>& particles, Lane* tile) {
        scene.shape->scatter_pressure(particles, volume, change, tile);
      });
}

/// The forces of the pressure and, as a body force, its gradient: by the divergence theorem what is left is the
/// surface.
template <int Dim>
void PoreWater<Dim>::scatter_traction(Scene<Dim>& scene, std::size_t b, const ParticleBlock<Dim>& block,
                                      const ExternalPressure<Dim>& outside, FieldsByBody<Dim>& nodes) {
  Columns& columns = scene.particles.columns;
  const double* const pressure = columns.data(pressure_);
  const double* const volume = columns.data(scene.particles.volume);
  ScatterInput<Dim> in = scene.scatter_input(block);
  in.stress.fill(columns.data(zero_));
  double* const stress = columns.data(total_stress_);
  std::array<double*, Dim> forces;
  for (std::uint32_t p = block.begin; p < block.end; ++p) stress[p] = -pressure[p];
  for (int a = 0; a < Dim; ++a) {
    const double* const gradient = columns.data(pressure_gradient_, a);
    double* const force = columns.data(acceleration_, a);  // which has served its purpose in the step
    for (std::uint32_t p = block.begin; p < block.end; ++p) force[p] = volume[p] * gradient[p];
    in.stress[a] = stress;
    in.body_force[a] = forces[static_cast<std::size_t>(a)] = force;
  }
  if (outside.any()) pressed_.add_to(stress, forces, scene.particles, block);
  fill_tiles_of_bodies(
      scene, block, [&](int body) { return nodes[static_cast<std::size_t>(body)].force_tile(b); },
      [&](int, const BlockParticles<Dim>& particles, Lane* tile) {
        in.particles = particles;
        scene.shape->scatter(ScatterWhat::force, in, 0, nullptr, tile);
      });
}

// ---- to cells and vertices ----

template <int Dim>
Mobility<Dim> PoreWater<Dim>::mobility(const PoreSpace& space) const {
  // Soil that falls apart has a porosity near one and a permeability without bound: u-p holds up to a limit only.
  const double coarsest = water_.formulation == Formulation::u_p ? coarsest_u_p : infinity;
  const double weight = water_.density * standard_gravity;
  Mobility<Dim> mobility;
  mobility.constant = space.kozeny_carman ? 0 : 1;
  mobility.per_kozeny_carman = space.kozeny_carman ? space.per_initial_kozeny_carman : 0;
  mobility.most = coarsest / weight;
  for (std::size_t a = 0; a < space.permeability.size(); ++a) mobility.initial[a] = space.permeability[a] / weight;
  return mobility;
}

template <int Dim>
void PoreWater<Dim>::take_prediction(Scene<Dim>& scene, std::size_t b, const ParticleBlock<Dim>& block,
                                     Workspace<Dim>& work) {
  Columns& columns = scene.particles.columns;
  std::array<double*, Dim> change;
  for (int a = 0; a < Dim; ++a) change[a] = columns.data(acceleration_, a);
  from_nodes(scene, b, block, work.motion_tile.data(), [&](const BlockParticles<Dim>& particles, std::uint32_t) {
    scene.shape->gather_divergence(particles, work.motion_tile.data(), columns.data(divergence_), change);
  });
}

template <int Dim>
void PoreWater<Dim>::collect_at_rest(Scene<Dim>& scene, PressureEquation<Dim>& equation) {
  Columns& columns = scene.particles.columns;
  std::ranges::fill(columns.values(divergence_), 0.0);
  for (int a = 0; a < Dim; ++a) std::ranges::fill(columns.values(acceleration_, a), 0.0);
  for (std::size_t b = 0; b < scene.blocks.particle_blocks().size(); ++b)
    if (equation.is_wet(b)) collect(scene, b, scene.blocks.particle_blocks()[b], 1, {}, equation);
}

template <int Dim>
double PoreWater<Dim>::collect(Scene<Dim>& scene, std::size_t b, const ParticleBlock<Dim>& block, double kick,
                               const std::array<const double*, Dim>& relative, PressureEquation<Dim>& equation) {
  std::fill_n(equation.cell_sums(b), cell_tile<Dim>, CellSums<Dim>{});
  std::fill_n(equation.vertex_sums(b), vertex_tile<Dim>, Lane{});
  const Columns& columns = scene.particles.columns;
  WaterBatch<Dim> batch{.particles = scene.view(block),
                        .volume = columns.data(scene.particles.volume),
                        .mass = columns.data(scene.particles.mass),
                        .porosity = columns.data(porosity_),
                        .wet = columns.data(wet_),
                        .pressure = columns.data(pressure_),
                        .divergence = columns.data(divergence_),
                        .relative = relative,
                        .compressibility = water_.compressibility(),
                        .density = water_.density,
                        .kick = kick,
                        .gravity = scene.gravity};
  for (int a = 0; a < Dim; ++a) {
    batch.pressure_gradient[a] = columns.data(pressure_gradient_, a);
    batch.change[a] = columns.data(acceleration_, a);
  }
  double dissipated = 0;
  for (std::uint32_t k = block.first_batch; k < block.last_batch; ++k) {
    const Batch& particles = scene.blocks.batches()[k];
    const auto m = static_cast<std::size_t>(particles.material);
    const double modulus = materials_[m].elasticity().constrained_modulus();
    batch.particles.begin = particles.begin;
    batch.particles.end = particles.end;
    batch.liquid = spaces_[m].liquid;
    batch.mobility = mobility(spaces_[m]);
    batch.compliance = modulus > 0 ? 1 / modulus : 0;
    dissipated += add_water(batch, equation.cell_sums(b), equation.vertex_sums(b));
  }
  equation.check_cover(b);
  return dissipated;
}

// ---- volumes ----

template <int Dim>
void PoreWater<Dim>::follow_volume(Scene<Dim>& scene, const ParticleBlock<Dim>& block) {
  Columns& columns = scene.particles.columns;
  double* volume = columns.data(scene.particles.volume);
  double* mass = columns.data(scene.particles.mass);
  for (std::uint32_t k = block.first_batch; k < block.last_batch; ++k) {
    const Batch& batch = scene.blocks.batches()[k];
    const auto m = static_cast<std::size_t>(batch.material);
    const PoreSpace& space = spaces_[m];
    const double density = materials_[m].density();
    const std::uint32_t p = batch.begin;
    if (space.liquid) {
      // Its volume is that of its mass: strains hold errors of the projection, which would add up. The sign stays, by
      // which a point is found whose motion went bad.
      for (std::uint32_t q = p; q < batch.end; ++q) volume[q] = std::copysign(mass[q] / density, volume[q]);
    } else if (space.saturated) {
      pore_water::follow(batch.end - p, density / (1 - space.porosity), water_.density, volume + p,
                         columns.data(solid_mass_) + p, columns.data(wet_) + p, columns.data(porosity_) + p, mass + p,
                         columns.data(inertia_) + p, water_.formulation == Formulation::u_p);
    }
  }
}

template <int Dim>
void PoreWater<Dim>::compress(Scene<Dim>& scene, const ParticleBlock<Dim>& block, const double* solid,
                              const double* relative, double dt) {
  Columns& columns = scene.particles.columns;
  double* pressure = columns.data(pressure_);
  const double* porosity = columns.data(porosity_);
  const double* wet = columns.data(wet_);
  const double stiffness = 1 / water_.compressibility();
  for (std::uint32_t p = block.begin; p < block.end; ++p)
    if (wet[p] != 0) pressure[p] -= dt * stiffness / porosity[p] * (solid[p] + porosity[p] * relative[p]);
}

namespace {

/// The fast wave of a skeleton of modulus M and water of stiffness Q = K / n without drag between them; drag slows it
/// down to that of both as one. Partial densities [kg/m3]; returns (m/s)^2.
double fast_wave_squared(double M, double Q, double porosity, double solid, double water) {
  const double n = porosity, sum = (M + (1 - n) * (1 - n) * Q) / solid + n * n * Q / water;
  return 0.5 * (sum + std::sqrt(sum * sum - 4 * M * n * n * Q / (solid * water)));
}

}  // namespace

template <int Dim>
double PoreWater<Dim>::fastest_sound(const Particles& particles) const {
  const Columns& columns = particles.columns;
  double fastest = 0;
  for (std::size_t p = 0; p < particles.size(); ++p) {
    const auto m = static_cast<std::size_t>(particles.material[p]);
    const double modulus = materials_[m].elasticity().constrained_modulus(), n = columns.data(porosity_)[p];
    const double volume = columns.data(particles.volume)[p], density = columns.data(particles.mass)[p] / volume;
    const double wet = columns.data(wet_)[p] != 0 ? 1 / (water_.compressibility() * n) : 0;
    const double solid = columns.data(solid_mass_)[p] / volume;
    fastest = std::max(fastest, wet > 0 && density > solid ? fast_wave_squared(modulus, wet, n, solid, density - solid)
                                                           : (modulus + wet) / density);
  }
  return std::sqrt(fastest);
}

template <int Dim>
double PoreWater<Dim>::fastest_under_pressure(const Particles& particles) const {
  const Columns& columns = particles.columns;
  const double *const pressure = columns.data(pressure_), *const mass = columns.data(particles.mass);
  const double* const volume = columns.data(particles.volume);
  double fastest = 0;
  for (std::size_t p = 0; p < particles.size(); ++p)
    if (spaces_[static_cast<std::size_t>(particles.material[p])].liquid)
      fastest = std::max(fastest, pressure[p] * volume[p] / mass[p]);
  return std::sqrt(fastest);
}

template <int Dim>
double PoreWater<Dim>::compression_energy(const Particles& particles) const {
  const double compressibility = water_.compressibility();
  const Columns& columns = particles.columns;
  double sum = 0;
  for (std::size_t p = 0; p < particles.size(); ++p) {
    const double pressure = columns.data(pressure_)[p];
    sum += 0.5 * columns.data(particles.volume)[p] * columns.data(porosity_)[p] * compressibility * pressure * pressure;
  }
  return sum;
}

template class PoreWater<2>;
template class PoreWater<3>;

}  // namespace sluice
