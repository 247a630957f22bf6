/// Trial: a few steps of a case, to see what they cost.
#pragma once

#include "core/case/advice.h"
#include "core/simulation/simulation.h"

namespace sluice {

/// The length of the next step: the smallest of the limits, or what the case fixes [s].
double next_step(const Case& definition, const Simulation& simulation);

/// Takes steps for some `budget` seconds, at least two unless the end time comes first.
StepCost try_steps(const Case& definition, Simulation& simulation, double budget = 0.25);

}  // namespace sluice
