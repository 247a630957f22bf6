/// Faces with a velocity: a column between closed faces, one of which moves as a piston. Source: uniaxial strain.
#include "tests/verification/scene_fixture.h"

namespace sluice {
namespace {

constexpr double way = 0.0995e-3;  // of the piston [m]: 1 mm/s, until it stops between 0.099 s and 0.1 s

std::unique_ptr<Simulation> compressed(const std::string& physics, const std::string& water, const Scheme& scheme) {
  SceneText scene{
      .grid = "{min: [0 m, 0 m], max: [0.4 m, 1 m], cell: 0.1 m}",
      .material = "{model: linear_elastic, density: 1600 kg/m3, youngs_modulus: 10 MPa, poisson_ratio: 0" + water + "}",
      .bodies = "  - {material: soil, box: {min: [0 m, 0 m], max: [0.4 m, 1 m]}}",
      .boundaries =
          "{bottom: roller, left: roller, right: roller, top: {normal: fixed, velocity: "
          "[0, [[0 s, -1 mm/s], [0.099 s, -1 mm/s], [0.1 s, 0 m/s]]]}}",
      .scheme = scheme,
      .physics = physics};
  if (!water.empty()) scene.more = "water: {bulk_modulus: 20 MPa}\n";
  auto simulation = simulate(scene);
  simulation->advance_to(0.3);
  return simulation;
}

double mean(const Simulation& simulation, const std::string& column, int component = 0) {
  const auto volume = by_id(simulation.particles(), "volume");
  return dot(volume, by_id(simulation.particles(), column, component)) / sum(volume);
}

// sigma = E eps. 1 %: the piston starts and stops at once, and the waves of that go on.
TEST(MovingFace, CompressesAColumn) {
  for (const auto& scheme : transfers_and_timings())
    EXPECT_NEAR(mean(*compressed("total_stress", "", scheme), "stress", 1) / (-10e6 * way), 1, 1e-2) << scheme.name();
}

// p = (K_w / n) eps: the water takes what the closed column loses of its volume. 0.1 %: the strain is 1e-4, and the
// bulk modulus of the grains is infinite.
TEST(MovingFace, CompressesTheWaterInAClosedColumn) {
  const std::string water = ", water: {porosity: 0.4, permeability: 0.01 mm/s, permeability_law: constant}";
  EXPECT_NEAR(mean(*compressed("two_phase", water, {}), "pore_pressure") / (20e6 / 0.4 * way), 1, 1e-3);
}

}  // namespace
}  // namespace sluice
