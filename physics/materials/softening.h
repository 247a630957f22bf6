/// Softening: how strengths fall from a peak to a residual value, with plastic strain or in time, shared by the models
/// that soften. Equations SO.x: docs/materials/softening.md.
#pragma once

#include <algorithm>
#include <limits>
#include <optional>
#include <string>

#include "core/case/schema.h"
#include "core/parallel/multitarget.h"

namespace sluice {

/// What every `softening:` section of a material says, whatever the strengths are. Derive and add the residual values.
struct SofteningKeys {
  std::optional<double> strain;           ///< equivalent plastic strain at which the residual strength is reached
  std::optional<double> reference_width;  ///< of the band in which that strain was observed [m]
  std::optional<double> start;            ///< of a fall in time [s]
  double ramp = 0;                        ///< its duration [s]
  Place place;
};

template <class Keys>
Schema<Keys> softening_schema(const std::string& name) {
  return Schema<Keys>(name)
      .quantity("strain", &Keys::strain, unit::none, above(0),
                "Equivalent plastic strain at which the residual strength is reached; over the reference width, if "
                "there is one.",
                {"no softening with strain"})
      .quantity("reference_width", &Keys::reference_width, unit::length, above(0),
                "Width of the shear band in which `strain` was observed: in cells of size h the residual is reached at "
                "strain x reference_width / h, so that what a band dissipates does not depend on h.",
                {"strain holds whatever the cell"})
      .quantity("start", &Keys::start, unit::time, at_least(0),
                "Time from which on the strength falls to the residual, whatever the strain.", {"no softening in time"})
      .quantity("ramp", &Keys::ramp, unit::time, at_least(0), "Duration of that fall; 0: at once.", 0.0);
}

/// What is wrong with the keys beside their ranges. Throws CaseError at their place.
void check_softening(const SofteningKeys& keys);

/// The share of the drop from peak to residual strength that is left (SO.1).
class Softening {
 public:
  Softening() = default;
  explicit Softening(const SofteningKeys& keys);

  /// Scales the strain with reference_width / h (SO.2). `h` [m] is the size of the cells.
  void set_cell_size(double h);

  bool with_strain() const { return inverse_strain_ > 0; }
  /// Share lost per unit of plastic strain; 0 without softening with strain.
  double inverse_strain() const { return inverse_strain_; }
  /// The share that time leaves, for a whole batch.
  double left_at(double time) const;
  /// The share that is left at plastic strain `strain`, at most what time leaves.
  SLUICE_ALWAYS_INLINE double left(double strain, double left_by_time) const {
    const double by_strain = 1 - inverse_strain_ * strain;
    const double lower = by_strain < left_by_time ? by_strain : left_by_time;
    return lower > 0 ? lower : 0;
  }

 private:
  double inverse_strain_ = 0;
  double strain_ = std::numeric_limits<double>::infinity(), reference_width_ = 0;  // 0: not regularised
  double start_ = std::numeric_limits<double>::infinity(), ramp_ = 0;
};

}  // namespace sluice
