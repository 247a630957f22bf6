/// two_phase: soil with water in its pores, and water beside it. Effective stresses in the skeleton, explicit in time;
/// the pressure of the water by a semi-implicit projection. docs/theory.md, section 9.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/simulation/time_step.h"
#include "physics/initial_stress/initial_stress.h"
#include "physics/loads/external_pressure.h"
#include "physics/materials/stress_update.h"
#include "physics/two_phase/obstacle_water.h"
#include "physics/two_phase/pore_water.h"
#include "physics/two_phase/pressure_equation.h"
#include "physics/two_phase/relative_motion.h"
#include "physics/two_phase/thin_films.h"
#include "physics/two_phase/water.h"

namespace sluice {

template <int Dim>
class TwoPhase final : public PhysicsModule<Dim> {
 public:
  explicit TwoPhase(const Case& definition);

  void declare(Particles& particles) override;
  double density(int material) const override;
  void initialise(Scene<Dim>& scene) override;
  void materials_changed(const Scene<Dim>& scene) override { stress_.initialise(scene); }
  std::vector<TimeStepLimit> hard_limits(const Scene<Dim>& scene) const override;
  std::vector<TimeStepLimit> time_step_limits(const Scene<Dim>& scene) const override;
  void step(Scene<Dim>& scene, double dt) override;
  void store(Archive& archive) const override;
  void restore(const Archive& archive) override;
  std::vector<std::pair<std::string, double>> energies(const Scene<Dim>& scene) const override;
  std::vector<std::pair<std::string, double>> step_numbers() const override;
  std::vector<std::pair<std::string, double>> totals() const override;
  std::vector<std::pair<std::string, Node>> resolved_sections() const override;

 private:
  void start_seepage(Scene<Dim>& scene);
  void check_changes(const Case& definition) const;
  void check_contact(const Case& definition) const;
  void step_projected(Scene<Dim>& scene, double dt);
  void step_explicit(Scene<Dim>& scene, double dt);
  void predict(Sweep<Dim>& sweep, Scene<Dim>& scene, double kick);
  void collect(Sweep<Dim>& sweep, Scene<Dim>& scene, double kick);
  void correct(Sweep<Dim>& sweep, Scene<Dim>& scene, double kick);
  void join_films(Scene<Dim>& scene);
  void gather(Sweep<Dim>& sweep, Scene<Dim>& scene, double dt);
  void begin_sums(const Scene<Dim>& scene);
  void end_sums(double kick);

  std::vector<TimeStepLimit> limits(const Scene<Dim>& scene, const SafetyFactors& factors) const;

  WaterCase water_;
  InitialStress initial_stress_;
  std::vector<SurfaceLoad> loads_;
  StressUpdate<Dim> stress_;
  PoreWater<Dim> pores_;
  ObstacleWater<Dim> at_obstacles_;
  RelativeMotion<Dim> relative_;
  ExternalPressure<Dim> outside_;
  PressureEquation<Dim> pressure_;
  ThinFilms<Dim> films_;
  FieldsByBody<Dim> wall_;           // forces of the pressure alone, which presses on surfaces without friction
  std::vector<double> dissipation_;  // by block, in a step: power of the flow through the pores [W]
  double dissipated_ = 0;            // [J], since the start
  double discharge_ = 0;             // of the steady seepage at the start [m3/s]
  bool placed_ = false;              // the pressure equation knows the blocks
};

}  // namespace sluice
