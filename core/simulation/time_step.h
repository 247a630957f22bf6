/// The limits of an explicit time step, and the choice of its length.
#pragma once

#include <vector>

#include "core/simulation/physics_module.h"

namespace sluice {

/// Share of each limit that a step may use.
struct SafetyFactors {
  double courant;          ///< of h / (c + |v|)
  double advection;        ///< of a cell that a particle crosses
  double strain_per_step;  ///< largest strain increment
};

/// wave: courant h / (c + |v|); advection: advection h / |v|; strain: strain_per_step / |strain rate|.
/// docs/theory.md, eqs. (27)-(29). `fastest_wave` is c [m/s]; speeds and strain rates are those of the last step.
template <int Dim>
std::vector<TimeStepLimit> explicit_limits(const Scene<Dim>& scene, double fastest_wave, const SafetyFactors& factors);

/// The smallest of the limits.
TimeStepLimit smallest(const std::vector<TimeStepLimit>& limits);

/// The next step: the fixed one of the case, or the smallest limit, which may grow by a tenth a step. Shortened so that
/// `until` is met after a whole number of about equal steps; the limiter is called "output" if that more than halves
/// it. Throws CaseError if the fixed step exceeds a hard limit.
template <int Dim>
TimeStepLimit choose_time_step(const PhysicsModule<Dim>& module, const Scene<Dim>& scene, double until);

}  // namespace sluice
