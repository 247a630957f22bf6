/// PhysicsModule: what the time loop asks of a physics.
///
/// A module is registered under the name that a case file uses. The time loop, output, checkpoints, boundaries,
/// transfers and materials are written once and serve every module.
#pragma once

#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "core/case/case.h"
#include "core/case/registry.h"
#include "core/output/archive.h"
#include "core/simulation/scene.h"

namespace sluice {

/// The longest step that a condition allows, and which condition that is.
struct TimeStepLimit {
  double seconds;
  std::string name;
};

/// The physics went bad (a velocity that is not finite, an inverted particle): exit code 3.
class PhysicsError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// No solution of a step was found. The module has given back the state before the step, so that a shorter one can be
/// tried.
class StepNotSolved : public PhysicsError {
  using PhysicsError::PhysicsError;
};

template <int Dim>
class PhysicsModule {
 public:
  virtual ~PhysicsModule() = default;

  /// The columns that it reads and writes, beside those that every scene has.
  virtual void declare(Particles& particles) = 0;
  /// Density [kg/m3] of the material with this index of Case::materials: sets the masses.
  virtual double density(int material) const = 0;
  /// Called once, when all particles are in place: initial stress and the like.
  virtual void initialise(Scene<Dim>& scene) = 0;

  /// Called when particles have changed their material, before the step after that.
  virtual void materials_changed(const Scene<Dim>& /*scene*/) {}

  /// All limits on the next step with a unit safety factor: a longer step is unstable or inaccurate beyond use.
  virtual std::vector<TimeStepLimit> hard_limits(const Scene<Dim>& scene) const = 0;
  /// All limits on the next step with the safety factors of the case.
  virtual std::vector<TimeStepLimit> time_step_limits(const Scene<Dim>& scene) const = 0;
  /// Advances the scene from time to time + dt (the caller updates time and step). May throw StepNotSolved.
  virtual void step(Scene<Dim>& scene, double dt) = 0;

  /// What the module itself carries from step to step, for checkpoints.
  virtual void store(Archive& archive) const = 0;
  virtual void restore(const Archive& archive) = 0;

  /// Energies by name [J], for history.csv.
  virtual std::vector<std::pair<std::string, double>> energies(const Scene<Dim>& scene) const = 0;

  /// Further numbers of the last step by name, for history.csv: iterations of a solver and the like. The same names in
  /// every step, the same numbers in every run of a case.
  virtual std::vector<std::pair<std::string, double>> step_numbers() const { return {}; }
  /// Further numbers of the whole run so far, for summary.json; may hold times.
  virtual std::vector<std::pair<std::string, double>> totals() const { return {}; }

  /// Sections that the module reads, with all defaults filled in, by name; for case.resolved.yaml.
  virtual std::vector<std::pair<std::string, Node>> resolved_sections() const = 0;
};

template <int Dim>
using PhysicsRegistry = Registry<std::function<std::unique_ptr<PhysicsModule<Dim>>(const Case&)>>;

/// Physics modules by name. The catalogue that `sluice list physics` shows is the 2-D one.
template <int Dim>
PhysicsRegistry<Dim>& physics_registry();

}  // namespace sluice
