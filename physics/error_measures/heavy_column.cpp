/// A column of elastic soil between smooth walls, compacted by its own weight: the vertical stress is the weight above,
/// whatever the law. Coombs, Augarde et al. (2020), AMPLE, Adv. Eng. Softw. 139, 102748, section on the compacted
/// column.
#include <cmath>

#include "physics/error_measures/run_frames.h"

namespace sluice {
namespace {

/// Sum over points of |sigma_yy - exact| over the stress at the base, in the last frame; points of equal mass.
double error(const chart::FinishedRun& run) {
  const Case& definition = run.definition;
  const int up = definition.dimension() - 1;
  const auto axis = static_cast<std::size_t>(up);
  const double height = extent(definition, up), base = definition.bodies.front().region.bounds(up + 1)[0][axis];
  const double weight = -only_material(definition)->density() * definition.gravity.at(axis);
  const RunFrames frames(run.folder, "stress");
  const RunFrame frame = frames.at(frames.size() - 1);
  const std::size_t n = frame.start.size(), components = frame.field.size() / n;
  double sum = 0;
  for (std::size_t p = 0; p < n; ++p) {
    const double exact = -weight * (base + height - frame.start[p][axis]);
    sum += std::abs(frame.field[components * p + axis] - exact);
  }
  return sum / static_cast<double>(n) / (weight * height);
}

const bool registered = add_error_measure(
    "heavy_column",
    "Vertical stress in a column under its own weight at the end: mean error over the stress at the base.", error);

}  // namespace
}  // namespace sluice
