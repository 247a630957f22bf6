#include "core/simulation/prediction.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/case/advice.h"
#include "core/output/observation.h"
#include "core/output/pictures.h"
#include "core/parallel/parallel.h"
#include "core/simulation/progress.h"
#include "core/simulation/simulation.h"
#include "core/simulation/trial.h"

namespace sluice {

void print_prediction(const Case& definition) {
  const auto simulation = Simulation::create(definition);
  for (const auto& observation : definition.observe)
    make_observation(observation, simulation->particles(), definition.grid.cell);
  require_pictured_fields(definition, simulation->particles());
  simulation->require_time_step();
  const Particles& particles = simulation->particles();
  fmt::print("{}: {}\n", definition.file, definition.title);
  fmt::print("  physics         {}, {}-D, {}, {}, {}\n", definition.physics, definition.dimension(),
             definition.scheme.shape, definition.scheme.transfer, definition.scheme.stress_update);
  fmt::print("  particles       {}\n", particles.size());
  for (std::size_t m = 0; m < particles.material_names.size(); ++m)
    fmt::print("    {:<24}{}\n", particles.material_names[m],
               std::count(particles.material.begin(), particles.material.end(), static_cast<std::int32_t>(m)));
  fmt::print("  particle memory {:.1f} MB\n", static_cast<double>(simulation->memory()) / 1e6);
  for (const auto& [name, seconds] : simulation->time_step_limits())
    if (std::isfinite(seconds)) fmt::print("  limit           {:.4g} s ({})\n", seconds, name);
  const double dt = next_step(definition, *simulation), steps = std::ceil(definition.end_time / dt);
  fmt::print("  time step       {:.4g} s {}\n", dt,
             definition.scheme.fixed_time_step ? "(fixed by the case)" : "(computed)");
  fmt::print("  steps           about {:.0f} to {:g} s\n", steps, definition.end_time);
  const StepCost cost = try_steps(definition, *simulation);
  fmt::print("  run time        about {} on {} thread{} ({:.3g} million particle-steps per second)\n",
             duration_text(steps * cost.seconds), thread_count(), thread_count() == 1 ? "" : "s",
             static_cast<double>(particles.size()) / cost.seconds / 1e6);
  for (const auto& [name, entry] : advisor_registry().entries())
    for (const std::string& line : advisor_registry().find(name, {}).advise(definition, cost))
      fmt::print("  {}\n", line);
}

}  // namespace sluice
