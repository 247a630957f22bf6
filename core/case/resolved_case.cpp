#include "core/case/resolved_case.h"

#include <algorithm>

#include "core/case/case_schema.h"
#include "core/case/registry.h"

namespace sluice {

namespace {

/// Adds the defaults of the material's model, as its catalogue entry declares them; keys of the physics go last, so
/// that a resolved case is resolved to itself.
void fill_in(Node& material) {
  const auto catalogue = Catalogue::all().find("materials");
  const Node* const model = material.find("model");
  if (catalogue == Catalogue::all().end() || model == nullptr) return;
  const auto entry = catalogue->second->entries().find(model->scalar);
  if (entry == catalogue->second->entries().end() || !entry->second.keys) return;
  for (const FieldDoc& doc : entry->second.keys())
    if (doc.default_value && material.find(doc.name) == nullptr) material.set(doc.name, doc.default_value);
  Node own = Node::map(), other = Node::map();
  for (std::size_t i = 0; i < material.items.size(); ++i) {
    const std::string& key = material.keys[i].first;
    const bool of_model = key == "model" || std::ranges::any_of(entry->second.keys(),
                                                                [&](const FieldDoc& doc) { return doc.name == key; });
    (of_model ? own : other).set(key, material.items[i]);
  }
  for (std::size_t i = 0; i < other.items.size(); ++i) own.set(other.keys[i].first, other.items[i]);
  material = std::move(own);
}

/// The same map with its keys in the order of the schema, whoever wrote them.
Node in_order(const Node& whole) {
  Node ordered = Node::map();
  for (const FieldDoc& doc : case_schema().docs())
    if (const Node* const section = whole.find(doc.name)) ordered.set(doc.name, *section);
  return ordered;
}

}  // namespace

std::string resolved_yaml(const Case& definition, const std::vector<std::pair<std::string, Node>>& sections) {
  Node whole = case_schema().write(definition);
  for (const auto& [name, section] : sections)
    if (section) whole.set(name, section);
  whole = in_order(whole);
  if (Node* const materials = whole.find("materials"))
    for (Node& material : materials->items) fill_in(material);
  return yaml_text(whole);
}

}  // namespace sluice
