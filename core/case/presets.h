/// Presets: named sets of values for the section `scheme`. Each is a point on the fronts of docs/charts, where error is
/// charted against cost. Keys that the case gives go before those of the preset.
#pragma once

#include <map>
#include <string>

#include "core/case/node.h"

namespace sluice {

struct Preset {
  std::string summary;
  std::map<std::string, std::string> values;  ///< keys of `scheme`; what is absent keeps its default
};

/// Fills the section `scheme` of a tree from the preset that it names; does nothing without a preset, or with one that
/// does not exist, which the schema reports.
void apply_preset(Node& tree);

}  // namespace sluice
