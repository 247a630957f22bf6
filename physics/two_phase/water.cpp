#include "physics/two_phase/water.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/case/case_schema.h"

namespace sluice {

namespace {

constexpr double atmospheric_pressure = 101325;  // [Pa]

const Schema<WaterFace>& face_schema() {
  static const auto schema =
      Schema<WaterFace>("water face")
          .table("pressure", &WaterFace::pressure, unit::stress, any_number, "Pore pressure on the face, in time.")
          .table("head", &WaterFace::head, unit::length, any_number,
                 "Level of the water beyond the face, in time: hydrostatic pressure below it, impermeable above.")
          .table("flux", &WaterFace::flux, unit::velocity, any_number,
                 "Water that leaves through the face, volume per area and time, in time; negative: that enters.");
  return schema;
}

const std::vector<std::string> face_shorthands{"impermeable", "drained"};

WaterFace read_face(const std::string& name, const Node& node, Problems& problems) {
  WaterFace face;
  if (node.kind == Node::Kind::scalar) {
    const auto word = value::word(node, "water.faces." + name, face_shorthands, problems);
    if (word && *word == "drained") face.pressure = Table::constant(0);
    return face;
  }
  face = face_schema().read(node, {}, problems);
  if (face.pressure.has_value() + face.head.has_value() + face.flux.has_value() != 1)
    problems.add(node.place, fmt::format("water.faces.{}: give one of pressure, head, flux, or one of the words "
                                         "impermeable, drained",
                                         name));
  return face;
}

void read_faces(WaterCase& water, const Node& node, Problems& problems) {
  if (node.kind != Node::Kind::map) {
    problems.add(node.place, fmt::format("water.faces: found {}; expected faces by name, for example {{top: drained}}",
                                         description(node)));
    return;
  }
  for (std::size_t i = 0; i < node.items.size(); ++i)
    water.faces[node.keys[i].first] = read_face(node.keys[i].first, node.items[i], problems);
}

Node write_faces(const WaterCase& water) {
  Node faces = Node::map();
  for (const auto& [name, face] : water.faces) {
    const Node keys = face_schema().write(face);
    faces.set(name, keys.items.empty() ? Node::text("impermeable") : keys);
  }
  return faces;
}

void read_table(WaterCase& water, const Node& node, Problems& problems) {
  for (const Node& item : node.items) {
    const auto x = value::quantities(item, "point of the water table", unit::length, any_number, {{2}}, problems);
    if (!x) return;
    if (!water.table.empty() && (*x)[0] <= water.table.back()[0])
      problems.add(item.place, fmt::format("water.table: x = {:g} m must be beyond that of the point before, {:g} m",
                                           (*x)[0], water.table.back()[0]));
    water.table.push_back({(*x)[0], (*x)[1]});
  }
  if (node.kind != Node::Kind::list || water.table.empty())
    problems.add(node.place, fmt::format("water.table: found {}; expected points [[x, y], …]", description(node)));
}

Node write_table(const WaterCase& water) {
  Node points = Node::list();
  for (const auto& [x, z] : water.table) points.items.push_back(value::from_quantities({x, z}, unit::length));
  return points.items.empty() ? Node{} : points;
}

const Schema<InitialPressure>& initial_schema() {
  using enum InitialPressure::Method;
  static const auto schema =
      Schema<InitialPressure>("initial pore pressure")
          .choice(
              "method", &InitialPressure::method,
              {{"none", none}, {"uniform", uniform}, {"hydrostatic", hydrostatic}, {"steady_seepage", steady_seepage}},
              "How the pore pressure before the first step is found: zero; the same everywhere; hydrostatic below the "
              "water table, or below a level; or steady seepage between the pressures on faces and surfaces.",
              none)
          .quantity("pressure", &InitialPressure::pressure, unit::stress, any_number, "For `uniform`.", 0.0)
          .quantity("level", &InitialPressure::level, unit::length, any_number,
                    "For `hydrostatic` without a water table: height where the pressure is zero.")
          .quantity("suction", &InitialPressure::suction, unit::stress, at_least(0),
                    "For `hydrostatic`: most suction above the level, where the soil is saturated all the same.",
                    Absent{"unlimited"});
  return schema;
}

const Schema<LaggedCholeskyOptions>& solver_schema() {
  using O = LaggedCholeskyOptions;
  using Ordering = O::Ordering;
  using Choice = O::Choice;
  const O defaults;
  static const auto schema =
      Schema<O>("water solver")
          .choice("ordering", &O::ordering,
                  {{"measured", Ordering::measured},
                   {"minimum_degree", Ordering::minimum_degree},
                   {"nested_dissection", Ordering::nested_dissection},
                   {"geometric", Ordering::given}},
                  "Order of elimination: whichever gives the least work, AMD, METIS, or dissection of the grid.",
                  defaults.ordering)
          .choice(
              "factorize", &O::choice,
              {{"counted", Choice::counted}, {"measured", Choice::measured}, {"always", Choice::direct}},
              "When the matrix is factorized anew rather than the last factor used as a preconditioner: by counted "
              "operations, which gives the same bits on every machine and after a restart; by measured times, which "
              "does not; or always.",
              defaults.choice)
          .quantity("tolerance", &O::relative_tolerance, unit::none, above_to(0, 1e-3), "Relative residual.",
                    defaults.relative_tolerance)
          .integer("threads", &O::blas_threads, from_to(1, 64),
                   "Threads of the factorization. With more than one, the last bits depend on the number.",
                   defaults.blas_threads);
  return schema;
}

const Schema<WaterCase>& schema() {
  using W = WaterCase;
  static const auto declared =
      Schema<W>("water")
          .choice(
              "formulation", &W::formulation,
              {{"u-p", Formulation::u_p}, {"v-w-p", Formulation::v_w_p}, {"explicit", Formulation::explicit_}},
              "u-p: water accelerates with the solid. v-w-p: water keeps an inertia of its own, for coarse and fast "
              "cases. explicit: the latter without a solve for the pressure, in steps that the sound in water limits.",
              Formulation::u_p)
          .quantity("density", &W::density, unit::density, above(0), "Density of the water.", 1000.0)
          .quantity("bulk_modulus", &W::bulk_modulus, unit::stress, above(0), "Bulk modulus of the water.",
                    Absent{"incompressible"})
          .quantity("saturation", &W::saturation, unit::none, above_to(0, 1),
                    "Degree of saturation; below 1, air softens the water: 1/K = S/K_w + (1 - S)/101325 Pa.", 1.0)
          .quantity("increment", &W::increment, unit::none, from_to(0, 1),
                    "Share of the old pressure in the predictor: 1 solves for increments of the pressure, 0 "
                    "for the whole.",
                    1.0)
          .boolean("stabilisation", &W::stabilisation,
                   "Against oscillations of the undrained pressure in short steps, and where particles lie unevenly; "
                   "acts only there.",
                   true)
          .boolean(
              "join_films", &W::join_films,
              "Films on faces of the grid that are thinner than 0.4 of a cell move as one; without, for comparison, "
              "they may burst.",
              true)
          .choice("surface", &W::surface_within_cells, {{"within_cells", true}, {"at_vertices", false}},
                  "Where the pressure is that of the air: where the surface is found between two vertices, or at the "
                  "first vertices outside of it: for comparison, wrong by up to a cell.",
                  true)
          .custom({.name = "table",
                   .type = field_type::points,
                   .unit = "m",
                   .range = "points [x, y] with ascending x; [x, z] in 3-D",
                   .default_text = "everything is saturated",
                   .sentence = "The water table: material that lies above it at the start holds no water."},
                  read_table, write_table)
          .section("initial", &W::initial, initial_schema(), "The pore pressure before the first step.")
          .custom({.name = "faces",
                   .type = field_type::named_sections,
                   .default_text = "every face impermeable",
                   .sentence = "What faces of the grid are to the water.",
                   .nested = face_schema().docs(),
                   .alternatives = {{.type = field_type::word, .words = face_shorthands}}},
                  read_faces, write_faces)
          .sections(
              "ponds", &W::ponds, pond_schema(),
              "Water that stands on the surface of the soil: its weight presses, and its pressure stands in the pores "
              "of the surface. Everywhere else the surface has zero pressure.",
              false)
          .section("solver", &W::solver, solver_schema(), "How the system of the pore pressure is solved.");
  return declared;
}

void read_permeability(PoreSpace& pores, const Node& node, Problems& problems) {
  if (node.kind == Node::Kind::list) {
    if (const auto k = value::quantities(node, "permeability", unit::velocity, above(0), {{2, 3}}, problems))
      pores.permeability = *k;
  } else if (const auto k = value::quantity(node, "permeability", unit::velocity, above(0), problems)) {
    pores.permeability = {*k};
  }
}

const Schema<PoreSpace>& pore_schema() {
  static const auto declared =
      Schema<PoreSpace>("water of a material")
          .quantity("porosity", &PoreSpace::porosity, unit::none, within(0, 1),
                    "Volume of pores per volume, at the start.")
          .custom({.name = "permeability",
                   .type = field_type::quantity,
                   .unit = "m/s",
                   .range = "above 0",
                   .sentence = "Hydraulic conductivity: one number, or one for each axis.",
                   .required = true,
                   .alternatives = {{.type = field_type::quantities, .unit = "m/s"}}},
                  read_permeability,
                  [](const PoreSpace& p) {
                    return p.permeability.size() == 1 ? value::from_quantity(p.permeability[0], unit::velocity)
                                                      : value::from_quantities(p.permeability, unit::velocity);
                  })
          .choice("permeability_law", &PoreSpace::kozeny_carman, {{"kozeny_carman", true}, {"constant", false}},
                  "Whether the permeability follows the porosity: k n^3 / (1 - n)^2 (Kozeny, Carman).", true);
  return declared;
}

void check_faces(const Case& definition, Problems& problems) {
  const auto allowed = face_words(definition.dimension());
  const Node* const faces = definition.water.find("faces");
  const bool given = faces != nullptr && faces->kind == Node::Kind::map;
  for (const auto& [name, place] : given ? faces->keys : std::vector<std::pair<std::string, Place>>{}) {
    const auto found = definition.faces.find(name);
    if (std::find(allowed.begin(), allowed.end(), name) == allowed.end())
      problems.add(place, fmt::format("unknown face '{}' in water.faces; {}", name, allowed_words(name, allowed)));
    else if (found != definition.faces.end() && found->second.periodic)
      problems.add(place, fmt::format("water.faces.{0}: the face is periodic in `boundaries`, for the water too; leave "
                                      "out water.faces.{0}",
                                      name));
  }
  if (const auto top = definition.faces.find("top"); top != definition.faces.end() && top->second.periodic)
    problems.add(
        definition.source.find("boundaries")->find("top")->place,
        "boundaries.top: periodic: the physics two_phase does not know it, for water needs a top and a bottom; "
        "take `physics: total_stress`, or make other faces periodic");
}

}  // namespace

double WaterCase::compressibility() const {
  if (!bulk_modulus) return 0;
  return saturation / *bulk_modulus + (1 - saturation) / atmospheric_pressure;
}

double WaterCase::table_level(double x) const {
  const auto after = std::find_if(table.begin(), table.end(), [x](const auto& point) { return point[0] > x; });
  if (after == table.begin()) return table.front()[1];
  if (after == table.end()) return table.back()[1];
  const auto& a = *(after - 1);
  const auto& b = *after;
  return a[1] + (b[1] - a[1]) * (x - a[0]) / (b[0] - a[0]);
}

WaterCase read_water(const Case& definition) {
  Problems problems;
  WaterCase water = schema().read(definition.water, {}, problems);
  check_faces(definition, problems);
  problems.throw_if_any();
  if (!water.ponds.empty())
    check_regions(water.ponds, *definition.water.find("ponds"), definition.dimension(), problems);
  problems.throw_if_any();
  const auto fail = [&](const std::string& key, const std::string& message) {
    const Node* const node = definition.water.find(key);
    throw CaseError(node != nullptr ? node->place : definition.source.place, message);
  };
  if (water.saturation < 1 && !water.bulk_modulus)
    fail("saturation", "water.saturation below 1 needs a bulk_modulus, for example 2.2 GPa");
  if (water.formulation == Formulation::explicit_ && !water.bulk_modulus)
    fail("formulation", "water: `formulation: explicit` needs a bulk_modulus, for example 2.2 GPa");
  if (water.formulation == Formulation::explicit_ && water.increment != 1)
    fail("increment", "water: `formulation: explicit` has no increments of the pressure; leave out increment");
  if (water.formulation == Formulation::explicit_ && !water.ponds.empty())
    fail("ponds", "water: `formulation: explicit` knows no ponds");
  for (const auto& [name, face] : water.faces) {
    const bool drained = face.pressure && face.pressure->value == std::vector<double>{0};
    if (water.formulation == Formulation::explicit_ && !drained && (face.pressure || face.head || face.flux))
      fail("faces",
           fmt::format("water.faces.{}: `formulation: explicit` knows drained and impermeable faces only", name));
  }
  if (water.initial.method == InitialPressure::Method::hydrostatic && !water.initial.level && water.table.empty())
    fail("initial", "water.initial: `method: hydrostatic` needs a level, or a water table");
  const bool weighs = definition.gravity.back() != 0;
  if (!weighs && (!water.ponds.empty() || water.initial.method == InitialPressure::Method::hydrostatic))
    fail("ponds", "water: ponds and hydrostatic pressure need gravity along the last axis");
  return water;
}

Node resolved(const WaterCase& water) { return schema().write(water); }
std::vector<FieldDoc> water_docs() {
  return {{.name = "water",
           .type = field_type::section,
           .default_text = "the defaults of its keys",
           .sentence = "Top-level section of the case: water in the pores and beside the soil.",
           .nested = schema().docs()},
          {.name = "materials.NAME.water",
           .type = field_type::section,
           .default_text = "the material is dry",
           .sentence = "The pores of a material that is saturated; its `density` is that of the dry soil.",
           .nested = pore_schema().docs()},
          surface_loads_doc()};
}

std::vector<PoreSpace> read_pore_spaces(const Case& definition, const WaterCase& water,
                                        const std::vector<bool>& liquid) {
  std::vector<PoreSpace> all;
  for (const auto& [name, section] : definition.materials) {
    PoreSpace pores;
    if (const Node* const node = section.find("water")) {
      if (liquid[all.size()]) throw CaseError(node->place, fmt::format("material '{}': water has no pores", name));
      pores = pore_schema().read(*node);
      pores.saturated = true;
      const auto dimension = static_cast<std::size_t>(definition.dimension());
      if (pores.permeability.size() == 1) pores.permeability.assign(dimension, pores.permeability[0]);
      if (pores.permeability.size() != dimension)
        throw CaseError(node->find("permeability")->place,
                        fmt::format("permeability: found {} components; the grid has {} dimensions",
                                    pores.permeability.size(), dimension));
      if (water.formulation == Formulation::u_p && std::ranges::max(pores.permeability) > coarsest_u_p)
        throw CaseError(node->find("permeability")->place,
                        fmt::format("permeability is {:g} m/s; water in soil coarser than {:g} m/s does not follow the "
                                    "acceleration of the grains: take `water: {{formulation: v-w-p}}`",
                                    std::ranges::max(pores.permeability), coarsest_u_p));
    } else if (liquid[all.size()]) {
      pores.porosity = 1;
      pores.saturated = pores.liquid = true;
    }
    all.push_back(pores);
  }
  return all;
}

Node resolved(const PoreSpace& pores) { return pore_schema().write(pores); }

Case without_pores(Case definition) {
  for (auto& [name, section] : definition.materials) section.erase("water");
  return definition;
}

}  // namespace sluice
