/// F22: a symmetric column of Mohr-Coulomb soil collapses symmetrically. The equations know no left or right; sums over
/// particles do, for mirror images are added in mirrored order. What is left is round-off and its growth: races, or
/// one-sided cells and faces, would show as differences of the size of the motion itself.
#include <map>

#include "core/simulation/parallel.h"
#include "tests/verification/scene_fixture.h"

namespace sluice {
namespace {

std::unique_ptr<Simulation> column(int dimension, const Scheme& scheme) {
  const bool flat = dimension == 2;
  return simulate({.grid = flat ? "{min: [-8 m, 0 m], max: [8 m, 6 m], cell: 0.5 m}"
                                : "{min: [-4 m, -4 m, 0 m], max: [4 m, 4 m, 4 m], cell: 0.5 m}",
                   .material = "{model: mohr_coulomb, density: 1800 kg/m3, youngs_modulus: 1 MPa, poisson_ratio: 0.3, "
                               "friction_angle: 20 deg, cohesion: 100 Pa}",
                   .bodies = flat ? "  - {material: soil, box: {min: [-2 m, 0 m], max: [2 m, 4 m]}}"
                                  : "  - {material: soil, box: {min: [-1 m, -1 m, 0 m], max: [1 m, 1 m, 2 m]}}",
                   .gravity = flat ? "[0, -9.81 m/s2]" : "[0, 0, -9.81 m/s2]",
                   .boundaries = "{bottom: {normal: fixed, friction: 0.4}}",
                   .scheme = scheme});
}

/// Largest difference between a particle's place and its mirror image's along `axis`, over the cell size.
double asymmetry(const Particles& particles, int axis) {
  const int dimension = particles.dimension;
  std::vector<std::vector<double>> x, born;
  for (int a = 0; a < dimension; ++a) {
    x.push_back(by_id(particles, "position", a));
    born.push_back(by_id(particles, "initial_position", a));
  }
  const auto key = [&](std::size_t p, bool mirrored) {
    std::vector<long> k;
    for (int a = 0; a < dimension; ++a)
      k.push_back(std::lround(born[static_cast<std::size_t>(a)][p] * 1000) * (mirrored && a == axis ? -1 : 1));
    return k;
  };
  std::map<std::vector<long>, std::size_t> at;
  for (std::size_t p = 0; p < x[0].size(); ++p) at[key(p, false)] = p;
  double largest = 0;
  for (std::size_t p = 0; p < x[0].size(); ++p) {
    const std::size_t mirror = at.at(key(p, true));
    for (int a = 0; a < dimension; ++a) {
      const auto i = static_cast<std::size_t>(a);
      largest = std::max(largest, std::abs(x[i][p] - (a == axis ? -1 : 1) * x[i][mirror]) / 0.5);
    }
  }
  return largest;
}

class SymmetricCollapse : public ::testing::TestWithParam<Scheme> {};

TEST_P(SymmetricCollapse, M) {
  for (int d : {2, 3}) {
    const auto simulation = column(d, GetParam());
    set_thread_count(2);
    try {
      for (double t : {0.1, 0.2, 0.4, 0.8}) {
        simulation->advance_to(t);
        double moved = 0;
        auto x = by_id(simulation->particles(), "position"), x0 = by_id(simulation->particles(), "initial_position");
        for (size_t p = 0; p < x.size(); ++p) moved = std::max(moved, std::abs(x[p] - x0[p]));
        fmt::print("{} {} t {} steps {} asym {:.2e} moved {:.3f}\n", GetParam().name(), d, t, simulation->steps(),
                   asymmetry(simulation->particles(), 0), moved);
      }
    } catch (std::exception& e) {
      puts(e.what());
    }
    set_thread_count(1);
  }
}

INSTANTIATE_TEST_SUITE_P(Schemes, SymmetricCollapse, ::testing::ValuesIn(all_schemes()), scheme_name);

}  // namespace
}  // namespace sluice
