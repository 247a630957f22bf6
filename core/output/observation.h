/// Observation: a number that is followed during a run. Measures, the kinds of observations, register by name.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>

#include "core/case/case.h"
#include "core/case/registry.h"
#include "core/particles/particles.h"

namespace sluice {

class Observation {
 public:
  virtual ~Observation() = default;
  /// In SI units. Cost of order N. The value does not depend on the number of threads.
  virtual double evaluate(const Particles& particles) const = 0;
  virtual std::string unit() const = 0;
};

/// `particles` may be those of a resumed run: what concerns the start is taken from `initial_position`.
/// `cell` is the cell size per axis [m].
using MeasureFactory = std::function<std::unique_ptr<Observation>(const ObservationCase&, const Particles& particles,
                                                                  std::span<const double> cell)>;
Registry<MeasureFactory>& measure_registry();

/// Throws CaseError where the measure is unknown, or where a direction or region is missing or not wanted.
std::unique_ptr<Observation> make_observation(const ObservationCase& observation, const Particles& particles,
                                              std::span<const double> cell);

/// For the factories of measures: what the case gives must be what the measure takes. A region selects the material
/// that is followed; whoever takes none follows everything. Throws CaseError.
void require_direction(const ObservationCase& observation, int dimension);
void require_region(const ObservationCase& observation);
void refuse_direction(const ObservationCase& observation);
void refuse_region(const ObservationCase& observation);
/// The column that the observation names; it must be one that is written to results.
ColumnId require_field(const ObservationCase& observation, const Columns& columns);
void refuse_field(const ObservationCase& observation);

}  // namespace sluice
