/// A small block of soft soil in even motion, its points exactly where a test wants them: for what happens on the edges
/// of cells (F15).
#pragma once

#include "tests/verification/scene_fixture.h"

namespace sluice {

inline constexpr double soft_modulus = 10e3;  // [Pa]
inline constexpr const char* soft_soil =
    "{model: linear_elastic, density: 1000 kg/m3, youngs_modulus: 10 kPa, poisson_ratio: 0}";

/// A block of 3 x 3 (x 3) points half a cell apart; the first is moved to `corner` (all components alike).
inline std::unique_ptr<Simulation> moving_block(int dimension, const Scheme& scheme, double corner, double velocity) {
  const bool flat = dimension == 2;
  auto simulation = simulate(
      {.grid = flat ? "{min: [0 m, 0 m], max: [16 m, 16 m], cell: 1 m}"
                    : "{min: [0 m, 0 m, 0 m], max: [16 m, 16 m, 16 m], cell: 1 m}",
       .material = soft_soil,
       .bodies = fmt::format(
           "  - {{material: soil, box: {{min: {0}, max: {1}}}, velocity: {2}}}",
           flat ? "[2 m, 2 m]" : "[2 m, 2 m, 2 m]", flat ? "[3.5 m, 3.5 m]" : "[3.5 m, 3.5 m, 3.5 m]",
           flat ? fmt::format("[{0} m/s, {0} m/s]", velocity) : fmt::format("[{0} m/s, {0} m/s, {0} m/s]", velocity)),
       .scheme = scheme});
  for (int a = 0; a < dimension; ++a)
    set_column(simulation->particles(), "position", a,
               [&](const auto& x) { return x[static_cast<std::size_t>(a)] - 2.25 + corner; });
  return simulation;
}

inline double largest_stress(const Particles& particles) {
  double largest = 0;
  for (int c = 0; c < (particles.dimension == 2 ? 4 : 6); ++c)
    largest = std::max(largest, largest_magnitude(by_id(particles, "stress", c)));
  return largest;
}

}  // namespace sluice
