/// StressTrial: the stresses that displacements of the nodes make, from a state of the particles that is kept, with the
/// update that steps use; and the forces of these stresses on the nodes. docs/theory.md, eqs. (29a), (29c) and (32e).
#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/transfer/cell_averages.h"
#include "physics/materials/stress_update.h"
#include "physics/statics/grid_unknowns.h"

namespace sluice {

enum class Kinematics {
  small,  ///< strain is the symmetric gradient of the displacement; nothing turns, volumes stay
  large   ///< strain and rotation of the middle of the step, forces on the deformed body
};

template <int Dim>
class StressTrial {
 public:
  /// The blocks of the scene are active, and stay so.
  StressTrial(Scene<Dim>& scene, const StressUpdate<Dim>& stress, const Unknowns<Dim>& unknowns, Kinematics kinematics);

  /// The stresses, volumes and state variables that the particles have are those to start from.
  void keep();
  /// Gives them back.
  void restore();

  /// Changes the particles: displacements `u` [m] of the unknowns over `dt` [s], from the kept state. `f`: the forces
  /// that hold the stresses, sum V sigma grad N [N]. False where a particle would invert or a stress is not finite.
  bool apply(std::span<const double> u, double dt, std::span<double> f);

  /// The nodes' velocities, share * `values` of the unknowns, and their changes; `change` may be empty: none.
  void set_motion(std::span<const double> values, double share, std::span<const double> change = {});
  /// The velocities that the nodes have.
  void get_velocity(std::span<double> values);

 private:
  struct Kept {
    double* column;
    std::vector<double> values;
  };
  void strain(double dt);
  void average_dilation();
  bool update(double dt);
  bool deform(const ParticleBlock<Dim>& block, const StrainIncrements<Dim>& increments);
  void set_piola(const ParticleBlock<Dim>& block);
  void collect(int first, int last, std::span<double> f);
  StrainIncrements<Dim> increments(std::size_t first);

  Scene<Dim>& scene_;
  const StressUpdate<Dim>& stress_;
  Kinematics kinematics_;
  std::vector<std::array<int, Dim>> unknown_;  // of each node of each block of nodes; -1: none
  std::vector<Kept> kept_;
  std::vector<Workspace<Dim>> workspaces_;
  std::array<std::vector<double>, symmetric_components<Dim> + spin_components<Dim>> increments_;
  std::array<std::vector<double>, Dim * Dim> gradient_;  // of the deformation, inverse: dX / dx, row by row
  std::array<std::vector<double>, Dim * Dim> piola_;     // sigma (dX / dx)^T, row by row [Pa]
  CellAverages<Dim> cells_;
  std::vector<char> sound_;  // by block
};

extern template class StressTrial<2>;
extern template class StressTrial<3>;

}  // namespace sluice
