/// total_stress: a single phase in total stresses, advanced explicitly in time. docs/theory.md, sections 2 to 5.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/simulation/physics_module.h"
#include "physics/initial_stress/initial_stress.h"
#include "physics/materials/stress_update.h"

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
  void store(Archive& archive) const override { archive.reals["total_stress"] = {stress_.fastest_wave()}; }
  void restore(const Archive& archive) override {
    stress_.restore_fastest_wave(archive.reals.at("total_stress").at(0));
  }
  std::vector<std::pair<std::string, double>> energies(const Scene<Dim>& scene) const override;
  std::vector<std::pair<std::string, Node>> resolved_sections() const override;

 private:
  void step_usf(Scene<Dim>& scene, double dt);
  void step_usl(Scene<Dim>& scene, double dt);
  void step_musl(Scene<Dim>& scene, double dt);
  void scatter_momentum_and_advance(Sweep<Dim>& sweep, Scene<Dim>& scene, double dt);

  StressUpdate<Dim> stress_;
  InitialStress initial_stress_;
};

}  // namespace sluice
