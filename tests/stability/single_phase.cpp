/// Where explicit single-phase schemes lose or gain energy, and what keeps them stable: colliding discs, time steps
/// near the wave limit, blocks that close in on each other. Sources: Sulsky, Chen & Schreyer (1994) for the discs;
/// Bardenhagen (2002) for the energies of USF and USL; Ni & Zhang (2020) for limits below h / c.
#include <cmath>

#include "tests/verification/scene_fixture.h"

namespace sluice {
namespace {

double total_energy(const Simulation& simulation) {
  double sum = 0;
  for (const auto& [name, value] : simulation.energies())
    if (name == "kinetic" || name == "elastic") sum += value;
  return sum;
}

// ---- two elastic discs collide (F10) ----

struct Collision {
  double least = 1, most = 1, at_end = 1;  ///< total energy over the initial one
  double momentum = 0;                     ///< of both over that of one
  double rebound = 0;                      ///< velocity of a disc at the end over that at the start
};

/// E = 1000 Pa, nu = 0.3, 1000 kg/m3, R = 0.2 m, v = (0.1, 0.1) m/s against (-0.1, -0.1) m/s, cells of 1/20 m.
Collision collide(const Scheme& scheme) {
  const auto simulation = simulate(
      {.grid = "{min: [-0.2 m, -0.2 m], max: [1.2 m, 1.2 m], cell: 0.05 m}",
       .material = "{model: linear_elastic, density: 1000 kg/m3, youngs_modulus: 1000 Pa, poisson_ratio: 0.3}",
       .bodies = "  - {material: soil, circle: {centre: [0.2 m, 0.2 m], radius: 0.2 m}, velocity: [0.1, 0.1 m/s]}\n"
                 "  - {material: soil, circle: {centre: [0.8 m, 0.8 m], radius: 0.2 m}, velocity: [-0.1, -0.1 m/s]}",
       .scheme = scheme});
  const double start = total_energy(*simulation);
  Collision found;
  while (simulation->time() < 3.6) {
    simulation->advance(3.6);
    found.at_end = total_energy(*simulation) / start;
    found.least = std::min(found.least, found.at_end);
    found.most = std::max(found.most, found.at_end);
  }
  const auto mass = by_id(simulation->particles(), "mass"), v = by_id(simulation->particles(), "velocity");
  const std::size_t half = mass.size() / 2;
  double both = 0, first = 0, mass_of_first = 0;
  for (std::size_t p = 0; p < mass.size(); ++p) {
    both += mass[p] * v[p];
    if (p < half) first += mass[p] * v[p], mass_of_first += mass[p];
  }
  found.momentum = std::abs(both) / (mass_of_first * 0.1);
  found.rebound = -first / (mass_of_first * 0.1);
  return found;
}

class Discs : public ::testing::TestWithParam<Scheme> {};

TEST_P(Discs, BounceOffEachOtherAndGainNothing) {
  const Collision c = collide(GetParam());
  RecordProperty("energy", std::to_string(c.at_end));
  std::printf("%s: energy at end %.4f least %.4f most %.4f rebound %.4f momentum %.1e\n", GetParam().name().c_str(), c.at_end, c.least, c.most, c.rebound, c.momentum);
}

INSTANTIATE_TEST_SUITE_P(Schemes, Discs,
                         ::testing::ValuesIn([] {
                           auto schemes = all_schemes();
                           std::erase_if(schemes, [](const Scheme& s) { return s.stress_update == "musl"; });
                           return schemes;
                         }()),
                         scheme_name);

// ---- steps near the wave limit (F12) ----

/// The largest total energy of a bar over the initial one in twenty periods of its first mode. Its points lie off the
/// lattice of the cells by `offset` of a cell.
double largest_energy(const Scheme& scheme, int points_per_cell, double offset, double courant) {
  const auto simulation = simulate(
      {.grid = fmt::format("{{min: [{0} m, 0 m], max: [{1} m, 1 m], cell: 1 m}}", -offset, 28 - offset),
       .material = "{model: linear_elastic, density: 1 kg/m3, youngs_modulus: 100 Pa, poisson_ratio: 0}",
       .bodies = fmt::format("  - {{material: soil, particles_per_cell: {}, box: {{min: [1 m, 0 m], max: [26 m, 1 "
                             "m]}}, velocity: [0.01, 0 m/s]}}",
                             points_per_cell),
       .boundaries = "{bottom: roller, top: roller}",
       .scheme = scheme.with(fmt::format("courant: {}", courant))});
  Particles& particles = simulation->particles();
  constexpr double wave_number = 3.14159265358979 / 25;
  set_column(particles, "velocity", 0, [&](const auto& x) { return 0.1 * std::cos(wave_number * (x[0] - 1)); });
  if (scheme.affine())
    set_column(particles, "affine_velocity", 0,
               [&](const auto& x) { return -0.1 * wave_number * std::sin(wave_number * (x[0] - 1)); });
  const double start = total_energy(*simulation), end = 20 * 5;
  double most = 0;
  while (simulation->time() < end && most < 100) {
    simulation->advance(end);
    most = std::max(most, total_energy(*simulation) / start);
  }
  return most;
}

TEST(WaveLimit, Map) {
  for (const char* shape : {"linear", "ugimp", "quadratic_bspline", "cubic_bspline"})
    for (const char* transfer : {"flip", "apic"})
      for (const char* update : {"usf", "usl"})
        for (const double courant : {0.5, 0.7, 0.9, 1.0}) {
          std::printf("%s %s %s C=%.1f:", shape, transfer, update, courant);
          for (const int points : {1, 4, 9})
            for (const double offset : {0.0, 0.3, 0.77}) {
              double e = -1;
              try { e = largest_energy({shape, transfer, update, 1, {}}, points, offset, courant); } catch (const std::exception& x) { e = -1; }
              std::printf(" %.2f", e);
            }
          std::printf("\n");
        }
}

// ---- two blocks close in on each other (F13) ----

}  // namespace
}  // namespace sluice
