#include "core/case/presets.h"

#include "core/case/registry.h"

namespace sluice {

namespace {

Registry<Preset>& preset_registry() {
  static Registry<Preset> registry("preset", "presets");
  return registry;
}

bool add(const std::string& name, const Preset& preset) {
  return preset_registry().add(name, {preset.summary, {}}, preset);
}

const bool registered =
    add("balanced", {"What the scheme is without a word: quadratic B-splines with APIC, stresses last.", {}}) &&
    add("fast", {"uGIMP with TPIC, stresses last: the most exact on coarse grids, for material that keeps together.",
                 {{"shape", "ugimp"}, {"transfer", "tpic"}}}) &&
    add("accurate", {"Cubic B-splines with APIC, stresses last; wants 9 particles in a cell or more (27 in 3-D).",
                     {{"shape", "cubic_bspline"}, {"transfer", "apic"}}}) &&
    add("paper", {"Of Tjung & Soga: linear functions, FLIP, stresses first, steps of 0.04 of the wave limit.",
                  {{"shape", "linear"},
                   {"transfer", "flip"},
                   {"flip_fraction", "1"},
                   {"stress_update", "usf"},
                   {"courant", "0.04"}}});

}  // namespace

void apply_preset(Node& tree) {
  Node* const scheme = tree.find("scheme");
  const Node* const name = scheme == nullptr ? nullptr : scheme->find("preset");
  if (name == nullptr || !preset_registry().entries().contains(name->scalar)) return;
  const Place place = name->place;
  for (const auto& [key, value] : preset_registry().find(name->scalar, place).values) {
    if (scheme->find(key) != nullptr) continue;
    Node filled = Node::text(value);
    filled.place = place;
    scheme->set(key, filled);
  }
}

}  // namespace sluice
