/// The reference of the case file, generated from the declarations of its keys and from all catalogues.
#pragma once

#include <string>

namespace sluice {

/// The manual page: every key with type, unit, range, default and sentence; then every catalogue with its entries.
std::string case_reference_markdown();

/// JSON Schema (draft-07) of the case file, for completion and checking in editors.
std::string case_json_schema();

}  // namespace sluice
