#include "core/case/schema.h"

#include <fmt/format.h>

#include <algorithm>

namespace sluice {

std::vector<FieldDoc> AnySchema::docs() const {
  std::vector<FieldDoc> docs;
  for (const Field& field : fields_) docs.push_back(field.doc);
  return docs;
}

namespace {

std::string example_of(const FieldDoc& doc) {
  std::string text = doc.type;
  if (!doc.unit.empty()) text += " in " + doc.unit;
  if (!doc.range.empty()) text += ", " + doc.range;
  return text;
}

}  // namespace

void AnySchema::read_fields(void* object, const Node& section, const std::vector<std::string>& others,
                            Problems& problems) const {
  if (section.kind != Node::Kind::map && section.kind != Node::Kind::absent) {
    problems.add(section.place,
                 fmt::format("{}: found {}; expected a map of keys and values", name_, description(section)));
    return;
  }
  std::vector<std::string> allowed;
  for (const Field& field : fields_) allowed.push_back(field.doc.name);
  allowed.insert(allowed.end(), others.begin(), others.end());
  for (const auto& [key, place] : section.keys)
    if (std::find(allowed.begin(), allowed.end(), key) == allowed.end())
      problems.add(place, fmt::format("unknown key '{}' in {}; {}", key, name_, allowed_words(key, allowed)));
  for (const Field& field : fields_) {
    if (const Node* const value = section.find(field.doc.name)) {
      field.read(object, *value, problems);
    } else if (field.doc.required) {
      problems.add(section.place, fmt::format("{}: the key '{}' is missing ({}): {}", name_, field.doc.name,
                                              example_of(field.doc), field.doc.sentence));
    } else if (field.set_default) {
      field.set_default(object, problems);
    }
  }
}

Node AnySchema::write_fields(const void* object) const {
  Node map = Node::map();
  for (const Field& field : fields_)
    if (Node value = field.write(object)) map.set(field.doc.name, std::move(value));
  return map;
}

}  // namespace sluice
