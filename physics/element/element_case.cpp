#include "physics/element/element_case.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "core/case/case_tree.h"
#include "physics/element/path.h"

namespace sluice::element {

namespace {

const Components six{{6}};

/// The file, key by key; the path is read apart, since it is either a section or a list.
struct Keys {
  std::string title;
  std::vector<double> initial_stress;
  std::optional<double> initial_pressure, initial_void_ratio, strain_increment;
  std::optional<int> increments;
  double cell_size = 1;
  ReferenceKeys reference;
  OutputKeys output;
  Node material, path;
};

/// One stage of a list, as it is written.
struct StageKeys {
  double duration = 0;
  Node strain_rate, stress;
  bool undrained = false;
  std::optional<int> increments;
  Place place;
};

template <class T>
void optional_integer(Schema<T>& schema, const std::string& key, std::optional<int> T::*member,
                      const std::string& absent, const std::string& sentence) {
  schema.custom(
      {.name = key,
       .type = field_type::integer,
       .range = from_to(1, 1e6).text(unit::none),
       .default_text = absent,
       .sentence = sentence},
      [=](T& object, const Node& node, Problems& problems) {
        if (const auto n = value::integer(node, key, from_to(1, 1e6), problems)) object.*member = static_cast<int>(*n);
      },
      [=](const T& object) { return object.*member ? Node::text(std::to_string(*(object.*member))) : Node{}; });
}

std::vector<std::string> type_words() {
  std::vector<std::string> words;
  for (const PathType& type : path_types()) words.push_back(type.name);
  return words;
}

const Schema<PathKeys>& path_schema() {
  static const Schema<PathKeys> schema = [] {
    using P = PathKeys;
    auto declared =
        Schema<P>("path")
            .word("type", &P::type, type_words(), "Which test.")
            .quantity("strain", &P::strain, unit::none, above(0),
                      "Size of the strain at the end: axial; volumetric in isotropic; gamma_xz in direct_simple_shear. "
                      "With cycles their amplitude.",
                      {"from stress"})
            .quantity("stress", &P::stress, unit::stress, above(0),
                      "Size of the change of stress at the end instead: axial; mean in isotropic; xz in "
                      "direct_simple_shear. With cycles their amplitude.",
                      {"from strain"})
            .quantities("components", &P::components, unit::none, any_number, six,
                        "Of pure_strain: xx yy zz xy yz xz at the end, or the amplitude.", Absent{"none"})
            .quantity("duration", &P::duration, unit::time, above(0),
                      "Time until the end, or until the first peak of cycles.", 100.0)
            .boolean("undrained", &P::undrained,
                     "Constant volume: the stresses of the path are total ones, and an excess pore pressure arises.",
                     false);
    optional_integer(declared, "cycles", &P::cycles, "none: up to the end once",
                     "Cycles: two-way from + to - the amplitude; one-way, back to 0, in isotropic and oedometer.");
    return declared;
  }();
  return schema;
}

const Schema<StageKeys>& stage_schema() {
  static const Schema<StageKeys> schema = [] {
    using S = StageKeys;
    auto declared = Schema<S>("stage").quantity("duration", &S::duration, unit::time, above(0), "Its length.");
    declared.kept({.name = "strain_rate",
                   .type = field_type::section,
                   .unit = "1/s",
                   .default_text = "0 in all components that `stress` leaves",
                   .sentence = "Strain rates by component, for example {zz: -0.1 %/s}."},
                  &S::strain_rate);
    declared.kept({.name = "stress",
                   .type = field_type::section,
                   .unit = "Pa",
                   .default_text = "no stress is given",
                   .sentence = "Stress by component: the value at the end, reached along a straight line, or `hold`."},
                  &S::stress);
    declared.boolean("undrained", &S::undrained, "Constant volume; stresses are then total ones.", false);
    optional_integer(declared, "increments", &S::increments, "as in the file",
                     "Increments of this stage, whatever the file says of all.");
    return declared;
  }();
  return schema;
}

void read_material(Keys& keys, const Node& node, Problems& problems) {
  keys.material = node;
  if (node.kind != Node::Kind::map) {
    problems.add(node.place, fmt::format("material: found {}; expected a section with a model", description(node)));
    return;
  }
  try {
    make_material(node);
  } catch (const CaseError& error) {
    problems.add(node.place, error);
  }
}

Schema<Keys> make_schema() {
  auto schema = Schema<Keys>("the element file")
                    .custom(
                        {.name = "schema",
                         .type = field_type::integer,
                         .range = "1",
                         .sentence = "Version of the format.",
                         .required = true},
                        [](Keys&, const Node& node, Problems& problems) { check_schema_version(node, problems); },
                        [](const Keys&) { return Node::text("1"); })
                    .text("title", &Keys::title, "What the test is, in a line.", "untitled")
                    .custom({.name = "material",
                             .type = field_type::section,
                             .sentence = "The material, as in a case: `model` and its keys.",
                             .required = true},
                            read_material, [](const Keys& keys) { return keys.material; })
                    .quantities("initial_stress", &Keys::initial_stress, unit::stress, any_number, six,
                                "xx yy zz xy yz xz, tension positive.", Absent{"none"})
                    .quantity("initial_pressure", &Keys::initial_pressure, unit::stress, any_number,
                              "Isotropic initial stress instead, compression positive.", {"none"})
                    .quantity("initial_void_ratio", &Keys::initial_void_ratio, unit::none, above(0),
                              "Void ratio at the start, for the output.", {"that of the material, if it has one"})
                    .quantity("cell_size", &Keys::cell_size, unit::length, above(0),
                              "Size of the cells, for softening with a `reference_width`.", 1.0);
  schema.kept({.name = "path",
               .type = field_type::section,
               .sentence = "A test by name, or a list of stages.",
               .required = true,
               .nested = path_schema().docs(),
               .alternatives = {{.type = field_type::sections, .nested = stage_schema().docs()}}},
              &Keys::path);
  optional_integer(schema, "increments", &Keys::increments, "200",
                   "Increments of each stage; from 0 to the end or the first peak in a path by name.");
  schema
      .quantity("strain_increment", &Keys::strain_increment, unit::none, above(0),
                "Largest increment of the strain that is given, instead of `increments`.", {"from increments"})
      .section("reference", &Keys::reference,
               Schema<ReferenceKeys>("reference")
                   .boolean("compute", &ReferenceKeys::compute, "Integrate the reference, too.", true)
                   .quantity("tolerance", &ReferenceKeys::tolerance, unit::none, from_to(1e-9, 1e-2),
                             "Relative tolerance of its error control.", 1e-6),
               "The reference with controlled error.")
      .section("output", &Keys::output,
               Schema<OutputKeys>("output").integer("every", &OutputKeys::every, from_to(1, 1e6),
                                                    "Increments between rows of the tables.", 1),
               "What is written.");
  return schema;
}

const Schema<Keys>& schema() {
  static const Schema<Keys> declared = make_schema();
  return declared;
}

/// Calls `read(component, value)` for each entry of a map of components.
template <class Read>
void for_each_component(const Node& map, const std::string& key, Problems& problems, const Read& read) {
  if (!map) return;
  if (map.kind != Node::Kind::map) {
    problems.add(map.place, fmt::format("{}: found {}; expected values by component, for example {{zz: …}}", key,
                                        description(map)));
    return;
  }
  const auto& names = component_names();
  for (std::size_t i = 0; i < map.items.size(); ++i) {
    const auto& [name, place] = map.keys[i];
    const auto found = std::ranges::find(names, name);
    if (found == names.end())
      problems.add(place, fmt::format("{}: unknown component '{}'; {}", key, name, allowed_words(name, names)));
    else
      read(static_cast<std::size_t>(found - names.begin()), map.items[i], place);
  }
}

void read_stress(Stage& stage, const Node& map, Problems& problems) {
  for_each_component(map, "stress", problems, [&](std::size_t k, const Node& node, const Place&) {
    stage.stress_given[k] = true;
    if (node.kind == Node::Kind::scalar && node.scalar == "hold") return;
    const std::string name = "stress." + component_names()[k];
    if (node.kind == Node::Kind::scalar && nearest_word(node.scalar, {"hold"}) == "hold")
      value::word(node, name, {"hold"}, problems);
    else
      stage.stress[k] = value::quantity(node, name, unit::stress, any_number, problems);
  });
}

Stage stage_of(const StageKeys& keys, std::size_t number, Problems& problems) {
  Stage stage;
  stage.name = fmt::format("stage_{}", number);
  stage.duration = keys.duration;
  stage.undrained = keys.undrained;
  read_stress(stage, keys.stress, problems);
  for_each_component(keys.strain_rate, "strain_rate", problems,
                     [&](std::size_t k, const Node& node, const Place& place) {
                       const std::string& name = component_names()[k];
                       if (stage.stress_given[k])
                         problems.add(place, fmt::format("{}: strain rate and stress are both given; leave out one of "
                                                         "them",
                                                         name));
                       const auto rate = value::quantity(node, "strain_rate." + name, unit::rate, any_number, problems);
                       stage.strain_rate[k] = rate.value_or(0);
                     });
  if (stage.undrained && !stage.stress_given[0] && !stage.stress_given[1] && !stage.stress_given[2])
    problems.add(keys.place,
                 "undrained: `stress` must give at least one of xx, yy, zz; its strain keeps the volume, and its total "
                 "stress gives the pore pressure");
  return stage;
}

/// How finely the stages are cut.
struct Fineness {
  int increments;
  double strain_increment;  ///< 0: the number decides
};

void check_increments(const Stage& stage, const Place& place, Problems& problems) {
  if (stage.increments < 1) problems.add(place, "strain_increment: no strain is given here; name `increments` instead");
  if (stage.increments > 1'000'000)
    problems.add(place, fmt::format("strain_increment: it takes {} increments; at most 1000000", stage.increments));
}

std::vector<Stage> read_stages(const Node& list, const Fineness& fineness, Problems& problems) {
  std::vector<Stage> stages;
  if (list.items.empty())
    problems.add(list.place, "path: found an empty list; expected stages, or a section with a `type`");
  for (const Node& item : list.items) {
    const StageKeys keys = stage_schema().read(item, {}, problems);
    Stage stage = stage_of(keys, stages.size() + 1, problems);
    stage.increments = fineness.increments;
    if (fineness.strain_increment > 0) stage.increments = increments_for(stage, fineness.strain_increment);
    if (keys.increments) stage.increments = *keys.increments;
    check_increments(stage, item.place, problems);
    stages.push_back(std::move(stage));
  }
  return stages;
}

std::vector<Stage> read_path(const Node& path, const Tensor& initial, const Fineness& fineness, Problems& problems) {
  if (!path) return {};  // reported
  if (path.kind == Node::Kind::list) return read_stages(path, fineness, problems);
  Problems own;
  const PathKeys keys = path_schema().read(path, {}, own);
  if (!own.empty()) {
    path_schema().read(path, {}, problems);
    return {};  // what is missing may be what could not be read
  }
  if (const std::string wrong = contradiction(keys); !wrong.empty()) {
    problems.add(path.place, "path: " + wrong);
    return {};
  }
  auto stages = stages_of(keys, initial, fineness.increments, fineness.strain_increment);
  check_increments(stages.front(), path.place, problems);
  return stages;
}

Node resolved_path(const Node& path) {
  if (path.kind == Node::Kind::map) return path_schema().resolve(path);
  Node list = Node::list();
  for (const Node& item : path.items) list.items.push_back(stage_schema().resolve(item));
  return list;
}

std::string resolved_text(const Keys& keys) {
  Node whole = schema().write(keys);
  const std::string model = keys.material.find("model")->scalar;
  for (const FieldDoc& doc : material_registry().entries().at(model).keys())
    if (doc.default_value && whole.find("material")->find(doc.name) == nullptr)
      whole.find("material")->set(doc.name, doc.default_value);
  whole.set("path", resolved_path(keys.path));
  if (!keys.increments && !keys.strain_increment) whole.set("increments", Node::text("200"));
  return yaml_text(whole);
}

ElementCase element_of(Node tree, const std::string& file, const std::vector<Override>& overrides) {
  Problems problems;
  Node source = extended(std::move(tree), file);
  apply_overrides(overrides, source, problems);
  const Keys keys = schema().read(source, {"extends"}, problems);
  ElementCase result;
  result.file = file;
  result.title = keys.title;
  result.material = keys.material;
  result.initial_void_ratio = keys.initial_void_ratio;
  result.cell_size = keys.cell_size;
  result.reference = keys.reference;
  result.output = keys.output;
  std::ranges::copy(keys.initial_stress, result.initial_stress.begin());
  if (keys.initial_pressure) {
    result.initial_stress_place = source.find("initial_pressure")->place;
    if (!keys.initial_stress.empty())
      problems.add(result.initial_stress_place, "initial_stress and initial_pressure are both given; leave out one");
    for (std::size_t k = 0; k < 3; ++k) result.initial_stress[k] = -*keys.initial_pressure;
  } else if (!keys.initial_stress.empty()) {
    result.initial_stress_place = source.find("initial_stress")->place;
  }
  if (keys.increments && keys.strain_increment)
    problems.add(source.find("strain_increment")->place,
                 "increments and strain_increment are both given; leave out one");
  result.stages = read_path(keys.path, result.initial_stress,
                            {keys.increments.value_or(200), keys.strain_increment.value_or(0)}, problems);
  problems.throw_if_any();
  const Node* const own = result.material.find("initial_void_ratio");
  if (own != nullptr && !result.initial_void_ratio) result.initial_void_ratio = parse_quantity(own->scalar).value;
  material_of(result);
  result.resolved = resolved_text(keys);
  return result;
}

}  // namespace

ElementCase load_element(const std::string& file, const std::vector<Override>& overrides) {
  return element_of(read_yaml_file(file), file, overrides);
}

ElementCase parse_element(const std::string& text, const std::string& name, const std::vector<Override>& overrides) {
  return element_of(read_yaml_text(text, name), name, overrides);
}

std::unique_ptr<Material> material_of(const ElementCase& definition) {
  auto material = make_material(definition.material);
  if (material->liquid())
    throw CaseError(
        definition.material.find("model")->place,
        fmt::format("model: {} has no stress of its own but viscous stress, for its pressure belongs to the "
                    "physics module; take another material",
                    definition.material.find("model")->scalar));
  material->set_cell_size(definition.cell_size);
  return material;
}

std::vector<FieldDoc> element_docs() { return schema().docs(); }

}  // namespace sluice::element
