/// What long runs lose: energy, momentum and angular momentum of a disc that turns, water of a closed box. Sources:
/// conservation; the error of strains that are taken at the beginning or at the end of a step and not in its middle
/// (tests/verification/rotating_disc.cpp). docs/stability/drift.md.
#include <regex>

#include "tests/stability/figures.h"
#include "tests/verification/rotating_disc.h"
#include "tests/verification/saturated_column.h"

namespace sluice {
namespace {

// ---- energy, momentum, angular momentum ----

/// B-splines and uGIMP with everything; linear functions with what they bear (F7); and PIC.
std::vector<Scheme> schemes() {
  auto all = all_schemes();
  std::erase_if(all, [](const Scheme& s) { return s.linear() && (s.affine() || s.stress_update == "usl"); });
  all.push_back({"quadratic_bspline", "flip", "usl", 0, {}});
  all.push_back({"quadratic_bspline", "flip", "usl", 0.99, {}});
  return all;
}

std::string name(const Scheme& scheme) {
  return scheme.flip_fraction == 1   ? scheme.name()
         : scheme.flip_fraction == 0 ? scheme.shape + "_pic_" + scheme.stress_update
                                     : scheme.shape + "_flip99_" + scheme.stress_update;
}

class Drift : public ::testing::TestWithParam<Scheme> {};

TEST_P(Drift, OfARotatingDisc) {
  const Scheme& scheme = GetParam();
  const auto simulation = disc::rotating_disc(scheme);
  const Particles& particles = simulation->particles();
  const double energy = kinetic_and_elastic_energy(*simulation), turning = disc::angular_momentum(particles, scheme);
  const auto mass = by_id(particles, "mass");
  const double scale = 2.0 / 3 * disc::radius * disc::spin * sum(mass);  // sum m |v|
  const int turns = figures_folder() != nullptr ? 10 : 1;
  FigureTable table("drift_" + name(scheme), "turns,time_s,steps,energy,momentum,angular_momentum");
  for (int half = 0; half <= 2 * turns; ++half) {
    if (half > 0) simulation->advance_to(half * disc::pi / disc::spin);
    const double moved = std::hypot(total_momentum(particles, 0), total_momentum(particles, 1)) / scale;
    const double now = kinetic_and_elastic_energy(*simulation) / energy;
    const double left = disc::angular_momentum(particles, scheme) / turning;
    table.row(half / 2.0, simulation->time(), simulation->steps(), now, moved, left);
    fmt::print("{} {} E {:.6f} p {:.2e} L {:.8f}\n", name(scheme), half / 2., now, moved, left);
  }
}

INSTANTIATE_TEST_SUITE_P(Schemes, Drift, ::testing::ValuesIn(schemes()), [](const auto& scheme) {
  return std::regex_replace(name(scheme.param), std::regex("\\W"), "_");
});

}  // namespace
}  // namespace sluice
