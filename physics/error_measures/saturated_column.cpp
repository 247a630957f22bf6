/// Pore pressures in a column of saturated elastic soil, drained at its top and loaded there at once.
#include <algorithm>
#include <cmath>
#include <functional>

#include "physics/error_measures/run_frames.h"
#include "physics/exact/telegraph_column.h"
#include "physics/exact/terzaghi.h"
#include "physics/two_phase/water.h"

namespace sluice {
namespace {

using Pressure = std::function<double(double height, double time)>;

/// The largest over the frames of the root mean square over the points, over the load.
double largest_rms(const chart::FinishedRun& run, double load, const Pressure& exact) {
  const Case& definition = run.definition;
  const auto up = static_cast<std::size_t>(definition.dimension() - 1);
  const double base = definition.bodies.front().region.bounds(definition.dimension())[0][up];
  const RunFrames frames(run.folder, "pore_pressure");
  double largest = 0;
  for (std::size_t i = 1; i < frames.size(); ++i) {
    const RunFrame frame = frames.at(i);
    double squares = 0;
    for (std::size_t p = 0; p < frame.start.size(); ++p)
      squares += std::pow(frame.field[p] - exact(frame.start[p][up] - base, frame.time), 2);
    largest = std::max(largest, std::sqrt(squares / static_cast<double>(frame.start.size())) / load);
  }
  return largest;
}

double against_terzaghi(const chart::FinishedRun& run) {
  const double load = load_of(run.definition);
  const exact::ConsolidatingLayer layer{.soil = saturated_soil_of(run.definition),
                                        .height = extent(run.definition, run.definition.dimension() - 1),
                                        .load = load};
  return largest_rms(run, load, [&](double z, double t) { return layer.pressure(z, t); });
}

double against_telegraph(const chart::FinishedRun& run) {
  const double load = load_of(run.definition);
  const auto inertia = read_water(run.definition).formulation == Formulation::u_p ? exact::WaterInertia::of_grains
                                                                                  : exact::WaterInertia::own;
  const exact::TelegraphColumn column{saturated_soil_of(run.definition),
                                      extent(run.definition, run.definition.dimension() - 1), load, inertia};
  return largest_rms(run, load, [&](double z, double t) { return column.at(z, t).pressure; });
}

/// Largest |p / p_exact - 1| in the last frame below the topmost cell: no water has left by then, and the pressure is
/// the load times Q / (M + Q).
double overshoot(const chart::FinishedRun& run) {
  const Case& definition = run.definition;
  const int up = definition.dimension() - 1;
  const auto axis = static_cast<std::size_t>(up);
  const auto bounds = definition.bodies.front().region.bounds(up + 1);
  const double exact = load_of(definition) * saturated_soil_of(definition).undrained_ratio();
  const RunFrames frames(run.folder, "pore_pressure");
  const RunFrame frame = frames.at(frames.size() - 1);
  double largest = 0;
  for (std::size_t p = 0; p < frame.start.size(); ++p)
    if (frame.start[p][axis] < bounds[1][axis] - definition.grid.cell[axis])
      largest = std::max(largest, std::abs(frame.field[p] / exact - 1));
  return largest;
}

const bool registered =
    add_error_measure("terzaghi",
                      "Pore pressure of a consolidating column over the load: the largest of all frames of the root "
                      "mean square over the points. Without inertia.",
                      against_terzaghi) &&
    add_error_measure("telegraph_column", "The same with the inertia of soil and water; the water is incompressible.",
                      against_telegraph) &&
    add_error_measure("undrained_column",
                      "Pore pressure of a column that cannot drain: the largest relative error at the end, below the "
                      "topmost cell.",
                      overshoot);

}  // namespace
}  // namespace sluice
