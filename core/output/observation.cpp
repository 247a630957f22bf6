#include "core/output/observation.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

namespace sluice {

namespace {
[[noreturn]] void fail(const ObservationCase& observation, const std::string& what) {
  throw CaseError(observation.place,
                  fmt::format("observation '{}': measure '{}' {}", observation.name, observation.measure, what));
}
}  // namespace

Registry<MeasureFactory>& measure_registry() {
  static Registry<MeasureFactory> registry("measure", "measures");
  return registry;
}

std::unique_ptr<Observation> make_observation(const ObservationCase& observation, const Particles& particles,
                                              std::span<const double> cell) {
  return measure_registry().find(observation.measure, observation.place)(observation, particles, cell);
}

void require_direction(const ObservationCase& observation, int dimension) {
  const std::string example = dimension == 2 ? "[-1, 0]" : "[-1, 0, 0]";
  if (observation.direction.empty()) fail(observation, "needs a direction, for example direction: " + example);
  if (static_cast<int>(observation.direction.size()) != dimension)
    fail(observation, fmt::format("needs a direction of {} numbers, for example {}; found {}", dimension, example,
                                  observation.direction.size()));
}

void require_region(const ObservationCase& observation) {
  if (!observation.region) fail(observation, "needs a region: the place at the start of the material that is followed");
}

void refuse_direction(const ObservationCase& observation) {
  if (!observation.direction.empty()) fail(observation, "takes no direction");
}

void refuse_region(const ObservationCase& observation) {
  if (observation.region) fail(observation, "takes no region: it looks at all material");
}

ColumnId require_field(const ObservationCase& observation, const Columns& columns) {
  if (!observation.field) fail(observation, "needs a field, for example field: velocity");
  std::vector<std::string> names;
  for (const ColumnSpec& spec : columns.specs())
    if (spec.output && spec.role == Role::state) names.push_back(spec.name);
  std::sort(names.begin(), names.end());
  if (std::find(names.begin(), names.end(), *observation.field) == names.end())
    fail(observation, fmt::format("finds no field '{}'; there are {}", *observation.field, fmt::join(names, ", ")));
  return columns.find(*observation.field);
}

void refuse_field(const ObservationCase& observation) {
  if (observation.field) fail(observation, "takes no field");
}

}  // namespace sluice
