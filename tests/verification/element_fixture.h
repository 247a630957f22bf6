/// Element tests in a few words: files put together from a material and a path, and their rows.
#pragma once

#include <fmt/format.h>

#include <string>
#include <vector>

#include "physics/element/comparison.h"
#include "physics/element/reference.h"

namespace sluice::element {

/// An element file; `start`, `path` and `rest` are YAML, for example "initial_pressure: 100 kPa".
inline ElementCase element_test(const std::string& material, const std::string& start, const std::string& path,
                                const std::string& rest = "increments: 200") {
  return parse_element(fmt::format("schema: 1\nmaterial: {{{}}}\n{}\npath: {}\n{}\n", material, start, path, rest),
                       "element.yaml");
}

inline std::vector<Row> rows_of(const ElementCase& definition) {
  std::vector<Row> rows;
  drive(definition, *material_of(definition), [&](const Row& row) { rows.push_back(row); });
  return rows;
}

inline std::vector<Row> reference_of(const ElementCase& definition) {
  std::vector<Row> rows;
  integrate_reference(definition, *material_of(definition), [&](const Row& row) { rows.push_back(row); });
  return rows;
}

}  // namespace sluice::element
