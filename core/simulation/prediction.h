/// Prediction: what a case will cost, before it runs.
#pragma once

#include "core/case/case.h"

namespace sluice {

/// Sets the case up, takes a few steps, and prints to standard output: particles, memory, the limits of the time step
/// and which of them limits, the number of steps and the time that the run will take on this machine. The prediction
/// holds as long as wave speeds and particle speeds stay near those of the start. Throws CaseError.
void print_prediction(const Case& definition);

}  // namespace sluice
