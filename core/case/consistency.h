/// Consistency: what a case must fulfil across its keys, and the defaults that depend on other keys.
#pragma once

#include "core/case/case.h"
#include "core/case/problems.h"

namespace sluice {

/// Fills in what depends on the dimension and checks what concerns several keys: components, whole numbers of cells,
/// names of materials and faces, bodies inside the grid. `definition.source` gives the places. Keys that could not be
/// read are passed over, as they are reported already.
void complete_and_check(Case& definition, Problems& problems);

/// Whether a region has a shape, and all its shapes the dimension of the grid; `section` is what it was read from and
/// `what` its name in messages.
bool check_region(const Region& region, const Node& section, const std::string& what, std::size_t dimension,
                  Problems& problems);

}  // namespace sluice
