#include "physics/advice/column.h"

#include <algorithm>
#include <numbers>

#include "physics/exact/terzaghi.h"

namespace sluice::advice {

Loading Loading::at_frequency(double hertz) { return {2 * std::numbers::pi * hertz, 0}; }
Loading Loading::within(double seconds) { return {std::numbers::pi / (2 * seconds), seconds}; }
Loading Loading::for_a_time(double seconds) { return {std::numbers::pi / (2 * seconds), seconds, false}; }

void ColumnErrors::take_larger(const ColumnErrors& other) {
  for (std::size_t m = 0; m < models.size(); ++m) {
    error[m].displacement = std::max(error[m].displacement, other.error[m].displacement);
    error[m].pressure = std::max(error[m].pressure, other.error[m].pressure);
  }
}

std::size_t ColumnErrors::simplest(double tolerance) const {
  std::size_t m = 0;
  while (m + 1 < models.size() && worst(m) >= tolerance) ++m;
  return m;
}

double drained_share(double T) {
  // The series needs many terms where the half-space is exact to the last digits.
  return T < 1e-3 ? std::sqrt(4 * T / std::numbers::pi) : exact::terzaghi_consolidation(T);
}

double mean_drained_share(double T) {
  if (T < 1e-3) return 2.0 / 3 * drained_share(T);
  // (1/T) int_0^T (1 - sum 2/k2 exp(-k2 t)) dt = 1 - (1/T) (1/3 - sum 2/k4 exp(-k2 T)), with sum 2/k4 = 1/3.
  const double left = exact::sum_consolidation_series(T, [](double k, double) { return 2 / (k * k * k * k); });
  return 1 - (1.0 / 3 - left) / T;
}

ColumnErrors column_errors(const exact::SaturatedSoil& soil, double drainage_length, const Loading& loading) {
  ColumnErrors found;
  found.groups = exact::harmonic_groups(soil, drainage_length, loading.omega);
  for (std::size_t m = 0; m + 1 < models.size(); ++m) found.error[m] = exact::model_error(models[m], found.groups);
  if (loading.duration == 0) return found;
  found.time_factor = soil.consolidation_coefficient() * loading.duration / (drainage_length * drainage_length);
  // What is there from the start sets nothing in motion.
  if (!loading.comes) found.error[2] = found.error[3] = {0, 0};
  // Of a load that stays, the skin that has drained is small beside the whole; a root mean square over the depth of
  // the difference would make much of it. Where waves matter the harmonic errors stand.
  if (loading.comes && found.groups.pi_2() > slow) return found;
  const double lost = drained_share(found.time_factor);
  found.error[1] = {lost, lost};
  const double kept = 1 - mean_drained_share(found.time_factor);
  if (!loading.comes || found.groups.inertia < slow) found.error[0] = {kept, kept};
  return found;
}

}  // namespace sluice::advice
