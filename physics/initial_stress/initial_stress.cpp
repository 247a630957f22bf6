#include "physics/initial_stress/initial_stress.h"

#include <fmt/format.h>

namespace sluice {

namespace {

using Method = InitialStress::Method;
using By = InitialStress::By;

// ---- surface and k0: more than one way of writing them ----

void read_surface(InitialStress& initial, const Node& node, Problems& problems) {
  if (node.kind == Node::Kind::scalar) {
    if (nearest_word(node.scalar, {"top"}) == "top") {
      value::word(node, "surface", {"top"}, problems);
    } else if (const auto level = value::quantity(node, "surface", unit::length, any_number, problems)) {
      initial.surface = {{0, *level}};
    }
    return;
  }
  if (node.kind != Node::Kind::list || node.items.empty()) {
    problems.add(node.place,
                 fmt::format("surface: found {}; expected a level, points [[x, z], …], or `top`", description(node)));
    return;
  }
  for (const Node& item : node.items) {
    const auto point = value::quantities(item, "point of the surface", unit::length, any_number, {{2}}, problems);
    if (!point) return;
    if (!initial.surface.empty() && (*point)[0] <= initial.surface.back()[0]) {
      problems.add(item.place, fmt::format("surface: x = {:g} m must be greater than that of the point before, {:g} m",
                                           (*point)[0], initial.surface.back()[0]));
      return;
    }
    initial.surface.push_back({(*point)[0], (*point)[1]});
  }
}

Node write_surface(const InitialStress& initial) {
  if (initial.method != Method::k0) return {};
  if (initial.surface.empty()) return Node::text("top");
  if (initial.surface.size() == 1) return value::from_quantity(initial.surface[0][1], unit::length);
  Node points = Node::list();
  for (const auto& [x, z] : initial.surface) points.items.push_back(value::from_quantities({x, z}, unit::length));
  return points;
}

void read_k0(InitialStress& initial, const Node& node, Problems& problems) {
  if (node.kind != Node::Kind::map) {
    initial.k0 = value::quantity(node, "k0", unit::none, at_least(0), problems);
    return;
  }
  for (std::size_t i = 0; i < node.items.size(); ++i) {
    const auto& [name, place] = node.keys[i];
    if (const auto k0 = value::quantity(node.items[i], "k0." + name, unit::none, at_least(0), problems)) {
      initial.k0_of[name] = *k0;
      initial.k0_places[name] = place;
    }
  }
}

Node write_k0(const InitialStress& initial) {
  if (initial.k0) return value::from_quantity(*initial.k0, unit::none);
  if (initial.k0_of.empty()) return {};
  Node names = Node::map();
  for (const auto& [name, k0] : initial.k0_of) names.set(name, value::from_quantity(k0, unit::none));
  return names;
}

/// Keys of `from_file` are written with it alone.
template <class Write>
auto with_file(const Write& write) {
  return [=](const InitialStress& initial) { return initial.method == Method::from_file ? write(initial) : Node{}; };
}

const std::vector<std::pair<std::string, By>> ways{
    {"auto", By::automatic}, {"particles", By::particles}, {"cells", By::cells}};

void add_file_keys(Schema<InitialStress>& schema) {
  schema
      .custom(
          {.name = "file",
           .type = field_type::text,
           .default_text = "none",
           .sentence =
               "For `from_file`: `results.h5` of the earlier run; its path begins at the folder of the case file."},
          [](InitialStress& initial, const Node& node, Problems& problems) {
            initial.file = value::text(node, "file", problems).value_or("");
          },
          with_file([](const InitialStress& initial) { return Node::text(initial.file); }))
      .quantity("time", &InitialStress::time, unit::time, at_least(0),
                "For `from_file`: the output time whose stress is taken.", Absent{"the last"});
  std::vector<std::string> words;
  for (const auto& [word, by] : ways) words.push_back(word);
  schema
      .custom(
          {.name = "by",
           .type = field_type::word,
           .default_text = "auto",
           .sentence = "For `from_file`: `particles` gives each particle the stress of the one with its identity, "
                       "`cells` a linear fit over the particles of its material in and around its cell; `auto` takes "
                       "the former where the particles are the same.",
           .words = words},
          [words](InitialStress& initial, const Node& node, Problems& problems) {
            const auto found = value::word(node, "by", words, problems);
            for (const auto& [word, by] : ways)
              if (found && word == *found) initial.by = by;
          },
          with_file([](const InitialStress& initial) {
            for (const auto& [word, by] : ways)
              if (by == initial.by) return Node::text(word);
            return Node{};
          }))
      .custom(
          {.name = "state",
           .type = field_type::boolean,
           .default_text = "true",
           .sentence = "For `from_file`: takes the state variables of the materials (plastic strain and the like), "
                       "too."},
          [](InitialStress& initial, const Node& node, Problems& problems) {
            initial.state = value::boolean(node, "state", problems).value_or(true);
          },
          with_file([](const InitialStress& initial) { return Node::text(initial.state ? "true" : "false"); }));
}

Schema<InitialStress> make_schema() {
  auto schema = Schema<InitialStress>("initial_stress");
  schema
      .choice(
          "method", &InitialStress::method,
          {{"none", Method::none},
           {"uniform", Method::uniform},
           {"elastic_equilibrium", Method::elastic_equilibrium},
           {"equilibrium", Method::equilibrium},
           {"k0", Method::k0},
           {"from_file", Method::from_file}},
          "How the stress before the first step is found: none; the same everywhere; linear-elastic equilibrium "
          "under gravity, stresses kept and displacements dropped; the same with the strength of the materials; the "
          "weight of what lies above, and K0 times it sideways; or that of an earlier run.",
          Method::none)
      .quantities("stress", &InitialStress::stress, unit::stress, any_number, {{4, 6}},
                  "For `uniform`: xx yy zz xy in 2-D, xx yy zz xy yz xz in 3-D, tension positive.", Absent{"none"})
      .integer("increments", &InitialStress::increments, from_to(1, 1000),
               "For `equilibrium`: parts in which weight and loads are applied, one after the other.", 1)
      .quantity("tolerance", &InitialStress::tolerance, unit::none, above_to(0, 0.1),
                "For `equilibrium`: the largest force out of balance on a node, as a share of the largest force of "
                "weight and loads on a node.",
                InitialStress{}.tolerance)
      .custom(
          {.name = "surface",
           .type = field_type::quantity,
           .unit = "m",
           .default_text = "top",
           .sentence = "For `k0`: where the ground begins: a level; points [[x, z], …] with ascending x (the same "
                       "along the middle axis); or `top`, "
                       "where the bodies end.",
           .alternatives = {{.type = field_type::points, .unit = "m"}, {.type = field_type::word, .words = {"top"}}}},
          read_surface, write_surface)
      .custom({.name = "k0",
               .type = field_type::quantity,
               .range = "at least 0",
               .default_text = "1 - sin(friction_angle)",
               .sentence = "For `k0`: horizontal over vertical effective stress: a number, or numbers by name of the "
                           "material, {clay: 0.6}; where there is none, from the material's `friction_angle`.",
               .alternatives = {{.type = field_type::named_sections}}},
              read_k0, write_k0);
  add_file_keys(schema);
  return schema;
}

const Schema<InitialStress>& schema() {
  static const auto declared = make_schema();
  return declared;
}

/// Keys that belong to one method.
const std::vector<std::pair<std::string, std::string>> owners{
    {"stress", "uniform"}, {"increments", "equilibrium"}, {"tolerance", "equilibrium"}, {"surface", "k0"},
    {"k0", "k0"},          {"file", "from_file"},         {"time", "from_file"},        {"by", "from_file"},
    {"state", "from_file"}};

}  // namespace

InitialStress read_initial_stress(const Node& section) {
  const InitialStress initial = schema().read(section);
  if (initial.method == Method::uniform && initial.stress.empty())
    throw CaseError(section.place, "initial_stress: `method: uniform` needs `stress: [xx, yy, zz, xy]`");
  if (initial.method == Method::from_file && initial.file.empty())
    throw CaseError(section.place, "initial_stress: `method: from_file` needs `file: RESULTS/results.h5`");
  const Node* const method = section.find("method");
  for (const auto& [key, owner] : owners)
    if (const Node* const found = section.find(key); found != nullptr && (!method || method->scalar != owner))
      throw CaseError(key == "stress" ? section.place : found->place,
                      fmt::format("initial_stress: `{}` is for `method: {}` only", key, owner));
  return initial;
}

Node resolved(const InitialStress& initial_stress) { return schema().write(initial_stress); }

FieldDoc initial_stress_doc() {
  return {.name = "initial_stress",
          .type = field_type::section,
          .default_text = "no stress",
          .sentence = "Top-level section of the case: stress in the ground before anything moves.",
          .nested = schema().docs()};
}

template <int Dim>
void apply_initial_stress(InitialStress& initial_stress, Scene<Dim>& scene, const StressUpdate<Dim>& stress,
                          const SkeletonLoads<Dim>& loads) {
  const Materials<Dim>& materials = stress.materials();
  switch (initial_stress.method) {
    case Method::none:
      return;
    case Method::elastic_equilibrium:
      elastic_equilibrium(scene, materials, loads);
      return;
    case Method::equilibrium:
      equilibrium(initial_stress, scene, stress, loads);
      return;
    case Method::k0:
      k0_stress(initial_stress, scene, materials, loads);
      return;
    case Method::from_file:
      stress_from_file(initial_stress, scene, materials);
      return;
    case Method::uniform:
      break;
  }
  if (initial_stress.stress.size() != symmetric_components<Dim>)
    throw CaseError("initial_stress.stress: expected " + std::to_string(symmetric_components<Dim>) + " components in " +
                    std::to_string(Dim) + "-D");
  for (int c = 0; c < symmetric_components<Dim>; ++c)
    for (double& value : scene.particles.columns.values(scene.particles.stress, c))
      value = initial_stress.stress[static_cast<std::size_t>(c)];
}

template void apply_initial_stress<2>(InitialStress&, Scene<2>&, const StressUpdate<2>&, const SkeletonLoads<2>&);
template void apply_initial_stress<3>(InitialStress&, Scene<3>&, const StressUpdate<3>&, const SkeletonLoads<3>&);

}  // namespace sluice
