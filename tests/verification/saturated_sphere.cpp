/// Cryer's sphere in three dimensions: a saturated elastic ball, squeezed from all sides and drained at its surface.
/// The pressure in its centre rises above the load before it falls (Mandel-Cryer effect).
#include "core/parallel/parallel.h"
#include "tests/verification/exact/cryer.h"
#include "tests/verification/scene_fixture.h"

namespace sluice {
namespace {

constexpr double nu = 0.25, young = 10e6, load = 10e3, radius = 1;

/// One octant of the sphere; `time` is the length of the run as T = c_v t / a^2.
std::string octant(int cells, double permeability) {
  const double h = radius / cells, extent = (cells + 3) * h;
  return fmt::format(
      "schema: 1\nphysics: two_phase\nend_time: 1000 s\n"
      "grid: {{min: [0 m, 0 m, 0 m], max: [{0}, {0}, {0} m], cell: {1} m}}\n"
      "materials:\n  soil: {{model: linear_elastic, density: 1600 kg/m3, youngs_modulus: {2} Pa, poisson_ratio: {3},\n"
      "         water: {{porosity: 0.4, permeability: {4} m/s, permeability_law: constant}}}}\n"
      "bodies:\n  - {{material: soil, sphere: {{centre: [0, 0, 0 m], radius: {5} m}},\n"
      "     box: {{min: [0, 0, 0 m], max: [{0}, {0}, {0} m]}}}}\n"
      "boundaries: {{left: roller, front: roller, bottom: roller}}\n"
      "surface_loads: [{{pressure: {6} Pa}}]\n"
      "water: {{initial: {{method: uniform, pressure: {6} Pa}}}}\n",
      extent, h, young, nu, permeability, radius, load);
}

/// The largest pressure near the centre over the load, and when that was, as T.
struct Peak {
  double pressure = 0, time = 0, worst = 0;
  std::int64_t steps = 0;
};

Peak peak(int cells, double permeability, double until) {
  const auto simulation = Simulation::create(parse_case(octant(cells, permeability), "sphere.yaml"));
  const double modulus = young * (1 - nu) / ((1 + nu) * (1 - 2 * nu));
  const double rate = permeability * modulus / 9810 / (radius * radius);  // T / t
  const exact::CryerSphere exact(nu);
  Peak found;
  double next = 0;
  while (simulation->time() * rate < until) {
    simulation->advance(1e3);
    // The eight points nearest to the centre, at a quarter of a cell from the planes of symmetry.
    const Particles& particles = simulation->particles();
    const double* const pressure = particles.columns.data(particles.columns.find("pore_pressure"));
    double sum = 0;
    int count = 0;
    for (std::size_t p = 0; p < particles.size(); ++p) {
      double squared = 0;
      for (int a = 0; a < 3; ++a) squared += std::pow(particles.columns.data(particles.initial_position, a)[p], 2);
      if (squared > 3.1 * std::pow(0.25 * radius / cells, 2)) continue;
      sum += pressure[p];
      ++count;
    }
    const double mean = sum / count / load, T = simulation->time() * rate;
    if (mean > found.pressure) found = {mean, T, found.worst, 0};
    if (T > next) {
      fmt::print("   {:3d} cells T {:.4f} p {:.4f} exact {:.4f}\n", cells, T, mean, exact.centre_pressure(T));
      next += 0.02;
    }
    if (T > 0.02) found.worst = std::max(found.worst, std::abs(mean - exact.centre_pressure(T)));
  }
  found.steps = simulation->steps();
  return found;
}

TEST(SaturatedSphere, Explore) {
  set_thread_count(2);
  for (const int cells : {6, 8, 10, 12}) {
    const double k = std::atof(std::getenv("CRYER_K") ? std::getenv("CRYER_K") : "1e-3");
    const Peak found = peak(cells, k, 0.12);
    fmt::print("{:3d} cells: peak {:.4f} at T {:.4f}, worst {:.4f}, {} steps\n", cells, found.pressure, found.time,
               found.worst, found.steps);
  }
  set_thread_count(1);
}

}  // namespace
}  // namespace sluice
