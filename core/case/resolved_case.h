/// The resolved case: a case written out with all its defaults, as case.resolved.yaml.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/case/case.h"

namespace sluice {

/// The complete case as YAML that load_case reads back as an equal case. Values are in SI with their units; polygons of
/// other files and extended files are written in place. `sections` come from the physics module and take the place of
/// those of the case, for example {"materials", …}; keys of materials that are left out get the defaults of their
/// model.
std::string resolved_yaml(const Case& definition, const std::vector<std::pair<std::string, Node>>& sections = {});

}  // namespace sluice
