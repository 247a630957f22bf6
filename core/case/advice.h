/// Advice: what may be said of a case before it runs, beyond whether it is valid. Advisors live outside of the core and
/// register themselves, as materials do: `sluice check` prints what they say.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/case/case.h"
#include "core/case/registry.h"

namespace sluice {

/// What a few steps of a case have shown.
struct StepCost {
  double dt = 0;       ///< length of a step [s]
  double seconds = 0;  ///< that a step takes
  std::size_t particles = 0;
};

struct Advisor {
  /// Called with every case that has been read and checked: reads the keys that are the advisor's own, throws CaseError
  /// if they are wrong, and makes the choices that the case leaves open, for example `physics: auto`.
  std::function<void(Case&)> complete;
  /// What a run should be warned of before it starts; must be quick.
  std::function<std::vector<std::string>(const Case&)> warn;
  /// Lines for people, without the ends of the lines; `cost` is that of the case itself.
  std::function<std::vector<std::string>(const Case&, const StepCost& cost)> advise;
};

Registry<Advisor>& advisor_registry();

}  // namespace sluice
