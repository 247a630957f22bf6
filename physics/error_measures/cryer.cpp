/// Cryer's sphere: saturated, elastic, under a pressure from all sides, drained at its surface (physics/exact/cryer.h).
#include <cmath>

#include "physics/error_measures/run_frames.h"
#include "physics/exact/cryer.h"

namespace sluice {
namespace {

double radius_of(const Case& definition) {
  for (const Primitive& part : definition.bodies.front().region.parts)
    if (const auto* const sphere = std::get_if<Sphere>(&part)) return sphere->radius;
  throw CaseError(definition.bodies.front().place, "the error measure `cryer` needs a body with a sphere");
}

/// Pore pressure within a quarter of the radius from the centre, over the load: root mean square over points and
/// frames.
double error(const chart::FinishedRun& run) {
  const Case& definition = run.definition;
  const auto elasticity = only_material(definition)->elasticity();
  const exact::CryerSphere sphere(elasticity.poisson_ratio());
  const double radius = radius_of(definition), load = load_of(definition);
  const double rate = saturated_soil_of(definition).consolidation_coefficient() / (radius * radius);
  const RunFrames frames(run.folder, "pore_pressure");
  double squares = 0, count = 0;
  for (std::size_t i = 1; i < frames.size(); ++i) {
    const RunFrame frame = frames.at(i);
    for (std::size_t p = 0; p < frame.start.size(); ++p) {
      const double r = std::hypot(frame.start[p][0], frame.start[p][1], frame.start[p][2]) / radius;
      if (r > 0.25) continue;
      squares += std::pow(frame.field[p] / load - sphere.pressure(r, rate * frame.time), 2);
      ++count;
    }
  }
  return std::sqrt(squares / count);
}

const bool registered = add_error_measure(
    "cryer",
    "Pore pressure in the core of Cryer's sphere, which is centred at the origin, over the load: root mean square over "
    "points and frames.",
    error);

}  // namespace
}  // namespace sluice
