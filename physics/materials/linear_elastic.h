/// Linear elasticity, isotropic, in rate form. Equations: docs/materials/linear_elastic.md.
#pragma once

#include <span>

#include "physics/materials/material.h"

namespace sluice {

class LinearElastic final : public Material {
 public:
  /// `density` [kg/m3].
  LinearElastic(double density, IsotropicElasticity elasticity) : density_(density), elasticity_(elasticity) {}

  double density() const override { return density_; }
  IsotropicElasticity elasticity() const override { return elasticity_; }
  bool linear_elasticity() const override { return true; }
  Strength strength() const override { return Strength::unlimited; }
  double stored_energy(std::span<const double> stress) const override { return elasticity_.energy(stress); }
  void update(const MaterialBatch<2>& batch) const override;
  void update(const MaterialBatch<3>& batch) const override;

 private:
  double density_;
  IsotropicElasticity elasticity_;
};

}  // namespace sluice
