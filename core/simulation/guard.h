/// Guards: what stops a run when the physics goes bad, or when a particle leaves the grid.
#pragma once

#include "core/case/case.h"
#include "core/simulation/physics_module.h"

namespace sluice {

/// Throws PhysicsError naming the first particle whose velocity, stress or volume is not sound: its identity, material,
/// place, speed and step. To be called when a report says that there is one.
template <int Dim>
[[noreturn]] void throw_first_bad_particle(const Scene<Dim>& scene);

/// Throws PhysicsError naming the fastest particle and the limit that made the step useless.
template <int Dim>
[[noreturn]] void throw_time_step_collapsed(const Scene<Dim>& scene, const TimeStepLimit& limit);

/// A particle left the grid under `outflow: error`: exit code 1.
class OutflowError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Applies the outflow policy to particles outside of the grid; returns how many were removed. Throws OutflowError
/// under OutflowPolicy::error.
template <int Dim>
std::size_t apply_outflow(Scene<Dim>& scene, OutflowPolicy policy);

}  // namespace sluice
