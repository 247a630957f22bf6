/// The same case with another model of its water.
#pragma once

#include "physics/advice/scene_numbers.h"

namespace sluice::advice {

/// Why the case cannot be computed in drained or undrained total stresses; empty if it can.
std::string trouble_with_drained(const Case& definition, const SceneNumbers& scene);
std::string trouble_with_undrained(const Case& definition, const SceneNumbers& scene);
/// The same for soil with water.
std::string trouble_with_water(const Case& definition);

/// In total stresses: densities with water; stiffness of the skeleton, or of skeleton and water together, or what the
/// material says under `undrained`. Ponds become loads.
Case in_total_stress(const Case& definition, const SceneNumbers& scene, bool drained);
/// With pore water in the given formulation.
Case with_pore_water(const Case& definition, const SceneNumbers& scene, const std::string& formulation);
/// Without the search for the state at the start, for a trial of what steps cost.
Case from_nothing(Case definition);

}  // namespace sluice::advice
