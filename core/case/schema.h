/// Schema: what a section of a case file may contain, declared once.
///
/// Each key is declared with its name, type, unit, range, default and a sentence. Reading, checking, the resolved case,
/// the reference manual and the JSON schema for editors all come from that declaration:
///
///     const auto schema = Schema<Parameters>("material linear_elastic")
///         .quantity("density", &Parameters::density, unit::density, above(0), "Mass per volume.")           //
///         required .quantity("poisson_ratio", &Parameters::poisson_ratio, unit::none, within(-1, 0.5), "…", 0.3); //
///         default
///     const Parameters p = schema.read(node, {"model"});
///
/// A key without a default is required. A std::optional member is not, and stays empty where the key is absent.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/case/table.h"
#include "core/case/values.h"

namespace sluice {

/// One key of a section, as the manual shows it.
struct FieldDoc {
  std::string name = {};
  std::string type = {};          ///< one of field_type, or a description of the author's own
  std::string unit = {};          ///< SI unit; empty without one
  std::string range = {};         ///< what is allowed; empty if everything is
  std::string default_text = {};  ///< for people; empty if the key is required
  std::string sentence = {};
  bool required = false;
  Node default_value = Node();          ///< absent unless a value may be written that means the same as leaving it out
  std::vector<std::string> words = {};  ///< the words that are allowed, if they are few and fixed
  std::string catalogue = {};           ///< plural of the catalogue whose names are allowed
  std::vector<FieldDoc> nested = {};    ///< keys of a section, of each section of a list or map
  std::vector<FieldDoc> alternatives = {};  ///< other ways of writing it: only type, unit, words and nested count
};

namespace field_type {
inline constexpr const char* quantity = "number";
inline constexpr const char* quantities = "list of numbers";
inline constexpr const char* integer = "whole number";
inline constexpr const char* boolean = "true or false";
inline constexpr const char* text = "text";
inline constexpr const char* word = "word";
inline constexpr const char* words = "list of words";
inline constexpr const char* points = "list of points";
inline constexpr const char* section = "section";
inline constexpr const char* sections = "list of sections";
inline constexpr const char* named_sections = "sections by name";
}  // namespace field_type

/// How an absent key of an optional entry is shown in the manual: the default in words.
struct Absent {
  std::string text = "none";
};

/// The part of a schema that does not depend on the type it fills.
class AnySchema {
 public:
  const std::string& name() const { return name_; }
  std::vector<FieldDoc> docs() const;

  struct Field {
    FieldDoc doc;
    std::function<void(void* object, const Node& value, Problems& problems)> read;
    std::function<Node(const void* object)> write;                      ///< absent if there is nothing to write
    std::function<void(void* object, Problems& problems)> set_default;  ///< empty: the object's own value stands
  };

 protected:
  explicit AnySchema(std::string name) : name_(std::move(name)) {}
  void add(Field field) { fields_.push_back(std::move(field)); }
  void read_fields(void* object, const Node& section, const std::vector<std::string>& others, Problems& problems) const;
  Node write_fields(const void* object) const;

 private:
  std::string name_;
  std::vector<Field> fields_;
};

template <class T>
class Schema : public AnySchema {
 public:
  /// `name` is what messages call the section.
  explicit Schema(std::string name) : AnySchema(std::move(name)) {}

  // ---- reading and writing ----

  /// Keys in `others` are allowed, but left to somebody else. An absent section reads like an empty one. What is wrong
  /// goes to the problems; the member concerned keeps its initial value.
  T read(const Node& section, const std::vector<std::string>& others, Problems& problems) const {
    T object{};
    if constexpr (requires { object.place = section.place; }) object.place = section.place;
    read_fields(&object, section, others, problems);
    return object;
  }
  /// The same; throws one CaseError that holds all that is wrong.
  T read(const Node& section, const std::vector<std::string>& others = {}) const {
    Problems problems;
    T object = read(section, others, problems);
    problems.throw_if_any();
    return object;
  }
  /// The section that reads as `object`: all keys, values in SI with their units.
  Node write(const T& object) const { return write_fields(&object); }
  /// The section with all defaults filled in; keys in `others` come first, as they are. Throws CaseError.
  Node resolve(const Node& section, const std::vector<std::string>& others = {}) const {
    Node resolved = Node::map();
    for (const std::string& key : others)
      if (const Node* const value = section.find(key)) resolved.set(key, *value);
    const Node own = write(read(section, others));
    for (std::size_t i = 0; i < own.items.size(); ++i) resolved.set(own.keys[i].first, own.items[i]);
    return resolved;
  }

  // ---- single values ----

  Schema& quantity(const std::string& key, double T::*member, const Unit& unit, const Range& range,
                   const std::string& sentence, std::optional<double> default_value = std::nullopt) {
    return value_field<double>(
        number_doc(key, field_type::quantity, unit, range, sentence), member,
        [=](const Node& node, Problems& problems) { return value::quantity(node, key, unit, range, problems); },
        [=](double number) { return value::from_quantity(number, unit); }, default_value);
  }

  Schema& quantity(const std::string& key, std::optional<double> T::*member, const Unit& unit, const Range& range,
                   const std::string& sentence, const Absent& absent = {}) {
    return optional_field<double>(
        number_doc(key, field_type::quantity, unit, range, sentence), member,
        [=](const Node& node, Problems& problems) { return value::quantity(node, key, unit, range, problems); },
        [=](double number) { return value::from_quantity(number, unit); }, absent);
  }

  /// Each component in `range`.
  Schema& quantities(const std::string& key, std::vector<double> T::*member, const Unit& unit, const Range& range,
                     const Components& components, const std::string& sentence,
                     const std::optional<std::vector<double>>& default_value = std::nullopt) {
    return value_field<std::vector<double>>(
        quantities_doc(key, unit, range, components, sentence), member,
        [=](const Node& node, Problems& problems) {
          return value::quantities(node, key, unit, range, components, problems);
        },
        [=](const std::vector<double>& numbers) { return value::from_quantities(numbers, unit); }, default_value);
  }

  /// An absent list stays empty, which means what `absent` says.
  Schema& quantities(const std::string& key, std::vector<double> T::*member, const Unit& unit, const Range& range,
                     const Components& components, const std::string& sentence, const Absent& absent) {
    Field field;
    field.doc = quantities_doc(key, unit, range, components, sentence);
    field.doc.default_text = absent.text;
    field.read = [=](void* object, const Node& node, Problems& problems) {
      if (auto found = value::quantities(node, key, unit, range, components, problems))
        of(object).*member = std::move(*found);
    };
    field.write = [=](const void* object) {
      const auto& numbers = of(object).*member;
      return numbers.empty() ? Node{} : value::from_quantities(numbers, unit);
    };
    return with(std::move(field));
  }

  /// A quantity that may change in time.
  Schema& table(const std::string& key, Table T::*member, const Unit& unit, const Range& range,
                const std::string& sentence, const std::optional<Table>& default_value = std::nullopt) {
    return value_field<Table>(
        table_doc(key, unit, range, sentence), member,
        [=](const Node& node, Problems& problems) { return value::table(node, key, unit, range, problems); },
        [=](const Table& table) { return value::from_table(table, unit); }, default_value);
  }

  Schema& table(const std::string& key, std::optional<Table> T::*member, const Unit& unit, const Range& range,
                const std::string& sentence, const Absent& absent = {}) {
    return optional_field<Table>(
        table_doc(key, unit, range, sentence), member,
        [=](const Node& node, Problems& problems) { return value::table(node, key, unit, range, problems); },
        [=](const Table& table) { return value::from_table(table, unit); }, absent);
  }

  Schema& integer(const std::string& key, int T::*member, const Range& range, const std::string& sentence,
                  std::optional<int> default_value = std::nullopt) {
    return value_field<int>(
        number_doc(key, field_type::integer, unit::none, range, sentence), member,
        [=](const Node& node, Problems& problems) -> std::optional<int> {
          constexpr Range of_int = from_to(std::numeric_limits<int>::min(), std::numeric_limits<int>::max());
          const auto found = value::integer(node, key, range, problems);
          if (!found || of_int.contains(static_cast<double>(*found))) return found;
          problems.add(node.place, key + ": " + node.scalar + " is too large");
          return std::nullopt;
        },
        [](int number) { return Node::text(std::to_string(number)); }, default_value);
  }

  Schema& boolean(const std::string& key, bool T::*member, const std::string& sentence,
                  std::optional<bool> default_value = std::nullopt) {
    return value_field<bool>(
        {.name = key, .type = field_type::boolean, .sentence = sentence}, member,
        [=](const Node& node, Problems& problems) { return value::boolean(node, key, problems); },
        [](bool value) { return Node::text(value ? "true" : "false"); }, default_value);
  }

  Schema& text(const std::string& key, std::string T::*member, const std::string& sentence,
               const std::optional<std::string>& default_value = std::nullopt) {
    return value_field<std::string>(
        {.name = key, .type = field_type::text, .sentence = sentence}, member,
        [=](const Node& node, Problems& problems) { return value::text(node, key, problems); }, &Node::text,
        default_value);
  }

  /// A text that may be absent.
  Schema& text(const std::string& key, std::optional<std::string> T::*member, const std::string& sentence,
               const Absent& absent) {
    return optional_field<std::string>(
        {.name = key, .type = field_type::text, .sentence = sentence}, member,
        [=](const Node& node, Problems& problems) { return value::text(node, key, problems); }, &Node::text, absent);
  }

  /// One of these words, kept as a word.
  Schema& word(const std::string& key, std::string T::*member, const std::vector<std::string>& words,
               const std::string& sentence, const std::optional<std::string>& default_value = std::nullopt) {
    return value_field<std::string>(
        {.name = key, .type = field_type::word, .sentence = sentence, .words = words}, member,
        [=](const Node& node, Problems& problems) { return value::word(node, key, words, problems); }, &Node::text,
        default_value);
  }

  /// A name out of a catalogue (its plural; see registry.h).
  Schema& registered(const std::string& key, std::string T::*member, const std::string& catalogue,
                     const std::string& sentence, const std::optional<std::string>& default_value = std::nullopt) {
    return value_field<std::string>(
        {.name = key, .type = field_type::word, .sentence = sentence, .catalogue = catalogue}, member,
        [=](const Node& node, Problems& problems) { return value::registered(node, key, catalogue, problems); },
        &Node::text, default_value);
  }

  /// One of these words, each of which stands for a value.
  template <class E>
  Schema& choice(const std::string& key, E T::*member, const std::vector<std::pair<std::string, E>>& values,
                 const std::string& sentence, std::optional<std::type_identity_t<E>> default_value = std::nullopt) {
    std::vector<std::string> words;
    for (const auto& [word, value] : values) words.push_back(word);
    return value_field<E>(
        {.name = key, .type = field_type::word, .sentence = sentence, .words = words}, member,
        [=](const Node& node, Problems& problems) -> std::optional<E> {
          const auto found = value::word(node, key, words, problems);
          for (const auto& [word, value] : values)
            if (found && word == *found) return value;
          return std::nullopt;
        },
        [=](E wanted) {
          for (const auto& [word, value] : values)
            if (value == wanted) return Node::text(word);
          return Node{};
        },
        default_value);
  }

  /// A list of words, or one word alone; an absent list stays empty.
  Schema& words(const std::string& key, std::vector<std::string> T::*member, const std::string& sentence) {
    return value_field<std::vector<std::string>>(
        {.name = key, .type = field_type::words, .sentence = sentence}, member,
        [=](const Node& node, Problems& problems) { return value::words(node, key, problems); }, &value::from_words,
        std::vector<std::string>{});
  }

  // ---- sections ----

  /// A section whose own keys say what is required; an absent one reads like an empty one.
  template <class U>
  Schema& section(const std::string& key, U T::*member, const Schema<U>& schema, const std::string& sentence) {
    const auto inner = std::make_shared<const Schema<U>>(schema);
    Field field;
    field.doc = {.name = key, .type = field_type::section, .sentence = sentence, .nested = inner->docs()};
    for (const FieldDoc& nested : field.doc.nested) field.doc.required = field.doc.required || nested.required;
    if (!field.doc.required) field.doc.default_text = "the defaults of its keys";
    field.read = [=](void* object, const Node& node, Problems& problems) {
      of(object).*member = inner->read(node, {}, problems);
    };
    field.write = [=](const void* object) { return inner->write(of(object).*member); };
    if (!field.doc.required)
      field.set_default = [=](void* object, Problems& problems) {
        of(object).*member = inner->read(Node{}, {}, problems);
      };
    return with(std::move(field));
  }

  template <class U>
  Schema& section(const std::string& key, std::optional<U> T::*member, const Schema<U>& schema,
                  const std::string& sentence, const Absent& absent = {}) {
    const auto inner = std::make_shared<const Schema<U>>(schema);
    return optional_field<U>(
        {.name = key, .type = field_type::section, .sentence = sentence, .nested = inner->docs()}, member,
        [=](const Node& node, Problems& problems) { return std::optional<U>(inner->read(node, {}, problems)); },
        [=](const U& object) { return inner->write(object); }, absent);
  }

  /// A list of sections. If required it must not be empty.
  template <class U>
  Schema& sections(const std::string& key, std::vector<U> T::*member, const Schema<U>& schema,
                   const std::string& sentence, bool required) {
    const auto inner = std::make_shared<const Schema<U>>(schema);
    Field field;
    field.doc = {
        .name = key, .type = field_type::sections, .sentence = sentence, .required = required, .nested = inner->docs()};
    if (!required) field.doc.default_text = "none";
    field.read = [=](void* object, const Node& node, Problems& problems) {
      if (!is_list(node, key, required, problems)) return;
      for (const Node& item : node.items) (of(object).*member).push_back(inner->read(item, {}, problems));
    };
    field.write = [=](const void* object) {
      Node list = Node::list();
      for (const U& item : of(object).*member) list.items.push_back(inner->write(item));
      return list;
    };
    return with(std::move(field));
  }

  /// Sections by name; U::name is set to the name. None is fine.
  template <class U>
  Schema& named_sections(const std::string& key, std::vector<U> T::*member, const Schema<U>& schema,
                         const std::string& sentence) {
    const auto inner = std::make_shared<const Schema<U>>(schema);
    Field field;
    field.doc = {.name = key,
                 .type = field_type::named_sections,
                 .default_text = "none",
                 .sentence = sentence,
                 .nested = inner->docs()};
    field.read = [=](void* object, const Node& node, Problems& problems) {
      if (!is_map(node, key, problems)) return;
      for (std::size_t i = 0; i < node.items.size(); ++i) {
        U item = inner->read(node.items[i], {}, problems);
        item.name = node.keys[i].first;
        (of(object).*member).push_back(std::move(item));
      }
    };
    field.write = [=](const void* object) {
      Node map = Node::map();
      for (const U& item : of(object).*member) map.set(item.name, inner->write(item));
      return map;
    };
    return with(std::move(field));
  }

  /// A node of the file as it stands, which something else reads later.
  Schema& kept(FieldDoc doc, Node T::*member) {
    return custom(
        std::move(doc), [=](T& object, const Node& node, Problems&) { object.*member = node; },
        [=](const T& object) { return object.*member; });
  }

  /// Whatever the kinds above do not cover. `reader` adds what is wrong to the problems; `writer` returns an absent
  /// node where there is nothing to write.
  Schema& custom(FieldDoc doc, std::function<void(T&, const Node&, Problems&)> reader,
                 std::function<Node(const T&)> writer) {
    Field field;
    field.doc = std::move(doc);
    field.read = [reader](void* object, const Node& node, Problems& problems) { reader(of(object), node, problems); };
    field.write = [writer](const void* object) { return writer(of(object)); };
    return with(std::move(field));
  }

 private:
  static T& of(void* object) { return *static_cast<T*>(object); }
  static const T& of(const void* object) { return *static_cast<const T*>(object); }

  static bool is_list(const Node& node, const std::string& key, bool filled, Problems& problems) {
    if (node.kind == Node::Kind::list && !(filled && node.items.empty())) return true;
    const bool empty = node.kind == Node::Kind::list;
    problems.add(node.place, key + ": found " + (empty ? "an empty list" : description(node)) +
                                 "; expected a list of sections, each beginning with a dash");
    return false;
  }
  static bool is_map(const Node& node, const std::string& key, Problems& problems) {
    if (node.kind == Node::Kind::map) return true;
    problems.add(node.place, key + ": found " + description(node) + "; expected sections by name, NAME: {…}");
    return false;
  }

  static FieldDoc number_doc(const std::string& key, const std::string& type, const Unit& unit, const Range& range,
                             const std::string& sentence) {
    return {.name = key, .type = type, .unit = unit.si, .range = range.text(unit), .sentence = sentence};
  }
  static FieldDoc table_doc(const std::string& key, const Unit& unit, const Range& range, const std::string& sentence) {
    FieldDoc doc = number_doc(key, field_type::quantity, unit, range, sentence);
    doc.alternatives = {{.type = field_type::points, .unit = unit.si}};
    return doc;
  }
  static FieldDoc quantities_doc(const std::string& key, const Unit& unit, const Range& range,
                                 const Components& components, const std::string& sentence) {
    FieldDoc doc = number_doc(key, field_type::quantities, unit, range, sentence);
    if (!components.allowed.empty())
      doc.range = components.text() + " components" + (doc.range.empty() ? "" : ", each ") + doc.range;
    return doc;
  }

  Schema& with(Field field) {
    add(std::move(field));
    return *this;
  }

  template <class V, class Read, class Write>
  Schema& value_field(FieldDoc doc, V T::*member, Read reader, Write writer, const std::optional<V>& default_value) {
    Field field;
    field.doc = std::move(doc);
    field.doc.required = !default_value;
    if (default_value) {
      field.doc.default_value = writer(*default_value);
      field.doc.default_text = default_text_of(field.doc.default_value);
      field.set_default = [=](void* object, Problems&) { of(object).*member = *default_value; };
    }
    field.read = [=](void* object, const Node& node, Problems& problems) {
      if (auto found = reader(node, problems)) of(object).*member = static_cast<V>(std::move(*found));
    };
    field.write = [=](const void* object) { return writer(of(object).*member); };
    return with(std::move(field));
  }

  template <class V, class Read, class Write>
  Schema& optional_field(FieldDoc doc, std::optional<V> T::*member, Read reader, Write writer, const Absent& absent) {
    Field field;
    field.doc = std::move(doc);
    field.doc.default_text = absent.text;
    field.read = [=](void* object, const Node& node, Problems& problems) {
      of(object).*member = reader(node, problems);
    };
    field.write = [=](const void* object) {
      const auto& found = of(object).*member;
      return found ? writer(*found) : Node{};
    };
    return with(std::move(field));
  }

  static std::string default_text_of(const Node& node) {
    if (node.kind == Node::Kind::list && node.items.empty()) return "none";
    std::string text = yaml_text(node);
    while (!text.empty() && text.back() == '\n') text.pop_back();
    return text;
  }
};

}  // namespace sluice
