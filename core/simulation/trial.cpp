#include "core/simulation/trial.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace sluice {

double next_step(const Case& definition, const Simulation& simulation) {
  double dt = INFINITY;
  for (const auto& limit : simulation.time_step_limits()) dt = std::min(dt, limit.second);
  return definition.scheme.fixed_time_step.value_or(dt);
}

StepCost try_steps(const Case& definition, Simulation& simulation, double budget) {
  using Clock = std::chrono::steady_clock;
  StepCost cost{next_step(definition, simulation), 0, simulation.particles().size()};
  const double end = definition.end_time;
  simulation.advance(end);  // the first step sorts and allocates
  const auto start = Clock::now();
  const auto elapsed = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
  const auto first = simulation.steps();
  while (elapsed() < budget && simulation.time() < end) simulation.advance(end);
  const auto steps = simulation.steps() - first;
  cost.seconds = steps > 0 ? elapsed() / static_cast<double>(steps) : elapsed();
  return cost;
}

}  // namespace sluice
