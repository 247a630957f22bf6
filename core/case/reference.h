/// The reference of the case file, generated from the declarations of its keys and from all catalogues.
#pragma once

#include <string>
#include <vector>

#include "core/case/schema.h"

namespace sluice {

/// The manual page: every key with type, unit, range, default and sentence; then every catalogue with its entries.
std::string case_reference_markdown();

/// The same for another kind of file, as a section of that page.
std::string file_reference_markdown(const std::string& title, const std::string& sentence,
                                    const std::vector<FieldDoc>& docs);

/// JSON Schema (draft-07) of the case file, for completion and checking in editors.
std::string case_json_schema();

}  // namespace sluice
