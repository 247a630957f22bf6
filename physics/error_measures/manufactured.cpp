/// Displacements under the body forces of a manufactured solution (physics/exact/manufactured.h).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "physics/error_measures/run_frames.h"
#include "physics/exact/manufactured.h"

namespace sluice {
namespace {

/// The largest over points and frames, over the largest that is exact.
template <int Dim, class Solution>
double largest_error(const RunFrames& frames, const Solution& solution) {
  double largest = 0, scale = 0;
  for (std::size_t i = 1; i < frames.size(); ++i) {
    const RunFrame frame = frames.at(i);
    for (std::size_t p = 0; p < frame.start.size(); ++p) {
      std::array<double, Dim> X;
      for (std::size_t a = 0; a < Dim; ++a) X[a] = frame.start[p][a];
      const auto exact = solution.displacement(X, frame.time);
      double squares = 0, size = 0;
      for (std::size_t a = 0; a < Dim; ++a) {
        squares += std::pow(frame.displacement[p][a] - exact[a], 2);
        size += exact[a] * exact[a];
      }
      largest = std::max(largest, std::sqrt(squares));
      scale = std::max(scale, std::sqrt(size));
    }
  }
  return largest / scale;
}

double error(const chart::FinishedRun& run) {
  const RunFrames frames(run.folder, "");
  const std::string& physics = run.definition.physics;
  if (physics == "manufactured_vortex") return largest_error<2>(frames, exact::Vortex{});
  if (physics == "manufactured_waves")
    return frames.dimension() == 2 ? largest_error<2>(frames, exact::AxisAligned<2>{})
                                   : largest_error<3>(frames, exact::AxisAligned<3>{});
  throw CaseError(
      fmt::format("{}: the error measure `manufactured` is for physics: manufactured_waves and "
                  "manufactured_vortex; found {}",
                  run.definition.file, physics));
}

const bool registered = add_error_measure(
    "manufactured", "Displacements of a manufactured solution: the largest error of all points and frames.", error);

}  // namespace
}  // namespace sluice
