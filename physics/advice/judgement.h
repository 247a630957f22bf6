/// Judgement: which models of a case are within the tolerance, what each would cost, and which to take.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/case/advice.h"
#include "physics/advice/scene_numbers.h"

namespace sluice::advice {

/// What a model gets wrong most, and where.
struct Demand {
  double error = 0;
  std::string material, stage;
  ColumnErrors column;
  double drainage_length = 0;  ///< [m]
};

/// A model that the program has.
struct Choice {
  std::string name;       ///< "undrained total stress"
  std::size_t model = 0;  ///< index in `models`
  Demand demand;
  std::string trouble;  ///< why this case cannot take it; empty if it can
  // Costs.
  double dt = 0;       ///< [s]
  double seconds = 0;  ///< of a step; in the case of `judge` in units of a step of total_stress
  double steps = 0;
  double cost() const { return steps * seconds; }
};

struct Judgement {
  SceneNumbers scene;
  /// drained and undrained total stress, u-p, v-w-p
  std::array<Choice, 4> choices;
  bool inertia_matters = true;     ///< consolidation without inertia is not within the tolerance
  std::optional<std::size_t> own;  ///< index of what the case is; none: `auto`, or the explicit formulation
  std::size_t simplest = 0;        ///< within the tolerance, whether the case can take it or not
  std::size_t taken = 0;           ///< the cheapest within the tolerance that the case can take

  bool adequate(std::size_t choice) const { return choices[choice].demand.error < scene.asked.tolerance; }
};

/// Costs are relative, in the ratios of docs/performance.md: the same on every machine.
Judgement judge(const Case& definition);

/// Adds costs in seconds on this machine, for people: `own` is what steps of the case cost; the others are tried for a
/// moment. The choice stays that of `judge`: a busy machine must not change it.
void measure(Judgement& judgement, const Case& definition, const StepCost& own);

/// The case with the model `choice`.
Case with_choice(const Case& definition, const SceneNumbers& scene, std::size_t choice);

/// In what the case models too little, and what to take; empty if it does not.
std::string shortcoming(const Judgement& judgement);

/// Lines for people; costs are in seconds.
std::vector<std::string> lines(const Judgement& judgement, const Case& definition);

/// The verdict with its numbers, for the results.
Node record(const Judgement& judgement);
/// The key in it of the error of a model: "error_of_undrained_total_stress".
std::string error_key(const std::string& model);

}  // namespace sluice::advice
