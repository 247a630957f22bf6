#include "physics/advice/scene_numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "core/case/case_schema.h"
#include "physics/loads/external_pressure.h"
#include "physics/two_phase/pore_water.h"

namespace sluice::advice {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Soil that is so much more permeable lets the water of its neighbour go as a free surface does.
constexpr double as_good_as_open = 100;

/// The case with materials that constitutive models and the physics can read.
Case plain(Case definition) {
  for (auto& [name, section] : definition.materials) section.erase(undrained_key);
  return definition;
}

// ---- soils ----

void fill_pores(SoilNumbers& s, double conductivity, double porosity, const SceneNumbers& scene) {
  s.wet = true;
  s.soil.porosity = porosity;
  s.soil.conductivity = conductivity;
  s.soil.gravity = standard_gravity;
  s.soil.modulus = s.elasticity.constrained_modulus();
  s.soil.water_density = scene.water.density;
  const double compressibility = scene.water.compressibility();
  s.soil.water_bulk_modulus = compressibility > 0 ? 1 / compressibility : scene.asked.water_bulk_modulus;
}

SoilNumbers soil_of(const std::string& name, const Node& section) {
  SoilNumbers s;
  s.name = name;
  Node own = section;
  own.erase("water");
  own.erase(undrained_key);
  const auto material = make_material(own);
  s.liquid = material->liquid();
  s.strength = material->strength();
  s.elasticity = material->elasticity();
  s.density = s.dry_density = material->density();
  return s;
}

/// Of a case with water: what the materials say.
void add_water(SoilNumbers& s, const PoreSpace& pores, const Node& section, const SceneNumbers& scene) {
  if (!pores.saturated || pores.liquid) return;
  fill_pores(s, std::ranges::max(pores.permeability), pores.porosity, scene);
  s.least_conductivity = std::ranges::min(pores.permeability);
  s.soil.solid_density = s.dry_density / (1 - pores.porosity);
  s.density = s.soil.density();
  s.undrained_modulus = s.soil.modulus + s.soil.water_bulk_modulus / pores.porosity;
  if (const Node* const undrained = section.find(undrained_key)) {
    s.has_undrained = true;
    s.undrained_modulus = make_material(*undrained)->elasticity().constrained_modulus();
  }
}

/// Of a case in total stresses: what the section `advice` says.
void add_advice(SoilNumbers& s, const PoresCase& pores, const SceneNumbers& scene) {
  s.unknown_water = false;
  const double given = s.elasticity.constrained_modulus();
  fill_pores(s, pores.permeability, pores.porosity, scene);
  s.soil.water_density = scene.asked.water_density;
  s.soil.water_bulk_modulus = scene.asked.water_bulk_modulus;
  s.least_conductivity = pores.permeability;
  s.dry_density = s.density - pores.porosity * scene.asked.water_density;
  s.soil.solid_density = s.dry_density / (1 - pores.porosity);
  s.has_undrained = true;
  s.undrained_modulus = given;
  // Nearly incompressible total stresses are those of undrained soil: the skeleton has the same shear modulus, and a
  // Poisson ratio of 0.3 makes M = 3.5 G.
  const double poisson = s.elasticity.poisson_ratio();
  s.soil.modulus = pores.constrained_modulus.value_or(poisson > 0.45 ? 3.5 * s.elasticity.shear : given);
}

void read_soils(SceneNumbers& scene, const Case& definition) {
  const bool with_water = definition.physics != "total_stress";
  Case readable = plain(definition);
  WaterCase any = scene.water;
  any.formulation = Formulation::v_w_p;  // which takes every permeability
  std::vector<SoilNumbers> all;
  std::vector<bool> liquid;
  for (const auto& [name, section] : definition.materials) {
    all.push_back(soil_of(name, section));
    liquid.push_back(all.back().liquid);
  }
  const auto pores = with_water ? read_pore_spaces(readable, any, liquid) : std::vector<PoreSpace>();
  for (std::size_t m = 0; m < all.size(); ++m) {
    const auto& [name, section] = definition.materials[m];
    if (with_water) add_water(all[m], pores[m], section, scene);
    all[m].unknown_water = !with_water && !all[m].liquid;
    for (const PoresCase& given : scene.asked.materials)
      if (given.name == name) add_advice(all[m], given, scene);
  }
  scene.soils = std::move(all);
}

// ---- how far water has to go ----

/// Whether water passes the face of the grid.
bool open_face(const SceneNumbers& scene, const std::string& name) {
  const auto face = scene.water.faces.find(name);
  return face != scene.water.faces.end() && (face->second.pressure || face->second.head);
}

double drainage_length(const SceneNumbers& scene, const Case& definition, const SceneLattice& lattice, int material) {
  using Passage = SceneLattice::Passage;
  const auto last = static_cast<std::size_t>(definition.dimension() - 1);
  const double own = scene.soils[static_cast<std::size_t>(material)].soil.conductivity;
  const auto passage = [&](std::size_t i) {
    const auto x = lattice.point(i);
    const int m = lattice.material(i);
    if (m < 0) {
      const auto at = std::span(x).first(last + 1);
      const bool rigid =
          std::ranges::any_of(definition.obstacles, [&](const ObstacleCase& o) { return o.region.contains(at); });
      return rigid ? Passage::closed : Passage::open;
    }
    const SoilNumbers& there = scene.soils[static_cast<std::size_t>(m)];
    if (!there.wet || there.soil.conductivity >= as_good_as_open * own) return Passage::open;
    return scene.water.below_table(x[0], x[last]) ? Passage::through : Passage::open;
  };
  const auto names = face_words(definition.dimension());
  const auto face = [&](int axis, bool upper) {
    return open_face(scene, names[static_cast<std::size_t>(2 * axis + (upper ? 1 : 0))]);
  };
  return lattice.drainage_length(material, passage, face);
}

// ---- how the load comes ----

struct Gathered {
  std::vector<Stage> stages;

  void add(const std::string& name, double seconds) {
    stages.push_back({fmt::format("{}, {:.3g} s", name, seconds), Loading::within(seconds)});
  }
  /// What changes in time: to and fro if it turns at least four times, otherwise once.
  void add(const std::string& name, const Table& table) {
    std::vector<double> turns;
    double first = infinity, last = -infinity, slope = 0;
    for (std::size_t i = 1; i < table.value.size(); ++i) {
      const double change = table.value[i] - table.value[i - 1];
      if (change == 0) continue;
      first = std::min(first, table.time[i - 1]);
      last = std::max(last, table.time[i]);
      if (slope * change < 0) turns.push_back(table.time[i - 1]);
      slope = change;
    }
    if (last <= first) return;
    if (turns.size() < 4) {
      add(name, last - first);
      return;
    }
    const double frequency = static_cast<double>(turns.size() - 1) / (2 * (turns.back() - turns.front()));
    stages.push_back({fmt::format("{}, {:.3g} Hz", name, frequency), Loading::at_frequency(frequency)});
  }
};

void add_tables(Gathered& gathered, const SceneNumbers& scene, const Case& definition) {
  for (const SurfaceLoad& load : read_surface_loads(definition)) {
    if (load.pressure) gathered.add("surface_loads", *load.pressure);
    if (load.level) gathered.add("surface_loads", *load.level);
  }
  for (const Pond& pond : scene.water.ponds) gathered.add("water.ponds", pond.level);
  for (const auto& [name, face] : scene.water.faces)
    for (const auto* table : {&face.pressure, &face.head, &face.flux})
      if (*table) gathered.add("water.faces." + name, **table);
  for (const auto& [name, face] : definition.faces)
    for (const Table& velocity : face.velocity) gathered.add("boundaries." + name, velocity);
  for (const ObstacleCase& obstacle : definition.obstacles)
    for (const Table& velocity : obstacle.surface.velocity) gathered.add("obstacles." + obstacle.name, velocity);
}

bool may_flow(const SoilNumbers& soil) { return soil.liquid || soil.strength != Strength::unlimited; }

double gravity_of(const Case& definition) {
  double g = 0;
  for (const double component : definition.gravity) g = std::hypot(g, component);
  return g;
}

void find_stages(SceneNumbers& scene, const Case& definition) {
  const AdviceCase& asked = scene.asked;
  scene.guessed_stages = false;
  const auto given = [&](const std::string& name, const std::optional<double>& time,
                         const std::optional<double>& rate) {
    if (time) scene.stages.push_back({fmt::format("{}{:.3g} s", name, *time), Loading::within(*time)});
    if (rate) scene.stages.push_back({fmt::format("{}{:.3g} Hz", name, *rate), Loading::at_frequency(*rate)});
  };
  given("", asked.loading_time, asked.frequency);
  for (const StageCase& stage : asked.stages) given(stage.name + ", ", stage.loading_time, stage.frequency);
  if (!scene.stages.empty()) return;
  scene.guessed_stages = true;
  Gathered gathered;
  add_tables(gathered, scene, definition);
  const double g = gravity_of(definition);
  if (g > 0 && scene.height > 0 && std::ranges::any_of(scene.soils, may_flow))
    gathered.add("a fall by the height of the scene", std::sqrt(2 * scene.height / g));
  gathered.stages.push_back(
      {fmt::format("the whole run, {:.3g} s", definition.end_time), Loading::for_a_time(definition.end_time)});
  scene.stages = std::move(gathered.stages);
}

// ---- geometry ----

void find_layers(SceneNumbers& scene, const Case& definition, const SceneLattice& lattice) {
  const auto thickness = lattice.thickness();
  for (std::size_t b = 0; b < thickness.size(); ++b)
    if (thickness[b] > 0) scene.layers.push_back({definition.bodies[b].material, thickness[b]});
}

bool still(const std::vector<Table>& velocity, std::size_t axis) {
  return velocity.empty() || std::ranges::all_of(velocity[axis].value, [](double v) { return v == 0; });
}

/// Smooth, impermeable, at rest: or nothing lies there, which the lattice sees.
bool plane_of_symmetry(const SceneNumbers& scene, const Case& definition, const std::string& name) {
  const FaceCase& face = definition.faces.at(name);
  const auto water = scene.water.faces.find(name);
  const bool passes = open_face(scene, name) || (water != scene.water.faces.end() && water->second.flux);
  return face.normal == FaceCase::Normal::fixed && face.tangential == FaceCase::Tangential::free && !face.absorbing &&
         std::ranges::all_of(face.velocity, [](const Table& t) { return still({t}, 0); }) && !passes;
}

/// What the places of loads, obstacles and the water table make of a point, as one number.
double marks(const SceneNumbers& scene, const Case& definition, const std::vector<SurfaceLoad>& loads,
             std::span<const double> x) {
  double sum = 0, weight = 1;
  const auto add = [&](double value) { sum += (weight *= 1.618) * value; };
  const auto region = [&](const std::optional<Region>& where, double fade) {
    if (where) add(where->contains(x) ? 0 : std::min(where->distance_outside(x), fade) + 1);
  };
  for (const SurfaceLoad& load : loads) region(load.region, load.fade);
  for (const Pond& pond : scene.water.ponds) region(pond.region, pond.fade);
  for (const ObstacleCase& obstacle : definition.obstacles) region(obstacle.region, 0);
  if (!scene.water.table.empty()) add(scene.water.table_level(x.front()));
  return sum;
}

bool varies_not(const SceneNumbers& scene, const Case& definition, const SceneLattice& lattice,
                const std::vector<SurfaceLoad>& loads, int axis) {
  const auto a = static_cast<std::size_t>(axis);
  const auto dimension = static_cast<std::size_t>(definition.dimension());
  const auto names = face_words(definition.dimension());
  if (definition.gravity[a] != 0 || definition.grid.max[a] - definition.grid.min[a] < 1.5 * definition.grid.cell[a])
    return false;
  for (const std::size_t side : {2 * a, 2 * a + 1})
    if (!plane_of_symmetry(scene, definition, names[side])) return false;
  for (const auto& [name, face] : definition.faces)
    if (!still(face.velocity, a)) return false;
  for (const ObstacleCase& obstacle : definition.obstacles)
    if (!still(obstacle.surface.velocity, a)) return false;
  for (const BodyCase& body : definition.bodies)
    if (body.velocity[a] != 0) return false;
  if (const Node* const method = definition.initial_stress.find("method"); method && method->scalar == "from_file")
    return false;
  return lattice.same_along(axis, [&](std::size_t i) {
    const auto x = lattice.point(i);
    double key = 1000 * lattice.material(i) + marks(scene, definition, loads, std::span(x).first(dimension));
    if (lattice.body(i) >= 0)
      for (const double v : definition.bodies[static_cast<std::size_t>(lattice.body(i))].velocity)
        key = 1.618 * key + v;
    return key;
  });
}

void find_symmetry(SceneNumbers& scene, const Case& definition, const SceneLattice& lattice) {
  const auto loads = read_surface_loads(definition);
  for (int axis = 0; axis < definition.dimension(); ++axis)
    if (varies_not(scene, definition, lattice, loads, axis)) {
      const auto a = static_cast<std::size_t>(axis);
      scene.same_along.emplace_back(axis == 0 ? "x" : axis == 1 ? "y" : "z");
      scene.cells_along.push_back(lattice.extent(axis) / definition.grid.cell[a]);
    }
}

double largest(const Table& table) {
  double value = 0;
  for (const double v : table.value) value = std::max(value, std::abs(v));
  return value;
}

void find_strain(SceneNumbers& scene, const Case& definition) {
  const double g = gravity_of(definition);
  double load = 0;
  for (const SurfaceLoad& l : read_surface_loads(definition))
    load += l.pressure ? largest(*l.pressure) : l.unit_weight * scene.height;
  bool driven = false;
  for (const auto& [name, face] : definition.faces) driven = driven || !face.velocity.empty();
  for (const ObstacleCase& obstacle : definition.obstacles) driven = driven || !obstacle.surface.velocity.empty();
  for (const BodyCase& body : definition.bodies)
    driven = driven || std::ranges::any_of(body.velocity, [](double v) { return v != 0; });
  for (const SoilNumbers& soil : scene.soils) {
    const double stress = soil.density * g * scene.height + load;
    const bool flows = may_flow(soil) && (g > 0 || driven || load > 0);
    const double strain = flows || driven ? infinity : stress / soil.elasticity.constrained_modulus();
    scene.expected_strain = std::max(scene.expected_strain, strain);
  }
}

}  // namespace

bool SceneNumbers::any_wet() const { return std::ranges::any_of(soils, &SoilNumbers::wet); }
bool SceneNumbers::any_liquid() const { return std::ranges::any_of(soils, &SoilNumbers::liquid); }
bool SceneNumbers::any_unknown() const { return std::ranges::any_of(soils, &SoilNumbers::unknown_water); }

SceneNumbers numbers_of(const Case& definition) {
  SceneNumbers scene;
  scene.asked = read_advice(definition);
  if (definition.physics != "total_stress") {
    scene.water = read_water(plain(definition));
  }
  const SceneLattice lattice(definition);
  scene.height = lattice.extent(definition.dimension() - 1);
  read_soils(scene, definition);
  find_strain(scene, definition);
  find_layers(scene, definition, lattice);
  find_symmetry(scene, definition, lattice);
  find_stages(scene, definition);
  for (std::size_t m = 0; m < scene.soils.size(); ++m)
    if (scene.soils[m].wet)
      scene.soils[m].drainage_length = drainage_length(scene, definition, lattice, static_cast<int>(m));
  // A material without points yet is where what becomes of it lies.
  for (const ChangeCase& change : definition.changes) {
    const auto named = [&](const std::string& name) {
      return std::ranges::find(scene.soils, name, &SoilNumbers::name);
    };
    const auto from = named(change.material), to = named(change.becomes);
    if (from != scene.soils.end() && to != scene.soils.end())
      to->drainage_length = std::max(to->drainage_length, from->drainage_length);
  }
  std::erase_if(scene.soils, [&](const SoilNumbers& soil) {
    const auto used = [&](const std::string& name) { return name == soil.name; };
    return std::ranges::none_of(definition.bodies, used, &BodyCase::material) &&
           std::ranges::none_of(definition.changes, used, &ChangeCase::becomes);
  });
  return scene;
}

}  // namespace sluice::advice
