#include "core/simulation/prediction.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "core/output/observation.h"
#include "core/output/pictures.h"
#include "core/parallel/parallel.h"
#include "core/simulation/progress.h"
#include "core/simulation/simulation.h"

namespace sluice {

namespace {

/// Seconds that a step takes, from a trial of about a quarter of a second.
double time_a_step(Simulation& simulation, double end_time) {
  using Clock = std::chrono::steady_clock;
  simulation.advance(end_time);  // the first step sorts and allocates
  const auto start = Clock::now();
  const auto elapsed = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
  const auto first = simulation.steps();
  while (elapsed() < 0.25 && simulation.time() < end_time) simulation.advance(end_time);
  return simulation.steps() > first ? elapsed() / static_cast<double>(simulation.steps() - first) : elapsed();
}

}  // namespace

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
  double dt = INFINITY;
  for (const auto& [name, seconds] : simulation->time_step_limits()) {
    if (std::isfinite(seconds)) fmt::print("  limit           {:.4g} s ({})\n", seconds, name);
    dt = std::min(dt, seconds);
  }
  if (definition.scheme.fixed_time_step) dt = *definition.scheme.fixed_time_step;
  const double steps = std::ceil(definition.end_time / dt);
  fmt::print("  time step       {:.4g} s {}\n", dt,
             definition.scheme.fixed_time_step ? "(fixed by the case)" : "(computed)");
  fmt::print("  steps           about {:.0f} to {:g} s\n", steps, definition.end_time);
  const double seconds = time_a_step(*simulation, definition.end_time);
  fmt::print("  run time        about {} on {} thread{} ({:.3g} million particle-steps per second)\n",
             duration_text(steps * seconds), thread_count(), thread_count() == 1 ? "" : "s",
             static_cast<double>(particles.size()) / seconds / 1e6);
}

}  // namespace sluice
