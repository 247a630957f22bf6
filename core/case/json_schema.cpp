#include <nlohmann/json.hpp>

#include "core/case/case_schema.h"
#include "core/case/reference.h"
#include "core/case/registry.h"

namespace sluice {

namespace {

// Keys in the order of declaration, as in the manual.
using Json = nlohmann::ordered_json;

Json schema_of(const FieldDoc& doc);

Json reference_to(const std::string& definition) { return {{"$ref", "#/definitions/" + definition}}; }

Json section_of(const std::vector<FieldDoc>& docs) {
  // A section whose keys somebody else declares.
  if (docs.empty()) return {{"type", "object"}};
  Json section = {{"type", "object"}, {"additionalProperties", false}, {"properties", Json::object()}};
  Json required = Json::array();
  for (const FieldDoc& doc : docs) {
    section["properties"][doc.name] = schema_of(doc);
    if (doc.required) required.push_back(doc.name);
  }
  if (!required.empty()) section["required"] = required;
  return section;
}

Json words_of(const FieldDoc& doc) {
  std::vector<std::string> words = doc.words;
  const auto catalogue = Catalogue::all().find(doc.catalogue);
  if (catalogue != Catalogue::all().end()) words = catalogue->second->names();
  Json word = {{"type", "string"}};
  if (!words.empty()) word["enum"] = words;
  return word;
}

/// The value alone, without alternatives and description.
Json value_of(const FieldDoc& doc) {
  if (doc.type == field_type::quantity) return reference_to("quantity");
  if (doc.type == field_type::quantities) return {{"type", "array"}, {"items", reference_to("quantity")}};
  if (doc.type == field_type::points)
    return {{"type", "array"},
            {"minItems", 3},
            {"items", {{"type", "array"}, {"items", reference_to("quantity")}, {"minItems", 2}}}};
  if (doc.type == field_type::integer) return {{"type", "integer"}};
  if (doc.type == field_type::boolean) return {{"type", "boolean"}};
  if (doc.type == field_type::word) return words_of(doc);
  if (doc.type == field_type::text) return {{"type", Json::array({"string", "number"})}};
  if (doc.type == field_type::words)
    return {{"anyOf", Json::array({{{"type", "string"}}, {{"type", "array"}, {"items", {{"type", "string"}}}}})}};
  if (doc.type == field_type::section) return section_of(doc.nested);
  if (doc.type == field_type::sections) return {{"type", "array"}, {"items", section_of(doc.nested)}};
  if (doc.type == field_type::named_sections)
    return {{"type", "object"}, {"additionalProperties", section_of(doc.nested)}};
  return Json::object();
}

std::string description_of(const FieldDoc& doc) {
  std::string text = doc.sentence;
  if (!doc.unit.empty()) text += " Unit: " + doc.unit + ".";
  if (!doc.range.empty()) text += " Allowed: " + doc.range + ".";
  if (!doc.default_text.empty()) text += " Default: " + doc.default_text + ".";
  return text;
}

Json schema_of(const FieldDoc& doc) {
  Json schema = value_of(doc);
  if (doc.type == field_type::named_sections && !doc.alternatives.empty()) {
    // The alternative is one to each section, not to all of them.
    schema["additionalProperties"] = {{"anyOf", Json::array({section_of(doc.nested), value_of(doc.alternatives[0])})}};
  } else if (!doc.alternatives.empty()) {
    Json ways = Json::array({std::move(schema)});
    for (const FieldDoc& other : doc.alternatives) ways.push_back(value_of(other));
    schema = {{"anyOf", std::move(ways)}};
  }
  // Draft-07 ignores everything beside a reference.
  if (schema.contains("$ref")) schema = {{"allOf", Json::array({std::move(schema)})}};
  schema["description"] = description_of(doc);
  if (doc.default_value.kind == Node::Kind::scalar) schema["default"] = doc.default_value.scalar;
  return schema;
}

/// One section a model: its keys, and the word `model` that chooses it.
Json materials_schema() {
  const auto catalogue = Catalogue::all().find("materials");
  if (catalogue == Catalogue::all().end()) return {{"type", "object"}};
  Json ways = Json::array();
  for (const auto& [name, entry] : catalogue->second->entries()) {
    Json section = section_of(entry.keys ? entry.keys() : std::vector<FieldDoc>{});
    section["properties"]["model"] = {{"const", name}, {"description", entry.summary}};
    section["required"].push_back("model");
    ways.push_back(std::move(section));
  }
  return {{"oneOf", std::move(ways)}};
}

}  // namespace

std::string case_json_schema() {
  Json schema = {{"$schema", "http://json-schema.org/draft-07/schema#"}, {"title", "Case file of Sluice"}};
  schema.update(section_of(case_schema().docs()));
  schema["properties"]["schema"] = {{"const", 1}, {"description", "Version of the case-file format."}};
  schema["properties"]["materials"]["additionalProperties"] = materials_schema();
  schema["properties"]["extends"] = {{"type", "string"}, {"description", "Another case file that this one changes."}};
  schema.erase("required");  // what is missing may come from the file that is extended
  schema["definitions"]["quantity"] = {
      {"anyOf", Json::array({{{"type", "number"}}, {{"type", "string"}, {"pattern", "^[-+]?[0-9.]"}}})},
      {"description", "A number with its unit, for example 2 MPa; a bare number is in SI."}};
  return schema.dump(2) + "\n";
}

}  // namespace sluice
