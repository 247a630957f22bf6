/// What each model gets wrong in a saturated column, from closed forms. docs/advisor.md.
///
/// Two kinds of loading are told apart. One that goes to and fro at a frequency: the harmonic column of physics/exact,
/// errors as root mean squares over the depth. One that comes and stays, over a time: what counts is how much of the
/// pressure the water has lost by then, after Terzaghi, and the inertia of a quarter of a period.
#pragma once

#include <algorithm>
#include <array>

#include "physics/exact/harmonic_column.h"

namespace sluice::advice {

using exact::ColumnModel;
using exact::HarmonicGroups;
using exact::ModelError;

/// From the least that is modelled to the most.
inline constexpr std::array<ColumnModel, 5> models{ColumnModel::drained, ColumnModel::undrained,
                                                   ColumnModel::quasi_static, ColumnModel::u_p, ColumnModel::full};

/// How the load comes: at a frequency, or within a time.
struct Loading {
  double omega = 0;     ///< [1/s]; of a load that comes within a time pi / (2 time)
  double duration = 0;  ///< [s]; 0: harmonic
  bool comes = true;    ///< false: it is there from the start, and may drain for the duration

  static Loading at_frequency(double hertz);
  static Loading within(double seconds);
  static Loading for_a_time(double seconds);
};

/// Errors by index in `models`; 0 for the full model.
struct ColumnErrors {
  HarmonicGroups groups{};
  double time_factor = 0;  ///< T = c_v t / L2 of a load that comes within a time
  std::array<ModelError, models.size()> error{};

  double worst(std::size_t model) const { return std::max(error[model].displacement, error[model].pressure); }
  /// The error is at least that of the other, model by model.
  void take_larger(const ColumnErrors& other);
  /// Index of the first model that is inside the tolerance: the simplest.
  std::size_t simplest(double tolerance) const;
};

ColumnErrors column_errors(const exact::SaturatedSoil& soil, double drainage_length, const Loading& loading);

/// The share of the pressure that has left when a load has been there for the time factor T, and the mean of it over
/// that time.
double drained_share(double T);
double mean_drained_share(double T);

/// The inertia of the mixture plays no part below this Pi2, and in soil that can drain below this Pi2 / (1 - kappa).
inline constexpr double slow = 0.1;

}  // namespace sluice::advice
