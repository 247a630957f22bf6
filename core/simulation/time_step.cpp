#include "core/simulation/time_step.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace sluice {

namespace {
constexpr double unlimited = std::numeric_limits<double>::infinity();
constexpr double largest_growth = 1.1;  // a step may exceed the one before by this factor
}  // namespace

template <int Dim>
std::vector<TimeStepLimit> explicit_limits(const Scene<Dim>& scene, double fastest_wave, const SafetyFactors& factors) {
  const double h = scene.grid.smallest_cell(), speed = std::sqrt(scene.motion.largest_speed_squared);
  const double rate = scene.motion.largest_strain_rate;
  return {{factors.courant * h / (fastest_wave + speed), "wave"},
          {speed > 0 ? factors.advection * h / speed : unlimited, "advection"},
          {rate > 0 ? factors.strain_per_step / rate : unlimited, "strain"}};
}

TimeStepLimit smallest(const std::vector<TimeStepLimit>& limits) {
  return *std::min_element(limits.begin(), limits.end(),
                           [](const TimeStepLimit& a, const TimeStepLimit& b) { return a.seconds < b.seconds; });
}

namespace {

template <int Dim>
TimeStepLimit fixed_step(const PhysicsModule<Dim>& module, const Scene<Dim>& scene) {
  const double dt = *scene.scheme.fixed_time_step;
  const TimeStepLimit limit = smallest(module.hard_limits(scene));
  if (dt > limit.seconds)
    throw CaseError(
        scene.scheme.time_step_place,
        fmt::format("scheme.time_step of {:g} s exceeds the {} limit of {:.4g} s at time {:g} s (step {}); take a "
                    "smaller one, or `time_step: computed`",
                    dt, limit.name, limit.seconds, scene.time, scene.step));
  return {dt, "fixed"};
}

}  // namespace

template <int Dim>
TimeStepLimit choose_time_step(const PhysicsModule<Dim>& module, const Scene<Dim>& scene, double until) {
  const bool fixed = scene.scheme.fixed_time_step.has_value();
  TimeStepLimit limit = fixed ? fixed_step(module, scene) : smallest(module.time_step_limits(scene));
  if (!fixed && scene.previous_dt > 0 && limit.seconds > largest_growth * scene.previous_dt)
    limit = {largest_growth * scene.previous_dt, "growth"};
  const double left = until - scene.time;
  const double steps = left / limit.seconds;
  // A fixed step is kept to the last digit; only a true remainder is cut.
  if (fixed && steps > 1 - 1e-6) return limit;
  if (steps > 10) return limit;
  const double whole = std::max(1.0, std::ceil(steps - 1e-6));
  const double dt = left / whole;
  return {dt, dt < 0.5 * limit.seconds ? "output" : limit.name};
}

#define SLUICE_INSTANTIATE(Dim)                                                                              \
  template std::vector<TimeStepLimit> explicit_limits<Dim>(const Scene<Dim>&, double, const SafetyFactors&); \
  template TimeStepLimit choose_time_step<Dim>(const PhysicsModule<Dim>&, const Scene<Dim>&, double);
SLUICE_INSTANTIATE(2)
SLUICE_INSTANTIATE(3)
#undef SLUICE_INSTANTIATE

}  // namespace sluice
