/// A bar along the first axis, fixed at its left end and free at the right one, that gets its weight at once:
/// d'Alembert's waves, as the sum of the modes of a bar (any textbook of vibrations).
#include <cmath>
#include <numbers>

#include "physics/error_measures/run_frames.h"

namespace sluice {
namespace {

/// u(x, t) = g / c^2 [ (L x - x^2 / 2) - sum of 2 sin(b x) cos(b c t) / (b^3 L) ], b = (2 m + 1) pi / (2 L).
double displacement(double x, double t, double length, double speed, double gravity) {
  double u = length * x - x * x / 2;
  for (int m = 0; m < 400; ++m) {
    const double b = (m + 0.5) * std::numbers::pi / length;
    u -= 2 * std::sin(b * x) * std::cos(b * speed * t) / (b * b * b * length);
  }
  return gravity / (speed * speed) * u;
}

double error(const chart::FinishedRun& run) {
  const auto material = only_material(run.definition);
  const double speed = std::sqrt(material->elasticity().constrained_modulus() / material->density());
  const double length = extent(run.definition, 0), gravity = run.definition.gravity.at(0);
  const double left = run.definition.bodies.front().region.bounds(run.definition.dimension())[0][0];
  const RunFrames frames(run.folder, "");
  chart::RelativeRms rms;
  for (std::size_t i = 1; i < frames.size(); ++i) {
    const RunFrame frame = frames.at(i);
    for (std::size_t p = 0; p < frame.start.size(); ++p) {
      const double exact = displacement(frame.start[p][0] - left, frame.time, length, speed, gravity);
      rms.add(frame.displacement[p][0] - exact, exact);
    }
  }
  return rms.value();
}

const bool registered = add_error_measure(
    "vibrating_bar",
    "Displacements of a bar that gets its weight at once, root mean square over points and frames, against the sum of "
    "its modes.",
    error);

}  // namespace
}  // namespace sluice
