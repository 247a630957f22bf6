/// Mohr-Coulomb: linear elasticity, perfect or softening plasticity, flow by a dilation angle, tension cut-off.
/// Equations, parameters and verification: docs/materials/mohr_coulomb.md.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "physics/materials/material.h"
#include "physics/materials/mohr_coulomb_return.h"
#include "physics/materials/softening.h"

namespace sluice {

/// Throws CaseError if angles [rad] and cohesion make no sense together; `what` says before the keys' names whose they
/// are. For every model with these three.
void check_friction(double friction_angle, double cohesion, double dilation_angle, const std::string& what,
                    const Node& section);

/// Keeps one state variable, `equivalent_plastic_strain`.
class MohrCoulomb final : public Material {
 public:
  /// What becomes of the strengths.
  struct Weakening {
    MohrCoulombStrength residual;
    Softening law;
  };

  /// `density` [kg/m3]; the ranges of the parameters stand beside them and are the caller's duty.
  MohrCoulomb(double density, const MohrCoulombParameters& parameters, std::optional<Weakening> weakening = {});

  double density() const override { return density_; }
  std::vector<ColumnSpec> columns() const override;
  IsotropicElasticity elasticity() const override { return elasticity_; }
  bool linear_elasticity() const override { return true; }
  Strength strength() const override { return peak_.sin_friction > 0 ? Strength::frictional : Strength::constant; }
  double stored_energy(std::span<const double> stress) const override { return elasticity_.energy(stress); }
  void set_cell_size(double h) override;
  void update(const MaterialBatch<2>& batch) const override;
  void update(const MaterialBatch<3>& batch) const override;

 private:
  template <int Dim>
  void update_either(const MaterialBatch<Dim>& batch) const;

  double density_;
  IsotropicElasticity elasticity_;
  MohrCoulombStrength peak_;
  double tension_cutoff_;
  MohrCoulombReturn map_;  ///< of the peak strength
  std::optional<Weakening> weakening_;
  double strain_factor_;  ///< equivalent strain over the norm of differences of stress (MC.17)
};

}  // namespace sluice
