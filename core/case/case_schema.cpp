#include "core/case/case_schema.h"

#include "core/case/case_tree.h"

#include <fmt/format.h>

#include <algorithm>

namespace sluice {

namespace {

const Components dimensions{{2, 3}};

// ---- grid
// --------------------------------------------------------------------------------------------------------------

void read_cell(GridCase& grid, const Node& node, Problems& problems) {
  if (node.kind == Node::Kind::list) {
    if (auto cell = value::quantities(node, "cell", unit::length, above(0), dimensions, problems)) grid.cell = *cell;
  } else if (const auto cell = value::quantity(node, "cell", unit::length, above(0), problems)) {
    grid.cell.assign(grid.min.empty() ? 1 : grid.min.size(), *cell);
  }
}

Schema<GridCase> grid_schema() {
  const FieldDoc cell{.name = "cell",
                      .type = field_type::quantity,
                      .unit = "m",
                      .range = "above 0; max - min must be a whole number of cells",
                      .sentence = "Cell size: one number for all axes, or one for each.",
                      .required = true,
                      .alternatives = {{.type = field_type::quantities, .unit = "m"}}};
  return Schema<GridCase>("grid")
      .quantities(
          "min", &GridCase::min, unit::length, any_number, dimensions,
          "Lower corner; two components make the case plane strain, three make it 3-D. The last axis points up.")
      .quantities("max", &GridCase::max, unit::length, any_number, dimensions, "Upper corner.")
      .custom(cell, read_cell, [](const GridCase& grid) { return value::from_quantities(grid.cell, unit::length); });
}

// ---- bodies
// ------------------------------------------------------------------------------------------------------------

Schema<BodyCase> body_schema() {
  auto schema = Schema<BodyCase>("body");
  schema.text("material", &BodyCase::material, "Name of one of the materials.")
      .custom(
          {.name = "particles_per_cell",
           .type = field_type::integer,
           .range = "n^2 in 2-D, n^3 in 3-D",
           .default_text = "4 in 2-D, 8 in 3-D",
           .sentence = "Material points in each full cell."},
          [](BodyCase& body, const Node& node, Problems& problems) {
            const auto n = value::integer(node, "particles_per_cell", from_to(1, 1e6), problems);
            if (n) body.particles_per_cell = static_cast<int>(*n);
          },
          [](const BodyCase& body) { return Node::text(std::to_string(body.particles_per_cell)); })
      .quantities("velocity", &BodyCase::velocity, unit::velocity, any_number, dimensions, "Initial velocity.",
                  Absent{"at rest"})
      .words(
          "replaces", &BodyCase::replaces,
          "Materials of earlier bodies that this body takes the place of where they overlap; without it an overlap is "
          "an error.");
  return with_shapes(
      schema, [](BodyCase& body) -> Region& { return body.region; },
      [](const BodyCase& body) -> const Region& { return body.region; });
}

// ---- boundaries
// --------------------------------------------------------------------------------------------------------

/// A face, or the surface of an obstacle, as it is written.
struct FaceKeys {
  FaceCase::Normal normal = FaceCase::Normal::free;
  std::optional<std::string> tangential;
  std::optional<double> friction, adhesion;
  std::vector<Table> velocity;
  std::optional<AbsorbingCase> absorbing;
};

using NormalWords = std::vector<std::pair<std::string, FaceCase::Normal>>;

const NormalWords& normal_words() {
  using Normal = FaceCase::Normal;
  static const NormalWords words{{"free", Normal::free}, {"fixed", Normal::fixed}, {"contact", Normal::contact}};
  return words;
}

std::string word_of(FaceCase::Normal normal) {
  for (const auto& [word, value] : normal_words())
    if (value == normal) return word;
  return {};
}

/// A list of components, each a quantity or a table.
std::vector<Table> read_velocity(const Node& node, Problems& problems) {
  std::vector<Table> velocity;
  const auto is_list = [](const Node& item) { return item.kind == Node::Kind::list; };
  if (node.kind != Node::Kind::list || std::ranges::none_of(node.items, is_list)) {
    const auto constant = value::quantities(node, "velocity", unit::velocity, any_number, dimensions, problems);
    for (const double component : constant.value_or(std::vector<double>{}))
      velocity.push_back(Table::constant(component));
    return velocity;
  }
  for (const Node& item : node.items)
    if (auto component = value::table(item, "velocity", unit::velocity, any_number, problems))
      velocity.push_back(std::move(*component));
  return velocity;
}

Node write_velocity(const std::vector<Table>& velocity) {
  Node list = Node::list();
  for (const Table& component : velocity) list.items.push_back(value::from_table(component, unit::velocity));
  return velocity.empty() ? Node{} : list;
}

/// Adds the keys of a surface to the schema of something that derives from FaceKeys.
template <class T>
Schema<T>& with_surface(Schema<T>& schema, const NormalWords& words, FaceCase::Normal otherwise,
                        const std::string& sentence) {
  return schema.template choice<FaceCase::Normal>("normal", &T::normal, words, sentence, otherwise)
      .custom(
          {.name = "tangential",
           .type = field_type::word,
           .default_text = "free, or friction where a coefficient or an adhesion is given",
           .sentence = "Motion along the face.",
           .words = {"free", "fixed", "friction"}},
          [](T& keys, const Node& node, Problems& problems) {
            keys.tangential = value::word(node, "tangential", {"free", "fixed", "friction"}, problems);
          },
          [](const T& keys) { return keys.tangential ? Node::text(*keys.tangential) : Node{}; })
      .quantity("friction", &T::friction, unit::none, at_least(0),
                "Coulomb coefficient of friction; needs `normal: fixed` or `contact`.")
      .quantity("adhesion", &T::adhesion, unit::stress, at_least(0),
                "Shear stress that friction may take without pressure; needs `normal: fixed`.")
      .custom(
          {.name = "velocity",
           .type = field_type::quantities,
           .unit = "m/s",
           .range = "2 or 3 components",
           .default_text = "at rest",
           .sentence = "Velocity of the face, in time: each component a value or points [[time, value], …]. Needs "
                       "`normal: fixed` or `contact`.",
           .alternatives = {{.type = field_type::points, .unit = "m/s"}}},
          [](T& keys, const Node& node, Problems& problems) { keys.velocity = read_velocity(node, problems); },
          [](const T& keys) { return write_velocity(keys.velocity); });
}

Schema<AbsorbingCase> absorbing_schema() {
  return Schema<AbsorbingCase>("absorbing")
      .quantity("density", &AbsorbingCase::density, unit::density, above(0), "Density beyond the face.")
      .quantity("p_wave", &AbsorbingCase::p_wave, unit::velocity, above(0), "Speed of compression waves.")
      .quantity("s_wave", &AbsorbingCase::s_wave, unit::velocity, at_least(0), "Speed of shear waves.");
}

Schema<FaceKeys> face_schema() {
  auto schema = Schema<FaceKeys>("face");
  return with_surface(schema, normal_words(), FaceCase::Normal::free,
                      "Motion through the face: free, none, or none but away from it.")
      .section(
          "absorbing", &FaceKeys::absorbing, absorbing_schema(),
          "Dashpots that let waves out, as if the material went on beyond the face; goes with no other key. The face "
          "keeps the traction that it has at the start.",
          Absent{"none"});
}

const std::vector<std::string> face_shorthands{"free", "roller", "fixed", "periodic"};

/// What the keys of a section mean; `name` is what messages call it.
FaceCase surface_of(const FaceKeys& keys, const Node& node, const std::string& name, Problems& problems) {
  using Tangential = FaceCase::Tangential;
  FaceCase face;
  face.normal = keys.normal;
  face.friction = keys.friction.value_or(0);
  face.adhesion = keys.adhesion.value_or(0);
  face.velocity = keys.velocity;
  face.absorbing = keys.absorbing;
  if (const Node* const absorbing = node.find("absorbing")) {
    if (node.items.size() > 1)
      problems.add(absorbing->place, fmt::format("{}: absorbing goes with no other key", name));
    if (keys.absorbing && keys.absorbing->s_wave >= keys.absorbing->p_wave)
      problems.add(absorbing->place, fmt::format("{}: absorbing: s_wave must be below p_wave", name));
    return face;
  }
  const bool rough = keys.friction || keys.adhesion;
  if (rough)
    face.tangential = Tangential::friction;
  else if (keys.tangential)
    face.tangential = *keys.tangential == "fixed" ? Tangential::fixed : Tangential::free;
  for (const char* const key : {"friction", "adhesion", "velocity"}) {
    const Node* const given = node.find(key);
    if (given == nullptr) continue;
    if (rough && std::string("velocity") != key && keys.tangential && *keys.tangential != "friction")
      problems.add(given->place, fmt::format("{}: {} contradicts `tangential: {}`; leave out one of them", name, key,
                                             *keys.tangential));
    const bool adhesion = std::string("adhesion") == key;
    if (adhesion && keys.normal != FaceCase::Normal::fixed)
      problems.add(given->place, fmt::format("{}: adhesion needs `normal: fixed`: what adheres does not let go", name));
    else if (keys.normal == FaceCase::Normal::free)
      problems.add(given->place, fmt::format("{}: {} needs `normal: fixed` or `normal: contact`", name, key));
  }
  if (keys.tangential && *keys.tangential == "friction" && !node.find("friction") && !node.find("adhesion"))
    problems.add(node.find("tangential")->place,
                 fmt::format("{}: `tangential: friction` needs a coefficient, for example friction: 0.4", name));
  return face;
}

FaceCase read_face(const Node& node, const std::string& name, Problems& problems) {
  using Tangential = FaceCase::Tangential;
  static const Schema<FaceKeys> schema = face_schema();
  if (node.kind != Node::Kind::scalar)
    return surface_of(schema.read(node, {}, problems), node, "boundaries." + name, problems);
  FaceCase face;
  const auto word = value::word(node, "boundaries." + name, face_shorthands, problems);
  face.periodic = word && *word == "periodic";
  if (word && *word != "free" && !face.periodic) face.normal = FaceCase::Normal::fixed;
  if (word && *word == "fixed") face.tangential = Tangential::fixed;
  return face;
}

void read_faces(Case& definition, const Node& node, Problems& problems) {
  if (node.kind != Node::Kind::map) {
    problems.add(node.place, fmt::format("boundaries: found {}; expected faces by name, for example {{bottom: fixed}}",
                                         description(node)));
    return;
  }
  for (std::size_t i = 0; i < node.items.size(); ++i) {
    const auto& [name, place] = node.keys[i];
    // Which of them the grid has is known only when its dimension is.
    definition.faces[name] = read_face(node.items[i], name, problems);
  }
}

/// Adds the keys that give this surface.
void write_surface(const FaceCase& face, Node& keys) {
  if (face.absorbing) {
    keys.set("absorbing", absorbing_schema().write(*face.absorbing));
    return;
  }
  keys.set("normal", Node::text(word_of(face.normal)));
  if (face.tangential == FaceCase::Tangential::friction) {
    keys.set("friction", value::from_quantity(face.friction, unit::none));
    if (face.adhesion > 0) keys.set("adhesion", value::from_quantity(face.adhesion, unit::stress));
  } else {
    keys.set("tangential", Node::text(face.tangential == FaceCase::Tangential::fixed ? "fixed" : "free"));
  }
  if (!face.velocity.empty()) keys.set("velocity", write_velocity(face.velocity));
}

Node write_faces(const Case& definition) {
  Node faces = Node::map();
  for (const std::string& name : face_words(definition.dimension())) {
    const auto found = definition.faces.find(name);
    const FaceCase face = found == definition.faces.end() ? FaceCase{} : found->second;
    Node keys = Node::map();
    write_surface(face, keys);
    faces.set(name, face.periodic ? Node::text("periodic") : keys);
  }
  return faces;
}

// ---- obstacles ----

struct ObstacleKeys : FaceKeys {
  Region region;
};

const Schema<ObstacleKeys>& obstacle_schema() {
  static const Schema<ObstacleKeys> schema = [] {
    Schema<ObstacleKeys> declared("obstacle");
    with_shapes(
        declared, [](ObstacleKeys& keys) -> Region& { return keys.region; },
        [](const ObstacleKeys& keys) -> const Region& { return keys.region; });
    return with_surface(declared, {normal_words().begin() + 1, normal_words().end()}, FaceCase::Normal::contact,
                        "Whether the material may move away from the surface (`contact`) or not (`fixed`).");
  }();
  return schema;
}

void read_obstacles(Case& definition, const Node& node, Problems& problems) {
  if (node.kind != Node::Kind::map) {
    problems.add(node.place,
                 fmt::format("obstacles: found {}; expected sections by name, NAME: {{…}}", description(node)));
    return;
  }
  for (std::size_t i = 0; i < node.items.size(); ++i) {
    const std::string& name = node.keys[i].first;
    const ObstacleKeys keys = obstacle_schema().read(node.items[i], {}, problems);
    const FaceCase surface = surface_of(keys, node.items[i], "obstacles." + name, problems);
    definition.obstacles.push_back({name, keys.region, surface, node.items[i].place});
  }
}

Node write_obstacles(const Case& definition) {
  Node all = Node::map();
  for (const ObstacleCase& obstacle : definition.obstacles) {
    Node keys = region_schema().write(obstacle.region);
    write_surface(obstacle.surface, keys);
    all.set(obstacle.name, keys);
  }
  return definition.obstacles.empty() ? Node{} : all;
}

// ---- changes ----

Schema<ChangeCase> change_schema() {
  return Schema<ChangeCase>("change")
      .quantity("at", &ChangeCase::at, unit::time, at_least(0), "Time of the change.")
      .text("material", &ChangeCase::material, "Material that gives way.")
      .text("becomes", &ChangeCase::becomes,
            "Material that takes its place; points keep their stress and all other state.");
}

// ---- contact ----

Schema<ContactCase> contact_schema() {
  return Schema<ContactCase>("contact")
      .words("materials", &ContactCase::materials,
             "Materials that are bodies of their own; all other materials together are one more.")
      .quantity("friction", &ContactCase::friction, unit::none, at_least(0), "Coulomb coefficient of friction.", 0.0)
      .quantity("adhesion", &ContactCase::adhesion, unit::stress, at_least(0),
                "Shear stress that friction may take without pressure.", 0.0)
      .quantities("normal", &ContactCase::normal, unit::none, any_number, dimensions,
                  "Normal of the surfaces where these are flat and known, for example a slope; either way round.",
                  Absent{"found from the particles: for surfaces along the grid"});
}

// ---- scheme
// ------------------------------------------------------------------------------------------------------------

void read_time_step(SchemeCase& scheme, const Node& node, Problems& problems) {
  if (node.kind == Node::Kind::scalar && node.scalar == "computed") return;
  if (node.kind == Node::Kind::scalar && nearest_word(node.scalar, {"computed"}) == "computed") {
    value::word(node, "time_step", {"computed"}, problems);
    return;
  }
  scheme.time_step_place = node.place;
  scheme.fixed_time_step = value::quantity(node, "time_step", unit::time, above(0), problems);
}

Schema<SchemeCase> scheme_schema() {
  using S = SchemeCase;
  const S defaults;
  return Schema<S>("scheme")
      .registered("preset", &S::preset, "presets",
                  "Values for the keys below that are not given. `balanced` is what stands below as default.",
                  defaults.preset)
      .registered("shape", &S::shape, "shapes", "Shape functions.", defaults.shape)
      .registered("transfer", &S::transfer, "transfers", "How velocity travels between particles and nodes.",
                  defaults.transfer)
      .quantity("flip_fraction", &S::flip_fraction, unit::none, from_to(0, 1),
                "Share of FLIP in the FLIP/PIC blend of `transfer: flip`; 1 is pure FLIP, 0 is pure PIC.",
                defaults.flip_fraction)
      .integer("xpic_order", &S::xpic_order, from_to(1, 20),
               "Order m of `transfer: xpic`: a step maps velocities m - 1 times more; 1 is PIC, many are FLIP without "
               "what the grid cannot see.",
               defaults.xpic_order)
      .word("stress_update", &S::stress_update, {"usf", "usl", "musl"},
            "When the stress is updated: first in the step, last, or last with velocities mapped a second time.",
            defaults.stress_update)
      .word("integration", &S::integration, {"explicit", "implicit_static", "implicit_newmark"},
            "Steps forward in time: explicit; implicit without inertia, from equilibrium to equilibrium; or implicit "
            "with inertia (Newmark, average acceleration). Implicit steps are for `physics: total_stress` and need "
            "`time_step`.",
            defaults.integration)
      .quantity("tolerance", &S::tolerance, unit::none, above_to(0, 0.1),
                "For implicit steps: the largest force out of balance on a node, as a share of the largest force on a "
                "node.",
                defaults.tolerance)
      .quantity("gravity_ramp", &S::gravity_ramp, unit::time, at_least(0),
                "For `implicit_static`: time over which gravity grows from nothing to its full value.",
                defaults.gravity_ramp)
      .quantity("ghost_penalty", &S::ghost_penalty, unit::none, at_least(0),
                "Of implicit steps: stiffness, over twice the shear modulus, that holds nodes which material "
                "hardly reaches to the displacements inside; 0 lets such nodes fly, and steps fail.",
                defaults.ghost_penalty)
      .word("strain", &S::strain, {"jaumann", "hencky"},
            "How stress follows large strain: elasticity in rate form, turned with the material; or in logarithmic "
            "strain, "
            "for materials whose elasticity is linear.",
            defaults.strain)
      .boolean("f_bar", &S::f_bar, "Average volumetric strain increments over cells, against volumetric locking.",
               defaults.f_bar)
      .custom({.name = "time_step",
               .type = field_type::quantity,
               .unit = "s",
               .range = "above 0",
               .default_text = "computed",
               .sentence = "Length of the step, or `computed`: anew in every step from the limits below.",
               .default_value = Node::text("computed"),
               .alternatives = {{.type = field_type::word, .words = {"computed"}}}},
              read_time_step,
              [](const S& scheme) {
                return scheme.fixed_time_step ? value::from_quantity(*scheme.fixed_time_step, unit::time)
                                              : Node::text("computed");
              })
      .quantity("courant", &S::courant, unit::none, above_to(0, 1),
                "Wave limit of the computed step: courant h / (c + speed).", defaults.courant)
      .quantity("advection", &S::advection, unit::none, above_to(0, 1),
                "Advection limit: share of a cell that a particle crosses in a step.", defaults.advection)
      .quantity("strain_per_step", &S::strain_per_step, unit::none, above_to(0, 1),
                "Strain limit: largest strain increment in a step.", defaults.strain_per_step);
}

// ---- observations, output
// ----------------------------------------------------------------------------------------------

Schema<ObservationCase> observation_schema() {
  return Schema<ObservationCase>("observation")
      .registered("measure", &ObservationCase::measure, "measures", "What is measured.")
      .quantities("direction", &ObservationCase::direction, unit::none, any_number, dimensions,
                  "Direction, for the measures that need one; of any length but 0.", Absent{})
      .section(
          "region", &ObservationCase::region, region_schema(),
          "Where the material that is followed lies at the start, for the measures that take a region: one shape, or "
          "the intersection of several.",
          Absent{"everything"})
      .text("field", &ObservationCase::field,
            "Field of results.h5, for the measures that need one, for example `pore_pressure`.", Absent{});
}

Schema<OutputCase> output_schema() {
  using O = OutputCase;
  const O defaults;
  return Schema<O>("output")
      .quantity("every", &O::every, unit::time, at_least(0),
                "Time between the states in results.h5; 0: only the first and the last.", defaults.every)
      .quantity(
          "history_every", &O::history_every, unit::time, at_least(0),
          "Time between rows of history.csv and observations.csv; 0: every step, which can take longer than the steps.",
          Absent{"a thousandth of `end_time`"})
      .words("pictures", &O::pictures, "Columns of which pictures are drawn.")
      .quantities("picture_times", &O::picture_times, unit::time, at_least(0), {}, "Times of the rows of the pictures.",
                  Absent{"four, evenly spaced"})
      .quantity("checkpoint_every", &O::checkpoint_every, unit::time, above(0), "Wall-clock time between checkpoints.",
                defaults.checkpoint_every);
}

// ---- the case
// ----------------------------------------------------------------------------------------------------------

void read_materials(Case& definition, const Node& node, Problems& problems) {
  if (node.kind != Node::Kind::map || node.items.empty()) {
    problems.add(node.place, fmt::format("materials: found {}; expected materials by name, NAME: {{model: …, …}}",
                                         node.kind == Node::Kind::map ? "an empty map" : description(node)));
    return;
  }
  for (std::size_t i = 0; i < node.items.size(); ++i) {
    const auto& name = node.keys[i].first;
    const Node& section = node.items[i];
    definition.materials.emplace_back(name, section);
    if (section.kind != Node::Kind::map)
      problems.add(section.place,
                   fmt::format("material '{}': found {}; expected a section with a model", name, description(section)));
    else if (const Node* const model = section.find("model"))
      value::registered(*model, "model", "materials", problems);
    else
      problems.add(section.place, fmt::format("material '{}': the key 'model' is missing", name));
  }
}

Node write_materials(const Case& definition) {
  Node materials = Node::map();
  for (const auto& [name, section] : definition.materials) materials.set(name, section);
  return materials;
}

Schema<Case> make_case_schema() {
  return Schema<Case>("the case")
      .custom(
          {.name = "schema",
           .type = field_type::integer,
           .range = "1",
           .sentence = "Version of the case-file format.",
           .required = true},
          [](Case&, const Node& node, Problems& problems) { check_schema_version(node, problems); },
          [](const Case&) { return Node::text("1"); })
      .text("title", &Case::title, "What the case is, in a line.", "untitled")
      .registered("physics", &Case::physics, "physics", "The physics module.")
      .section("grid", &Case::grid, grid_schema(), "The background grid: a box of uniform cells.")
      .quantities("gravity", &Case::gravity, unit::acceleration, any_number, dimensions, "Gravity, in any direction.",
                  Absent{"zero"})
      .custom({.name = "materials",
               .type = field_type::named_sections,
               .sentence = "Materials by name; `model` names the constitutive model, whose keys are listed under "
                           "*materials* below.",
               .required = true},
              read_materials, write_materials)
      .sections("bodies", &Case::bodies, body_schema(),
                "Regions filled with material points: each one shape, or the intersection of several.", true)
      .custom({.name = "boundaries",
               .type = field_type::named_sections,
               .default_text = "every face free",
               .sentence = "Faces of the grid: left, right, bottom, top, and front, back in 3-D. A word is short for a "
                           "section: `fixed` fixes all motion, `roller` the normal one, `free` none. Both faces of an "
                           "axis may be `periodic`: what leaves through one comes in at the other; the axis then has a "
                           "multiple of 8 cells in 2-D, of 4 in 3-D.",
               .nested = face_schema().docs(),
               .alternatives = {{.type = field_type::word, .words = face_shorthands}}},
              read_faces, write_faces)
      .custom({.name = "obstacles",
               .type = field_type::named_sections,
               .default_text = "none",
               .sentence = "Rigid regions inside the grid that keep material out, by name: each one shape, or the "
                           "intersection of several. They move with their velocity.",
               .nested = obstacle_schema().docs()},
              read_obstacles, write_obstacles)
      .kept({.name = "initial_stress",
             .type = field_type::section,
             .default_text = "no stress",
             .sentence = "Stress in the ground before anything moves; read by the physics module."},
            &Case::initial_stress)
      .kept({.name = "surface_loads",
             .type = field_type::sections,
             .default_text = "none",
             .sentence = "Pressures on the surface of the material; read by the physics module."},
            &Case::surface_loads)
      .kept({.name = "water",
             .type = field_type::section,
             .default_text = "none",
             .sentence = "Water in the pores and beside the soil; read by the physics module `two_phase`."},
            &Case::water)
      .kept({.name = "advice",
             .type = field_type::section,
             .default_text = "guessed from the case",
             .sentence =
                 "What `sluice check` and `physics: auto` judge the case by; read by advisors, see `auto` below."},
            &Case::advice)
      .sections("changes", &Case::changes, change_schema(), "Materials that give way to others during the run.", false)
      .section("contact", &Case::contact, contact_schema(), "Bodies that do not stick to each other where they touch.",
               Absent{"all bodies stick together"})
      .section("scheme", &Case::scheme, scheme_schema(), "How the equations are discretised.")
      .choice<OutflowPolicy>(
          "outflow", &Case::outflow,
          {{"error", OutflowPolicy::error}, {"remove", OutflowPolicy::remove}, {"clamp", OutflowPolicy::clamp}},
          "What happens to a particle that leaves the grid: the run stops, the particle is taken out, or "
          "it is put back to the edge.",
          OutflowPolicy::error)
      .quantity("end_time", &Case::end_time, unit::time, above(0), "Time that is simulated.")
      .named_sections("observe", &Case::observe, observation_schema(),
                      "Numbers that are followed during the run and written to observations.csv, by name.")
      .section("output", &Case::output, output_schema(), "What is written, and when.");
}

}  // namespace

const Schema<Case>& case_schema() {
  static const Schema<Case> schema = make_case_schema();
  return schema;
}

std::vector<std::string> face_words(int dimension) {
  if (dimension == 2) return {"left", "right", "bottom", "top"};
  return {"left", "right", "front", "back", "bottom", "top"};
}

}  // namespace sluice
