/// total_stress: a single phase in total stresses, advanced explicitly in time or by implicit steps. docs/theory.md,
/// sections 2 to 5.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/simulation/physics_module.h"
#include "physics/initial_stress/initial_stress.h"
#include "physics/loads/pressed_particles.h"
#include "physics/materials/stress_update.h"
#include "physics/total_stress/implicit_step.h"

namespace sluice {

template <int Dim>
class TotalStress final : public PhysicsModule<Dim> {
 public:
  explicit TotalStress(const Case& definition);

  void declare(Particles& particles) override;
  double density(int material) const override;
  void initialise(Scene<Dim>& scene) override;
  void materials_changed(const Scene<Dim>& scene) override { stress_.initialise(scene); }
  std::vector<TimeStepLimit> hard_limits(const Scene<Dim>& scene) const override;
  std::vector<TimeStepLimit> time_step_limits(const Scene<Dim>& scene) const override;
  void step(Scene<Dim>& scene, double dt) override;
  void store(Archive& archive) const override {
    archive.reals["total_stress"] = {stress_.fastest_wave(), pressed_.work()};
  }
  void restore(const Archive& archive) override {
    stress_.restore_fastest_wave(archive.reals.at("total_stress").at(0));
    pressed_.restore_work(archive.reals.at("total_stress").at(1));
  }
  std::vector<std::pair<std::string, double>> energies(const Scene<Dim>& scene) const override;
  std::vector<std::pair<std::string, double>> step_numbers() const override;
  std::vector<std::pair<std::string, Node>> resolved_sections() const override;

 private:
  void step_usf(Scene<Dim>& scene, double dt);
  void step_usl(Scene<Dim>& scene, double dt);
  void step_musl(Scene<Dim>& scene, double dt);
  void step_implicit(Scene<Dim>& scene, double dt);
  /// Those at the present time.
  SkeletonLoads<Dim> loads_at_rest(Scene<Dim>& scene);
  void scatter_momentum_and_advance(Sweep<Dim>& sweep, Scene<Dim>& scene, double dt);
  void scatter_forces(Scene<Dim>& scene, std::size_t b, const ParticleBlock<Dim>& block, ScatterWhat what);
  void add_load_work(Sweep<Dim>& sweep, Scene<Dim>& scene);
  /// The forces of loads alone, or null where no face has friction.
  FieldsByBody<Dim>* loads_alone(const Scene<Dim>& scene) { return rough_under_load(scene) ? &wall_ : nullptr; }
  bool rough_under_load(const Scene<Dim>& scene) const { return outside_.any() && scene.any_friction(); }

  StressUpdate<Dim> stress_;
  ImplicitStep<Dim> implicit_;
  InitialStress initial_stress_;
  std::vector<SurfaceLoad> loads_;
  ExternalPressure<Dim> outside_;
  PressedParticles<Dim> pressed_;
  ColumnId loaded_stress_;  // normal stresses with the pressure from outside
  ColumnId no_stress_;
  FieldsByBody<Dim> wall_;  // forces of the loads alone: they act on the surface, and not between material and faces
};

}  // namespace sluice
