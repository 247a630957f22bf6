/// Material: the interface of constitutive models, and their registry.
///
/// A model updates a batch of material points of one material at a time, over plain columns, so that the compiler can
/// vectorize; the virtual call happens once a batch. Stress: tension positive. Shear strains are tensor components
/// (eps_xy, half of gamma_xy).
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/case/registry.h"
#include "core/particles/particles.h"

namespace sluice {

template <int Dim>
struct MaterialBatch {
  std::size_t size = 0;
  double dt = 0;    ///< time over which the strain increments came [s]; 0 before the first step
  double time = 0;  ///< at the beginning of the step [s]
  /// Strain increment of the step; in 2-D the zz entry is zero.
  std::array<const double*, symmetric_components<Dim>> strain_increment;
  /// In: Cauchy stress [Pa] at the beginning of the step, already rotated with the material (Jaumann). Out: updated.
  std::array<double*, symmetric_components<Dim>> stress;
  /// The columns that the material declared, one pointer a component, in the order of declaration.
  std::span<double* const> state;
};

/// Lame's first parameter and the shear modulus [Pa].
struct IsotropicElasticity {
  double lambda = 0;
  double shear = 0;
  double constrained_modulus() const { return lambda + 2 * shear; }
  double youngs_modulus() const { return shear * (3 * lambda + 2 * shear) / (lambda + shear); }
  double poisson_ratio() const { return lambda / (2 * (lambda + shear)); }
  /// Elastic energy per volume [J/m3] at stress xx yy zz xy (yz xz).
  double energy(std::span<const double> stress) const;
  static IsotropicElasticity from_young(double youngs_modulus, double poisson_ratio);
};

/// What a material can bear.
enum class Strength {
  unlimited,  ///< elastic
  constant,   ///< whatever the mean stress is: then the pore pressure does not matter to it
  frictional  ///< it grows with the (effective) mean stress
};

class Material {
 public:
  virtual ~Material() = default;

  /// Initial mass per volume [kg/m3]; of a porous material, without the water in its pores.
  virtual double density() const = 0;
  /// A liquid: has no skeleton, and its pressure belongs to the physics module.
  virtual bool liquid() const { return false; }
  /// For advice; whatever does not say otherwise is taken for the most demanding.
  virtual Strength strength() const { return Strength::frictional; }
  /// The size of the cells [m], for a law that depends on it. Called once, before the first update.
  virtual void set_cell_size(double /*h*/) {}
  /// State variables that this model keeps on each of its points, beside the stress. They are 0 until the model first
  /// gets the point, at the start or by a change of material: a law that remembers the stress of that moment sets then
  /// what it finds to be 0.
  virtual std::vector<ColumnSpec> columns() const { return {}; }
  /// The tangent at small strain, for the elastic equilibrium and, unless constrained_modulus says otherwise, for the
  /// wave speed.
  virtual IsotropicElasticity elasticity() const = 0;
  /// Its elasticity is linear, isotropic and that of elasticity(), and the law knows strain through it alone: then it
  /// may as well be elasticity in logarithmic strain, of Kirchhoff stress (`scheme.strain: hencky`).
  virtual bool linear_elasticity() const { return false; }
  /// The largest lambda + 2 G [Pa] at the stresses of `size` points, columns xx yy zz xy (yz xz): for a law whose
  /// stiffness depends on its stress.
  virtual double constrained_modulus(std::span<const double* const> /*stress*/, std::size_t /*size*/) const {
    return elasticity().constrained_modulus();
  }
  /// Of stress that follows the rate of strain explicitly, and therefore limits the step [Pa s].
  virtual double viscosity() const { return 0; }
  /// Elastic energy per volume [J/m3] at stress xx yy zz xy (yz xz).
  virtual double stored_energy(std::span<const double> stress) const = 0;

  virtual void update(const MaterialBatch<2>& batch) const = 0;
  virtual void update(const MaterialBatch<3>& batch) const = 0;
};

/// The column that models of plasticity share, and that pictures show.
ColumnSpec equivalent_plastic_strain();

/// Makes a material from its section of the case file (the map under `materials: NAME:`).
using MaterialFactory = std::function<std::unique_ptr<Material>(const Node& section)>;
Registry<MaterialFactory>& material_registry();

/// Reads `model:` of the section and makes that material. Throws CaseError.
std::unique_ptr<Material> make_material(const Node& section);

}  // namespace sluice
