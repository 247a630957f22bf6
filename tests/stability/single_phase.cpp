/// Where explicit single-phase schemes lose or gain energy, and what keeps them stable: colliding discs, time steps
/// near the wave limit, blocks that close in on each other. Sources: Sulsky, Chen & Schreyer (1994) for the discs;
/// Bardenhagen (2002) for the energies of USF and USL; Ni & Zhang (2020) for limits below h / c.
#include <array>
#include <cmath>

#include "tests/verification/scene_fixture.h"

namespace sluice {
namespace {

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
  const double start = kinetic_and_elastic_energy(*simulation);
  Collision found;
  while (simulation->time() < 3.6) {
    simulation->advance(3.6);
    found.at_end = kinetic_and_elastic_energy(*simulation) / start;
    found.least = std::min(found.least, found.at_end);
    found.most = std::max(found.most, found.at_end);
  }
  const auto mass = by_id(simulation->particles(), "mass"), v = by_id(simulation->particles(), "velocity");
  const std::size_t half = mass.size() / 2;
  double first = 0, mass_of_first = 0;
  for (std::size_t p = 0; p < half; ++p) first += mass[p] * v[p], mass_of_first += mass[p];
  found.momentum = std::abs(total_momentum(simulation->particles(), 0)) / (mass_of_first * 0.1);
  found.rebound = -first / (mass_of_first * 0.1);
  return found;
}

class Discs : public ::testing::TestWithParam<Scheme> {};

// No scheme gives more energy than there was: 2 % with FLIP and USF, which are neutral and may gain (measured: 1.8 %),
// round-off in the sums of energies else (measured: 1e-3). None loses half (measured: 36 %, cubic B-splines with APIC
// and USL: the contact is as wide as their support). Momentum is round-off, and the discs part.
TEST_P(Discs, BounceOffEachOtherAndGainNothing) {
  const Scheme& scheme = GetParam();
  const Collision c = collide(scheme);
  const bool neutral = scheme.transfer == "flip" && scheme.stress_update == "usf";
  EXPECT_LT(c.most, neutral ? 1.02 : 1.002);
  EXPECT_GT(c.at_end, neutral ? 1 : 0.6);
  EXPECT_GT(c.rebound, 0.75);
  EXPECT_LT(c.momentum, 1e-12);
}

/// Linear functions are left out but with FLIP and USF: nodes at the rims of the discs hold next to nothing (F7).
INSTANTIATE_TEST_SUITE_P(Schemes, Discs, ::testing::ValuesIn([] {
                           auto schemes = all_schemes();
                           std::erase_if(schemes, [](const Scheme& s) {
                             return s.stress_update == "musl" ||
                                    (s.linear() && (s.transfer != "flip" || s.stress_update != "usf"));
                           });
                           return schemes;
                         }()),
                         scheme_name);

// USL takes energy out that USF leaves in, on the same functions with the same transfer.
TEST(CollidingDiscs, LoseMoreWithStressesLast) {
  for (const char* transfer : {"flip", "apic"})
    EXPECT_LT(collide({"quadratic_bspline", transfer, "usl", 1, {}}).at_end,
              collide({"quadratic_bspline", transfer, "usf", 1, {}}).at_end - 0.05);
}

// The negative control: PIC smooths all motion but that of the discs as a whole (measured: 0.60; APIC keeps 0.81).
TEST(CollidingDiscs, LoseTwoFifthsWithPic) {
  EXPECT_LT(collide({"quadratic_bspline", "flip", "usf", 0, {}}).at_end, 0.65);
}

// ---- steps near the wave limit (F12) ----

/// The largest total energy of a bar over the initial one in twenty periods of its first mode. Its points lie off the
/// lattice of the cells by `offset` of a cell at the start, and drift on by one cell.
double largest_energy(const Scheme& scheme, int points_per_cell, double offset, double courant) {
  const auto simulation = simulate(
      {.grid = "{min: [0 m, 0 m], max: [29 m, 1 m], cell: 1 m}",
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
  set_column(particles, "position", 0, [&](const auto& x) { return x[0] + offset; });
  const double start = kinetic_and_elastic_energy(*simulation), end = 20 * 5;
  double most = 0;
  while (simulation->time() < end && most < 100) {
    simulation->advance(end);
    most = std::max(most, kinetic_and_elastic_energy(*simulation) / start);
  }
  return most;
}

constexpr std::array<double, 3> offsets{0.0, 0.3, 0.77};

class WaveLimit : public ::testing::TestWithParam<Scheme> {};

// With the default Courant number 0.5 every scheme of smooth functions is stable however the points lie. The energy at
// the end of steps whose velocities live in their middles swings by omega dt (measured: 1.03 to 1.04 times the start).
TEST_P(WaveLimit, HalfOfItIsStableWhereverPointsLie) {
  for (const int points : {1, 4, 9})
    for (const double offset : offsets) EXPECT_LT(largest_energy(GetParam(), points, offset, 0.5), 1.06) << offset;
}

INSTANTIATE_TEST_SUITE_P(Schemes, WaveLimit, ::testing::ValuesIn([] {
                           auto schemes = all_schemes();
                           std::erase_if(schemes, [](const Scheme& s) { return s.linear(); });
                           return schemes;
                         }()),
                         scheme_name);

/// Whether a bar bursts, or its points leave the grid, for any place of its points.
bool bursts(const Scheme& scheme, double courant) {
  for (const int points : {4, 9})
    for (const double offset : offsets) {
      try {
        if (largest_energy(scheme, points, offset, courant) > 2) return true;
      } catch (const std::exception&) {
        return true;
      }
    }
  return false;
}

// The negative controls: the full limit of the equation is too long for points that lie anywhere, unless stresses come
// first, from velocities that FLIP keeps; and linear functions with APIC do not even bear half of it.
TEST(WaveLimitOfPoints, TheWholeOfItIsTooLong) {
  for (const char* shape : {"ugimp", "quadratic_bspline", "cubic_bspline"}) {
    EXPECT_TRUE(bursts({shape, "flip", "usl", 1, {}}, 1.0)) << shape;
    EXPECT_FALSE(bursts({shape, "flip", "usf", 1, {}}, 1.0)) << shape;
  }
  EXPECT_TRUE(bursts({"linear", "apic", "usf", 1, {}}, 0.5));
}

// ---- two blocks close in on each other (F13) ----

struct Closing {
  double smallest_volume = 1;  ///< of a particle over its volume at the start
  double largest_energy = 0;   ///< over the initial one
  int shortened = 0;           ///< steps that strain or advection limited
};

/// Blocks of 1 m run into each other with half of the wave speed.
Closing close_in(const Scheme& scheme) {
  const double speed = std::sqrt(1e6 / 1000) / 4;
  const auto simulation =
      simulate({.grid = "{min: [-2 m, -2 m], max: [4.2 m, 3 m], cell: 0.1 m}",
                .material = "{model: linear_elastic, density: 1000 kg/m3, youngs_modulus: 1 MPa, poisson_ratio: 0}",
                .bodies = fmt::format(
                    "  - {{material: soil, box: {{min: [0 m, 0 m], max: [1 m, 1 m]}}, velocity: [{0}, 0 m/s]}}\n"
                    "  - {{material: soil, box: {{min: [1.2 m, 0 m], max: [2.2 m, 1 m]}}, velocity: [-{0}, 0 "
                    "m/s]}}",
                    speed),
                .scheme = scheme});
  const double volume = by_id(simulation->particles(), "volume").front(),
               start = kinetic_and_elastic_energy(*simulation);
  Closing found;
  while (simulation->time() < 0.08) {
    const StepInfo step = simulation->advance(0.08);
    found.shortened += step.limiter == "strain" || step.limiter == "advection" ? 1 : 0;
    found.largest_energy = std::max(found.largest_energy, kinetic_and_elastic_energy(*simulation) / start);
    found.smallest_volume =
        std::min(found.smallest_volume, std::ranges::min(by_id(simulation->particles(), "volume")) / volume);
  }
  return found;
}

class ClosingBlocks : public ::testing::TestWithParam<Scheme> {};

// The fronts are pressed together to half of their volume (measured: 0.48 to 0.58) in steps that the strain and the way
// of a particle shorten; nothing inverts, and energy stays within what FLIP with USF gains (measured: 3 %). What a step
// without these limits does is in tests/verification/guards.cpp: it is stopped, and names the inverted particle.
TEST_P(ClosingBlocks, ArePressedAndStayWhole) {
  const Closing c = close_in(GetParam());
  EXPECT_GT(c.smallest_volume, 0.4);
  EXPECT_LT(c.smallest_volume, 0.75);
  EXPECT_LT(c.largest_energy, 1.05);
  EXPECT_GT(c.shortened, 0);
}

INSTANTIATE_TEST_SUITE_P(Schemes, ClosingBlocks, ::testing::ValuesIn([] {
                           auto schemes = all_schemes();
                           std::erase_if(schemes, [](const Scheme& s) { return s.linear(); });
                           return schemes;
                         }()),
                         scheme_name);

}  // namespace
}  // namespace sluice
