/// Steps of any length: what the program would do if it did not refuse those beyond its limits.
#pragma once

#include "core/particles/fill.h"
#include "core/simulation/physics_module.h"
#include "tests/verification/scene_fixture.h"

namespace sluice {

/// A scene in the plane, stepped without choice or test of the step.
class UnguardedRun {
 public:
  explicit UnguardedRun(const SceneText& text)
      : definition_(parse_case(text.text(), "scene.yaml")),
        scene_(definition_),
        module_(physics_registry<2>().find(definition_.physics, definition_.source.place)(definition_)) {
    module_->declare(scene_.particles);
    fill_bodies<2>(
        definition_, scene_.grid, [&](int m) { return module_->density(m); }, scene_.particles);
    scene_.initialise_domains();
    module_->initialise(scene_);
  }

  Particles& particles() { return scene_.particles; }
  double kinetic_energy() const {
    for (const auto& [name, value] : module_->energies(scene_))
      if (name == "kinetic") return value;
    return NAN;
  }
  double speed() const { return std::sqrt(scene_.motion.largest_speed_squared); }
  /// False when the run has burst: particles have left the grid, crossed half a cell in a step, inverted, or are no
  /// numbers.
  bool steps(int count, double dt) {
    try {
      for (int i = 0; i < count; ++i) {
        module_->step(scene_, dt);
        if (!scene_.motion.inside || scene_.motion.largest_travel > 0.5) return false;
        scene_.time += dt;
        ++scene_.step;
        scene_.previous_dt = dt;
      }
    } catch (const std::exception&) {
      return false;
    }
    return true;
  }

 private:
  Case definition_;
  Scene<2> scene_;
  std::unique_ptr<PhysicsModule<2>> module_;
};

/// Whether small velocities stay small over two thousand steps.
inline bool stays_small(UnguardedRun& run, double dt, double start) {
  for (int i = 0; i < 40; ++i)
    if (!run.steps(50, dt) || run.speed() > 100 * start) return false;
  return true;
}

/// The largest number up to `high` that is stable, to 2 %; the smallest that is tried, `low`, if none is.
template <class Stable>
double stable_limit(const Stable& stable, double low, double high) {
  if (stable(high)) return high;
  while (high / low > 1.02) {
    const double middle = std::sqrt(low * high);
    (stable(middle) ? low : high) = middle;
  }
  return low;
}

}  // namespace sluice
