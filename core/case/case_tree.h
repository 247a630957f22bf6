/// The tree of a case: a file with those that it extends, overrides applied, other files found.
#pragma once

#include <string>
#include <vector>

#include "core/case/case.h"
#include "core/case/problems.h"

namespace sluice {

/// Merges `tree` into the file that its key `extends` names, and that into the next: maps are merged key by key,
/// anything else is replaced. Each part keeps its place. `file` is the file of `tree`. Throws CaseError.
Node extended(Node tree, const std::string& file);

/// The overrides that `--set` gives as KEY=VALUE. Throws CaseError.
std::vector<Override> overrides_of(const std::vector<std::string>& settings);

/// Sets values along paths such as materials.core.cohesion or bodies.2.velocity; keys that do not exist are made.
void apply_overrides(const std::vector<Override>& overrides, Node& tree, Problems& problems);

/// Puts polygons in the place of references FILE.yaml#NAME, and completes the names of rasters and of the results of
/// earlier runs by their folders. Files lie beside the file that names them, or beside `case_file` if an override does.
void resolve_files(Node& tree, const std::string& case_file, Problems& problems);

/// The key `schema` of a file: this version of the program knows 1 only.
void check_schema_version(const Node& version, Problems& problems);

}  // namespace sluice
