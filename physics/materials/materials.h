/// Materials: the constitutive models of a scene, and the stress update of a block of particles.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/case/case.h"
#include "core/simulation/scene.h"
#include "physics/materials/material.h"

namespace sluice {

/// What the stress update of a block found.
struct StressReport {
  double fastest_wave = 0;  ///< see Materials::fastest_wave [m/s]
  bool sound = true;        ///< no particle is inverted and all stresses are finite
};

template <int Dim>
class Materials {
 public:
  /// Reads all materials of the case. Throws CaseError.
  explicit Materials(const Case& definition);

  const Material& operator[](std::size_t i) const { return *materials_[i]; }
  std::size_t size() const { return materials_.size(); }
  Node resolved() const;

  void declare(Columns& particles);
  /// All columns that update_stress changes.
  std::vector<ColumnId> updated(const Particles& particles) const;

  /// Objective stress update of one block, eqs. (22)-(25) of docs/theory.md: rotates the stress with the material
  /// (Jaumann, by the exact rotation of Hughes & Winget 1980), or finds the logarithmic strain of the step (`strain:
  /// hencky`, which overwrites the increments); then applies each material's law to its batch; updates the volumes.
  /// `strain` is indexed from 0 at the block's first particle; `inertia` is the column of the mass [kg] that elastic
  /// waves set in motion, `dt` [s] the time over which the strains came, `time` [s] that of the step.
  StressReport update_stress(Particles& particles, ColumnId inertia, const Blocks<Dim>& blocks,
                             const ParticleBlock<Dim>& block, const StrainIncrements<Dim>& strain, double dt,
                             double time) const;

  /// Elastic energy stored in all particles [J].
  double stored_energy(const Particles& particles) const;
  /// Largest sqrt(M V / inertia) over all particles, plus what explicit viscosity adds (27a) [m/s].
  double fastest_wave(const Particles& particles, ColumnId inertia) const;

 private:
  /// (27a), with the constrained modulus [Pa] and of volume over inertia [m3/kg].
  double wave(const Material& material, double modulus, double specific_volume) const;

  double smallest_cell_;     // [m]
  bool hencky_ = false;      // elasticity in logarithmic strain
  ColumnId initial_volume_;  // with it
  std::vector<std::string> names_;
  std::vector<Node> sections_;
  std::vector<std::unique_ptr<Material>> materials_;
  std::vector<std::vector<ColumnId>> state_;  // declared columns by material …
  std::vector<std::vector<int>> components_;  // … and their components
};

extern template class Materials<2>;
extern template class Materials<3>;

}  // namespace sluice
