/// Undrained shear strength: constant or a share of the overburden, with sensitivity. What von_mises and tresca share.
/// Equations US.x: docs/materials/von_mises.md.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "physics/materials/chunk.h"
#include "physics/materials/softening.h"

namespace sluice {

struct SensitivityKeys : SofteningKeys {
  double sensitivity = 1;
};

/// The keys of a material with undrained strength.
struct UndrainedKeys {
  double density = 0, youngs_modulus = 0, poisson_ratio = 0;
  std::optional<double> strength, strength_ratio, minimum_strength, tension_cutoff;
  std::optional<SensitivityKeys> softening;
};

/// `name` is the model's.
Schema<UndrainedKeys> undrained_schema(const std::string& name);

/// The strength of a point, for loops over lanes. State: the equivalent plastic strain, and the overburden if it is
/// `Tied` to that.
template <bool Tied>
struct UndrainedStrength {
  static constexpr int states = Tied ? 2 : 1;
  double constant, ratio, minimum;  ///< [Pa], of the peak
  double residual_share;            ///< of the peak
  Softening softening;
  double left_by_time;

  /// Of the peak [Pa] (US.1).
  template <int Dim>
  SLUICE_ALWAYS_INLINE double peak(const Chunk<Dim, states>& chunk, int lane) const {
    if constexpr (!Tied) return constant;
    const double tied = ratio * chunk.state[1][lane];
    return tied > minimum ? tied : minimum;
  }
  /// At the plastic strain that the point has [Pa] (SO.1).
  template <int Dim>
  SLUICE_ALWAYS_INLINE double present(const Chunk<Dim, states>& chunk, int lane) const {
    const double left = softening.left(chunk.state[0][lane], left_by_time);
    return peak<Dim>(chunk, lane) * (residual_share + left * (1 - residual_share));
  }
};

/// A material with undrained strength, but for the surface of yield.
class UndrainedMaterial : public Material {
 public:
  /// Throws CaseError if the keys contradict each other.
  UndrainedMaterial(const UndrainedKeys& keys, const Node& section);

  double density() const override { return keys_.density; }
  std::vector<ColumnSpec> columns() const override;
  IsotropicElasticity elasticity() const override { return elasticity_; }
  bool linear_elasticity() const override { return true; }
  Strength strength() const override { return Strength::constant; }
  double stored_energy(std::span<const double> stress) const override { return elasticity_.energy(stress); }
  /// Throws CaseError if the softening would be steeper than elastic unloading.
  void set_cell_size(double h) override;

 protected:
  /// Calls update(strength at the time of the batch), the strength of the kind that the keys ask for; points that come
  /// for the first time have remembered their overburden by then.
  template <int Dim, class Update>
  void with_strength(const MaterialBatch<Dim>& batch, const Update& update) const {
    if (tied()) {
      remember_overburden(batch);
      update(strength_at<true>(batch.time));
    } else {
      update(strength_at<false>(batch.time));
    }
  }

  UndrainedKeys keys_;
  IsotropicElasticity elasticity_;
  double residual_share_ = 1;
  Softening softening_;

 private:
  bool tied() const { return keys_.strength_ratio.has_value(); }
  template <bool Tied>
  UndrainedStrength<Tied> strength_at(double time) const {
    return {keys_.strength.value_or(0),
            keys_.strength_ratio.value_or(0),
            keys_.minimum_strength.value_or(0),
            residual_share_,
            softening_,
            softening_.left_at(time)};
  }
  /// Remembers the overburden of points that come for the first time: the compression along the last axis, which is the
  /// vertical one.
  template <int Dim>
  static void remember_overburden(const MaterialBatch<Dim>& batch);
};

}  // namespace sluice
