/// Columns of saturated soil between smooth walls, on a smooth impermeable base, drained at the top unless a test says
/// otherwise: what most tests of `two_phase` run, and how far the pressure is from an exact one.
#pragma once

#include <functional>
#include <limits>

#include "physics/exact/saturated_soil.h"
#include "tests/verification/scene_fixture.h"

namespace sluice {

/// n = 0.4, rho_s = 2650, E = 10 MPa, nu = 0.3: M = 13.46 MPa, the soil of docs/exact_solutions.md.
inline exact::SaturatedSoil sand(double conductivity) {
  exact::SaturatedSoil soil;
  soil.modulus = exact::constrained_modulus(1e7, 0.3);
  soil.conductivity = conductivity;
  return soil;
}

struct SaturatedColumn {
  exact::SaturatedSoil soil = sand(1e-3);
  int dimension = 2;
  int cells = 40;            ///< over the height
  double height = 1;         ///< [m]
  std::string load = "";     ///< pressure on the top: a value, or points in time
  std::string initial = "";  ///< section water.initial
  std::string faces = "";    ///< section water.faces
  std::string formulation = "u-p";
  std::string water = "";  ///< further keys of the section, each ending with a comma
  std::string gravity = "";
  std::string initial_stress = "";
  std::string permeability = "";  ///< instead of the soil's, constant
  Scheme scheme = {};
  double room = 2;  ///< cells above the column
  double base = 0;  ///< cells below it; then nothing holds it

  double cell() const { return height / cells; }
  /// The Poisson ratio is 0.3.
  double youngs_modulus() const { return soil.modulus * 1.3 * 0.4 / 0.7; }

  std::string point(double side, double up) const {
    return dimension == 2 ? fmt::format("[{} m, {} m]", side, up) : fmt::format("[{0} m, {0} m, {1} m]", side, up);
  }

  SceneText scene() const {
    const double h = cell(), n = soil.porosity;
    const std::string zero = point(0, 0);
    SceneText text{
        .grid = fmt::format("{{min: {}, max: {}, cell: {} m}}", zero, point(h, height + (base + room) * h), h),
        .material =
            fmt::format("{{model: linear_elastic, density: {} kg/m3, youngs_modulus: {} Pa, poisson_ratio: 0.3, "
                        "water: {{porosity: {}, permeability: {}, permeability_law: constant}}}}",
                        (1 - n) * soil.solid_density, youngs_modulus(), n,
                        permeability.empty() ? fmt::format("{} m/s", soil.conductivity) : permeability),
        .bodies = fmt::format("  - {{material: soil, box: {{min: {}, max: {}}}}}", point(0, base * h),
                              point(h, height + base * h)),
        .gravity = gravity,
        .boundaries = fmt::format("{{{}left: roller, right: roller{}}}", base > 0 ? "" : "bottom: roller, ",
                                  dimension == 3 ? ", front: roller, back: roller" : ""),
        .initial_stress = initial_stress,
        .scheme = scheme,
        .physics = "two_phase"};
    text.more = fmt::format("water: {{formulation: {}, {}{}{}density: {} kg/m3}}\n", formulation, water,
                            initial.empty() ? "" : fmt::format("initial: {}, ", initial),
                            faces.empty() ? "" : fmt::format("faces: {}, ", faces), soil.water_density);
    if (std::isfinite(soil.water_bulk_modulus))
      text.more.insert(text.more.find("density:"), fmt::format("bulk_modulus: {} Pa, ", soil.water_bulk_modulus));
    if (!load.empty()) text.more += fmt::format("surface_loads: [{{pressure: {}}}]\n", load);
    return text;
  }
};

inline std::unique_ptr<Simulation> simulate(const SaturatedColumn& column) { return simulate(column.scene()); }

inline int up(const Particles& particles) { return particles.dimension - 1; }
inline std::vector<double> heights(const Particles& particles) { return by_id(particles, "position", up(particles)); }

/// Root of the mean square of the pressure less exact(height), over all particles at their initial heights.
inline double pressure_error(const Particles& particles, const std::vector<double>& height,
                             const std::function<double(double)>& exact) {
  const auto p = by_id(particles, "pore_pressure");
  double sum = 0;
  for (std::size_t i = 0; i < p.size(); ++i) sum += std::pow(p[i] - exact(height[i]), 2);
  return std::sqrt(sum / static_cast<double>(p.size()));
}

}  // namespace sluice
