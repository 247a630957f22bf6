/// total_stress: a single phase in total stresses, advanced explicitly in time. docs/theory.md, sections 2 to 5.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/simulation/physics_module.h"
#include "core/simulation/stages.h"
#include "core/transfer/cell_averages.h"
#include "physics/initial_stress/initial_stress.h"
#include "physics/materials/materials.h"

namespace sluice {

/// When stresses are updated within a step: first (USF), last (USL), or last with velocities mapped a second time
/// (MUSL). Bardenhagen (2002); Sulsky, Zhou & Schreyer (1995).
enum class StressTiming { usf, usl, musl };

template <int Dim>
class TotalStress final : public PhysicsModule<Dim> {
 public:
  explicit TotalStress(const Case& definition);

  void declare(Columns& particles) override;
  double density(int material) const override;
  void initialise(Scene<Dim>& scene) override;
  std::vector<TimeStepLimit> hard_limits(const Scene<Dim>& scene) const override;
  std::vector<TimeStepLimit> time_step_limits(const Scene<Dim>& scene) const override;
  void step(Scene<Dim>& scene, double dt) override;
  void store(Archive& archive) const override { archive.reals["total_stress"] = {fastest_wave_}; }
  void restore(const Archive& archive) override { fastest_wave_ = archive.reals.at("total_stress").at(0); }
  std::vector<std::pair<std::string, double>> energies(const Scene<Dim>& scene) const override;
  std::vector<std::pair<std::string, Node>> resolved_sections() const override;

 private:
  void step_usf(Scene<Dim>& scene, double dt);
  void step_usl(Scene<Dim>& scene, double dt);
  void step_musl(Scene<Dim>& scene, double dt);

  ScatterWhat momentum_with_force(const Scene<Dim>& scene) const;
  void gather_motion(Scene<Dim>& scene, double dt, ColumnId positions);
  void gather_motion_and_update_stress(Scene<Dim>& scene, double dt);
  void update_stress(Scene<Dim>& scene, double dt, bool then_scatter_force);
  void apply_f_bar(Scene<Dim>& scene, bool then_scatter_force);

  StrainIncrements<Dim> kept_strain(Scene<Dim>& scene, std::uint32_t first);
  void begin_reports(const Scene<Dim>& scene);
  void end_motion_reports(Scene<Dim>& scene);
  void end_stress_reports(const Scene<Dim>& scene);

  Materials<Dim> materials_;
  InitialStress initial_stress_;
  StressTiming timing_;
  bool f_bar_;

  ColumnId next_position_;                      // MUSL: positions change after the stress update
  ColumnId strain_increment_, spin_increment_;  // F-bar: strains wait for the means of the cells
  CellAverages<Dim> cells_;
  std::vector<Workspace<Dim>> workspaces_;
  std::vector<MotionReport> motion_;  // by block
  std::vector<StressReport> stress_;  // by block
  double fastest_wave_ = 0;           // [m/s], of the last stress update
};

}  // namespace sluice
