/// StressUpdate: strain from the velocities of nodes, F-bar, and the constitutive models: the solid part of a step,
/// which every physics module shares. docs/theory.md, sections 4 and 5.
#pragma once

#include <functional>
#include <vector>

#include "core/simulation/stages.h"
#include "core/simulation/sweep.h"
#include "core/simulation/velocity_filter.h"
#include "core/transfer/cell_averages.h"
#include "physics/materials/materials.h"

namespace sluice {

/// When stresses are updated within a step: first (USF), last (USL), or last with velocities mapped a second time
/// (MUSL). Bardenhagen (2002); Sulsky, Zhou & Schreyer (1995).
enum class StressTiming { usf, usl, musl };

template <int Dim>
class StressUpdate {
 public:
  /// Called in parallel, with the number of a block and working memory, after the stresses of that block have changed
  /// and while its particles are in the cache.
  using AfterBlock = std::function<void(std::size_t, const ParticleBlock<Dim>&, Workspace<Dim>&)>;

  /// Reads all materials of the case. Throws CaseError.
  explicit StressUpdate(const Case& definition);

  const Materials<Dim>& materials() const { return materials_; }
  StressTiming timing() const { return timing_; }
  bool f_bar() const { return f_bar_; }
  /// As declared.
  ColumnId inertia() const { return inertia_; }

  /// `inertia` is the column whose mass [kg] the elastic waves set in motion.
  void declare(Columns& particles, ColumnId inertia);
  void initialise(const Scene<Dim>& scene) { fastest_wave_ = materials_.fastest_wave(scene.particles, inertia_); }

  /// Materials::fastest_wave of the last update [m/s].
  double fastest_wave() const { return fastest_wave_; }
  void restore_fastest_wave(double speed) { fastest_wave_ = speed; }

  /// To be called before the first and after the last stage of a step. The latter sums what the blocks report, in their
  /// order, into the scene; it throws PhysicsError if a particle has gone bad.
  void begin_step(const Scene<Dim>& scene);
  void end_step(Scene<Dim>& scene);

  // Each of the following adds its stages to a sweep, or makes a sweep of its own.

  /// Strains over `dt` [s] from the velocities that the nodes have, then stresses.
  void update(Sweep<Dim>& sweep, Scene<Dim>& scene, double dt, const AfterBlock& after_block = {});
  void update(Scene<Dim>& scene, double dt, const AfterBlock& after_block = {}) {
    run_alone(scene, [&](Sweep<Dim>& sweep) { update(sweep, scene, dt, after_block); });
  }
  /// Velocities and positions from the nodes.
  void gather_motion(Sweep<Dim>& sweep, Scene<Dim>& scene, double dt);
  void gather_motion(Scene<Dim>& scene, double dt) {
    run_alone(scene, [&](Sweep<Dim>& sweep) { gather_motion(sweep, scene, dt); });
  }
  /// The same, and stresses from the strains of that motion (USL).
  void gather_motion_and_update(Sweep<Dim>& sweep, Scene<Dim>& scene, double dt);
  void gather_motion_and_update(Scene<Dim>& scene, double dt) {
    run_alone(scene, [&](Sweep<Dim>& sweep) { gather_motion_and_update(sweep, scene, dt); });
  }
  /// The same, but the strains are those of the particles' new velocities, mapped to the nodes once more (MUSL).
  void gather_motion_and_map_again(Sweep<Dim>& sweep, Scene<Dim>& scene, double dt);
  void gather_motion_and_map_again(Scene<Dim>& scene, double dt) {
    run_alone(scene, [&](Sweep<Dim>& sweep) { gather_motion_and_map_again(sweep, scene, dt); });
  }

  /// Working memory by thread, which other stages of the module may use.
  std::vector<Workspace<Dim>>& workspaces() { return workspaces_; }

 private:
  template <class Add>
  static void run_alone(const Scene<Dim>& scene, const Add& add) {
    Sweep<Dim> sweep(scene.blocks);
    add(sweep);
    sweep.run();
  }
  void move(Scene<Dim>& scene, double dt, ColumnId positions, ColumnId domains, Items some);
  void move_and_strain(Scene<Dim>& scene, double dt, Items some);
  void strain(Scene<Dim>& scene, double dt, const AfterBlock& after_block, Items some);
  void apply_f_bar(Scene<Dim>& scene, double dt, const AfterBlock& after_block, Items some);
  void locate_in_cells(const Scene<Dim>& scene, const ParticleBlock<Dim>& block);
  void add_to_cells(Scene<Dim>& scene, std::size_t number, const ParticleBlock<Dim>& block, Workspace<Dim>& work);
  void take_next_position(Scene<Dim>& scene, Items some);
  StressReport update_block(Scene<Dim>& scene, const ParticleBlock<Dim>& block, const StrainIncrements<Dim>& strain,
                            double dt);
  StrainIncrements<Dim> kept_strain(Scene<Dim>& scene, std::uint32_t first);

  Materials<Dim> materials_;
  StressTiming timing_;
  bool f_bar_;

  ColumnId inertia_;
  ColumnId next_position_, next_domain_;        // MUSL: positions change after the stress update
  ColumnId strain_increment_, spin_increment_;  // F-bar: strains wait for the means of the cells
  std::vector<CellAverages<Dim>> cells_;        // of each body
  VelocityFilter<Dim> filter_;
  std::vector<Workspace<Dim>> workspaces_;
  std::vector<MotionReport> motion_;  // by block
  std::vector<StressReport> stress_;  // by block
  double fastest_wave_ = 0;           // [m/s]
};

extern template class StressUpdate<2>;
extern template class StressUpdate<3>;

}  // namespace sluice
