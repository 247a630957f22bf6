#include "core/chart/study.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>

#include "core/case/case_tree.h"
#include "core/chart/error_measure.h"

namespace sluice::chart {

namespace {

/// A value as `--set` would give it: scalars as they are, lists and maps in YAML's flow style.
std::string flow_text(const Node& node) {
  if (node.kind == Node::Kind::scalar) return node.quoted ? fmt::format("\"{}\"", node.scalar) : node.scalar;
  std::vector<std::string> parts;
  for (std::size_t i = 0; i < node.items.size(); ++i)
    parts.push_back((node.kind == Node::Kind::map ? node.keys[i].first + ": " : "") + flow_text(node.items[i]));
  const std::string all = fmt::format("{}", fmt::join(parts, ", "));
  return node.kind == Node::Kind::map ? "{" + all + "}" : "[" + all + "]";
}

/// Keys of the case with their values: {scheme.shape: linear, grid.cell: 1 m}.
std::vector<Override> settings_of(const Node& node, const std::string& name, Problems& problems) {
  std::vector<Override> settings;
  if (node.kind != Node::Kind::map) {
    problems.add(node.place, fmt::format("{}: found {}; expected keys of the case with their values, for example "
                                         "{{scheme.courant: 0.25}}",
                                         name, description(node)));
    return settings;
  }
  for (std::size_t i = 0; i < node.items.size(); ++i)
    settings.push_back({node.keys[i].first, flow_text(node.items[i])});
  return settings;
}

/// {key: scheme.shape, values: [linear, ugimp]}: one key, labelled by its values.
void read_values(Axis& axis, const Node& node, Problems& problems) {
  const Node *const key = node.find("key"), *const values = node.find("values");
  if (key == nullptr || values == nullptr || key->kind != Node::Kind::scalar || values->kind != Node::Kind::list) {
    problems.add(node.place, fmt::format("axis '{}': expected {{key: KEY, values: [...]}}, or choices by name, NAME: "
                                         "{{KEY: VALUE, ...}}",
                                         axis.name));
    return;
  }
  for (const Node& value : values->items) {
    const std::string text = flow_text(value);
    axis.choices.push_back({value.kind == Node::Kind::scalar ? value.scalar : text, {{key->scalar, text}}});
  }
}

Axis read_axis(const std::string& name, const Node& node, Problems& problems) {
  Axis axis{name, {}, node.place};
  if (node.kind != Node::Kind::map) {
    problems.add(node.place, fmt::format("axis '{}': found {}; expected {{key: KEY, values: [...]}} or choices by name",
                                         name, description(node)));
    return axis;
  }
  if (node.find("key") != nullptr || node.find("values") != nullptr)
    read_values(axis, node, problems);
  else
    for (std::size_t i = 0; i < node.items.size(); ++i)
      axis.choices.push_back({node.keys[i].first, settings_of(node.items[i], node.keys[i].first, problems)});
  if (axis.choices.empty()) problems.add(node.place, fmt::format("axis '{}' has no choices", name));
  return axis;
}

void read_axes(Study& study, const Node& node, Problems& problems) {
  if (node.kind != Node::Kind::map || node.items.empty()) {
    problems.add(node.place, fmt::format("axes: found {}; expected axes by name", description(node)));
    return;
  }
  for (std::size_t i = 0; i < node.items.size(); ++i)
    study.axes.push_back(read_axis(node.keys[i].first, node.items[i], problems));
}

std::vector<std::string> names_of(const std::vector<Axis>& axes) {
  std::vector<std::string> names;
  for (const Axis& axis : axes) names.push_back(axis.name);
  return names;
}

std::vector<std::string> labels_of(const Axis& axis) {
  std::vector<std::string> labels;
  for (const Choice& choice : axis.choices) labels.push_back(choice.label);
  return labels;
}

const Axis* find_axis(const Study& study, const std::string& name, const Place& place, Problems& problems) {
  const auto found = std::ranges::find(study.axes, name, &Axis::name);
  if (found != study.axes.end()) return &*found;
  problems.add(place, fmt::format("there is no axis '{}'; {}", name, allowed_words(name, names_of(study.axes))));
  return nullptr;
}

/// The labels that one entry of `leave_out` has for an axis: a word or a list of words.
std::vector<std::string> words_of(const Node& node) {
  if (node.kind != Node::Kind::list) return {node.scalar};
  std::vector<std::string> words;
  for (const Node& item : node.items) words.push_back(item.scalar);
  return words;
}

void check_leave_out(const Study& study, Problems& problems) {
  for (const Node& combination : study.leave_out)
    for (std::size_t i = 0; i < combination.items.size(); ++i) {
      const auto& [name, place] = combination.keys[i];
      const Axis* const axis = find_axis(study, name, place, problems);
      if (axis == nullptr) continue;
      const auto labels = labels_of(*axis);
      for (const std::string& word : words_of(combination.items[i]))
        if (std::ranges::find(labels, word) == labels.end())
          problems.add(combination.items[i].place,
                       fmt::format("axis '{}' has no choice '{}'; {}", name, word, allowed_words(word, labels)));
    }
}

bool left_out(const Study& study, const Variant& variant) {
  return std::ranges::any_of(study.leave_out, [&](const Node& combination) {
    for (std::size_t a = 0; a < study.axes.size(); ++a) {
      const Node* const words = combination.find(study.axes[a].name);
      if (words == nullptr) continue;
      const auto allowed = words_of(*words);
      if (std::ranges::find(allowed, variant.labels[a]) == allowed.end()) return false;
    }
    return true;
  });
}

void read_bound(Bound& bound, const Node& node, Problems& problems) {
  for (const Node& point : node.items) {
    const auto pair = value::quantities(point, "points", unit::none, any_number, {{2}}, problems);
    if (pair) bound.points.push_back({(*pair)[0], (*pair)[1]});
  }
}

const Schema<Drawing>& drawing_schema() {
  static const auto schema =
      Schema<Drawing>("draw")
          .word("kind", &Drawing::kind, {"curves", "map"},
                "Error against cost in curves; or the error in colours over the last two axes.", "curves")
          .text("error_label", &Drawing::error_label, "What the error is, for the figure.", "relative error")
          .sections(
              "bounds", &Drawing::bounds,
              Schema<Bound>("bound")
                  .text("name", &Bound::name, "For the legend.")
                  .custom({.name = "points",
                           .type = field_type::points,
                           .sentence = "Along the last axis and the one before it; an axis of words counts 1, 2, 3.",
                           .required = true},
                          read_bound,
                          [](const Bound& bound) {
                            Node list = Node::list();
                            for (const auto& p : bound.points)
                              list.items.push_back(value::from_quantities({p[0], p[1]}, unit::none));
                            return list;
                          }),
              "Curves over a map: what theory predicts.", false);
  return schema;
}

Schema<Study> make_schema() {
  return Schema<Study>("the study")
      .custom(
          {.name = "schema",
           .type = field_type::integer,
           .range = "1",
           .sentence = "Version of the format.",
           .required = true},
          [](Study&, const Node& node, Problems& problems) { check_schema_version(node, problems); },
          [](const Study&) { return Node::text("1"); })
      .text("title", &Study::title, "What the study is, in a line.")
      .text("case", &Study::case_file, "The case that is varied; a path from the folder of the study.")
      .custom(
          {.name = "set",
           .type = field_type::section,
           .default_text = "nothing",
           .sentence = "Keys of the case and their values, for all runs of the study."},
          [](Study& study, const Node& node, Problems& problems) {
            study.settings = settings_of(node, "set", problems);
          },
          [](const Study&) { return Node{}; })
      .custom(
          {.name = "axes",
           .type = field_type::named_sections,
           .sentence = "What is varied. An axis is a key of the case with its values, `{key: grid.cell, values: [1 m, "
                       "0.5 m]}`, or choices by name that set several keys. The first axis is the colour of the "
                       "figure, then come marker and line.",
           .required = true},
          read_axes, [](const Study&) { return Node{}; })
      .text("along", &Study::along, "The axis whose choices are the points of one curve, coarse to fine.",
            "the last axis")
      .custom(
          {.name = "leave_out",
           .type = field_type::sections,
           .default_text = "none",
           .sentence = "Combinations that are not run: labels by axis, `{shape: cpdi, transfer: [tpic, xpic]}`."},
          [](Study& study, const Node& node, Problems& problems) {
            for (const Node& item : node.items)
              if (item.kind == Node::Kind::map)
                study.leave_out.push_back(item);
              else
                problems.add(item.place,
                             fmt::format("leave_out: found {}; expected labels by axis", description(item)));
          },
          [](const Study&) { return Node{}; })
      .custom(
          {.name = "reference",
           .type = field_type::section,
           .default_text = "none",
           .sentence = "Keys and values of a run that others are compared with, for `measure: reference`."},
          [](Study& study, const Node& node, Problems& problems) {
            study.reference = settings_of(node, "reference", problems);
          },
          [](const Study&) { return Node{}; })
      .kept({.name = "error",
             .type = field_type::section,
             .sentence = "The error: `measure` and its keys, listed under *error measures*.",
             .required = true},
            &Study::error)
      .integer("repetitions", &Study::repetitions, from_to(1, 99),
               "Runs of each variant, in turns with the others; the cost is their median.", 3)
      .quantity("repeat_up_to", &Study::repeat_up_to, unit::time, at_least(0),
                "CPU time above which a run is not repeated: long runs are steadier.", 10.0)
      .section("limits", &Study::limits,
               Schema<Limits>("limits")
                   .quantity("cpu", &Limits::cpu, unit::time, above(0), "CPU time after which a run is stopped.", 600.0)
                   .quantity("error", &Limits::error, unit::none, above(0), "A larger error is a failure.", {"none"}),
               "What makes a run fail.")
      .section("draw", &Study::draw, drawing_schema(), "The figure.");
}

const Schema<Study>& schema() {
  static const Schema<Study> declared = make_schema();
  return declared;
}

Study study_of(Node tree, const std::string& file) {
  Problems problems;
  const Node source = extended(std::move(tree), file);
  Study study = schema().read(source, {"extends"}, problems);
  problems.throw_if_any();
  study.file = file;
  if (study.along == "the last axis") study.along = study.axes.back().name;
  const Node* const along = source.find("along");
  find_axis(study, study.along, along != nullptr ? along->place : source.place, problems);
  check_leave_out(study, problems);
  if (study.draw.kind == "map" && study.axes.size() < 2)
    problems.add(source.find("draw")->place, "draw: a map needs two axes");
  study.case_file = (std::filesystem::path(file).parent_path() / study.case_file).lexically_normal().string();
  if (!std::filesystem::is_regular_file(study.case_file))
    problems.add(source.find("case")->place, fmt::format("case: there is no file '{}'", study.case_file));
  try {
    make_error_measure(study);
  } catch (const CaseError& error) {
    problems.add(study.error.place, error);
  }
  problems.throw_if_any();
  return study;
}

}  // namespace

std::string Variant::name() const { return fmt::format("{}", fmt::join(labels, ", ")); }

Study load_study(const std::string& file) { return study_of(read_yaml_file(file), file); }
Study parse_study(const std::string& text, const std::string& name) {
  return study_of(read_yaml_text(text, name), name);
}

std::vector<FieldDoc> study_docs() { return schema().docs(); }

std::vector<Variant> variants_of(const Study& study) {
  std::vector<Variant> all = {{{}, study.settings}};
  for (const Axis& axis : study.axes) {
    std::vector<Variant> longer;
    for (const Variant& variant : all)
      for (const Choice& choice : axis.choices) {
        Variant next = variant;
        next.labels.push_back(choice.label);
        next.settings.insert(next.settings.end(), choice.settings.begin(), choice.settings.end());
        longer.push_back(std::move(next));
      }
    all = std::move(longer);
  }
  std::erase_if(all, [&](const Variant& variant) { return left_out(study, variant); });
  return all;
}

}  // namespace sluice::chart
