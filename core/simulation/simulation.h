/// Simulation: a case, set up and advanced step by step. Knows no files; Run (core/simulation/run.h) writes them.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/case/case.h"
#include "core/output/archive.h"
#include "core/particles/particles.h"

namespace sluice {

/// What one step was.
struct StepInfo {
  double dt = 0;        ///< [s]
  std::string limiter;  ///< what set its length: wave, advection, strain, growth, output, fixed, solution
  double speed = 0;     ///< largest speed of a particle [m/s]
};

class Simulation {
 public:
  /// Fills the bodies and makes the initial stress. Throws CaseError.
  static std::unique_ptr<Simulation> create(const Case& definition);
  virtual ~Simulation() = default;

  virtual double time() const = 0;         ///< [s]
  virtual std::int64_t steps() const = 0;  ///< completed
  virtual const Particles& particles() const = 0;
  virtual Particles& particles() = 0;

  /// One step, not beyond `until` [s]. Throws CaseError (a fixed step too long), PhysicsError, OutflowError.
  virtual StepInfo advance(double until) = 0;
  void advance_to(double until) {
    while (time() < until) advance(until);
  }

  /// Throws CaseError if the case fixes a step that is longer than a limit now.
  virtual void require_time_step() const = 0;

  /// What the next step would be, and all limits on it [s], for `sluice check`.
  virtual std::vector<std::pair<std::string, double>> time_step_limits() const = 0;
  virtual std::vector<std::pair<std::string, double>> energies() const = 0;      ///< [J] (2-D: J/m)
  virtual std::vector<std::pair<std::string, double>> step_numbers() const = 0;  ///< of the physics, last step
  virtual std::vector<std::pair<std::string, double>> totals() const = 0;        ///< of the physics, so far
  virtual double largest_speed() const = 0;  ///< of a particle, after the last step [m/s]
  virtual std::map<std::string, double> stage_seconds() const = 0;
  virtual std::size_t removed_particles() const = 0;
  virtual std::size_t memory() const = 0;  ///< bytes of the particle columns
  virtual std::vector<std::pair<std::string, Node>> resolved_sections() const = 0;

  /// Everything that a restarted run needs to equal the uninterrupted one, bit for bit.
  virtual void store(Archive& archive) const = 0;
  virtual void restore(const Archive& archive) = 0;
};

}  // namespace sluice
