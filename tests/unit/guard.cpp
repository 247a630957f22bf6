/// Outflow policies and the naming of bad particles, on a scene that no physics moves.
#include "core/simulation/guard.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "core/simulation/physics_module.h"

namespace sluice {
namespace {

/// Three points at (1, 1), (2, 1), (3, 1) of a grid from 0 to 4.
Scene<2> three_points() {
  Scene<2> scene(
      parse_case("schema: 1\nphysics: total_stress\nend_time: 1 s\n"
                 "grid: {min: [0 m, 0 m], max: [4 m, 4 m], cell: 1 m}\n"
                 "materials: {soil: {model: linear_elastic, density: 1000 kg/m3, youngs_modulus: 1 MPa}}\n"
                 "bodies: [{material: soil, box: {min: [1 m, 1 m], max: [2 m, 2 m]}}]\n",
                 "guard.yaml"));
  Particles& particles = scene.particles;
  particles.material_names = {"soil"};
  particles.resize(3);
  for (std::size_t p = 0; p < 3; ++p) {
    particles.id[p] = 10 + static_cast<std::int32_t>(p);
    particles.columns.data(particles.position, 0)[p] = 1.0 + static_cast<double>(p);
    particles.columns.data(particles.position, 1)[p] = 1;
    particles.columns.data(particles.volume)[p] = 1;
    particles.columns.data(particles.velocity, 0)[p] = 5;
  }
  return scene;
}

double& x_of(Scene<2>& scene, std::size_t p) { return scene.particles.columns.data(scene.particles.position, 0)[p]; }
double& vx_of(Scene<2>& scene, std::size_t p) { return scene.particles.columns.data(scene.particles.velocity, 0)[p]; }

TEST(ApplyOutflow, RemovesAndAsksForASort) {
  Scene<2> scene = three_points();
  x_of(scene, 1) = 4.5;
  EXPECT_EQ(apply_outflow(scene, OutflowPolicy::remove), 1u);
  EXPECT_EQ(scene.particles.id, (std::vector<std::int32_t>{10, 12}));
  EXPECT_EQ(x_of(scene, 1), 3);
  EXPECT_TRUE(scene.blocks.particle_blocks().empty());
}

TEST(ApplyOutflow, ClampStopsOutwardMotionOnly) {
  Scene<2> scene = three_points();
  x_of(scene, 0) = -0.5;  // moving inwards
  x_of(scene, 2) = 4.5;   // moving outwards
  EXPECT_EQ(apply_outflow(scene, OutflowPolicy::clamp), 0u);
  EXPECT_EQ(x_of(scene, 0), 0);
  EXPECT_EQ(vx_of(scene, 0), 5);
  EXPECT_EQ(x_of(scene, 2), std::nextafter(4.0, 0.0));
  EXPECT_EQ(vx_of(scene, 2), 0);
}

TEST(ApplyOutflow, ErrorNamesTheParticle) {
  Scene<2> scene = three_points();
  x_of(scene, 1) = 4.5;
  try {
    apply_outflow(scene, OutflowPolicy::error);
    FAIL() << "accepted";
  } catch (const OutflowError& error) {
    EXPECT_NE(std::string(error.what()).find("particle 11 (soil) at (4.5, 1) m"), std::string::npos) << error.what();
  }
}

// Outside by round-off is inside, whatever the policy: exactly on the upper face, or 1e-12 beyond.
TEST(ApplyOutflow, RoundOffIsNoOutflow) {
  for (const OutflowPolicy policy : {OutflowPolicy::error, OutflowPolicy::remove, OutflowPolicy::clamp}) {
    Scene<2> scene = three_points();
    x_of(scene, 0) = -1e-18;
    x_of(scene, 1) = 4;
    x_of(scene, 2) = 4 + 1e-12;
    EXPECT_EQ(apply_outflow(scene, policy), 0u);
    EXPECT_EQ(x_of(scene, 0), 0);
    EXPECT_LT(x_of(scene, 1), 4);
    EXPECT_LT(x_of(scene, 2), 4);
  }
}

template <class Damage>
std::string named_after(const Damage& damage) {
  Scene<2> scene = three_points();
  scene.step = 6;
  damage(scene.particles);
  try {
    throw_first_bad_particle(scene);
  } catch (const PhysicsError& error) {
    return error.what();
  }
}

TEST(BadParticle, IsNamedWithWhatIsWrong) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const auto expect = [](const std::string& message, const std::string& what) {
    EXPECT_NE(message.find(what), std::string::npos) << message;
    EXPECT_NE(message.find("particle 11 (soil) at (2, 1) m"), std::string::npos) << message;
    EXPECT_NE(message.find("in step 7 "), std::string::npos) << message;
  };
  expect(named_after([](Particles& p) { p.columns.data(p.velocity, 1)[1] = nan; }), "velocity is not finite");
  expect(named_after([](Particles& p) { p.columns.data(p.volume)[1] = -1; }), "inverts");
  expect(named_after([](Particles& p) { p.columns.data(p.stress, 3)[1] = nan; }), "stress is not finite");
}

}  // namespace
}  // namespace sluice
