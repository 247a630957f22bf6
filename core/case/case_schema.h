/// The declarations of all keys of a case file.
#pragma once

#include "core/case/case.h"
#include "core/case/region_schema.h"
#include "core/case/schema.h"

namespace sluice {

/// Reads everything that can be judged key by key; what concerns several keys is for the consistency check.
const Schema<Case>& case_schema();

/// Names of the faces of a grid, lower then upper, axis by axis.
std::vector<std::string> face_words(int dimension);

}  // namespace sluice
