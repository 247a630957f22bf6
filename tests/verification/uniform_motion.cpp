/// F1: uniform motion of uniformly stressed material across cells (Bardenhagen & Kober 2004; Steffen et al. 2008):
/// velocity and stress must stay as they are. Linear shape functions fail: a node between cells that hold different
/// numbers of particles feels a force of one particle, sigma V_p / h, although nothing is out of balance.
///
/// A long bar with free ends moves along a channel. Ends and interior are so far apart that, in the steps taken,
/// nothing at the ends can have reached the particles that are looked at: a step carries an influence over at most 3
/// cells.
#include "tests/verification/scene_fixture.h"

namespace sluice {
namespace {

constexpr double stress = -100, velocity = 1, dt = 0.05, density = 1000;
constexpr double kick = dt * -stress / (2 * density);  // of linear functions, at h = 1 m
constexpr int steps = 40, reach = 3 * steps;

/// Particles stand half a cell apart. In a deforming body no lattice fits the cells exactly; a bar stretched by 1 + e
/// about its middle stands for that: the points of one half cross their cell edges in step 15, those of the other in
/// step 16.
constexpr double length = 345, middle = length / 2;

/// With cubic B-splines the stress acts along the channel only: two particles do not integrate their slopes in the cell
/// at a wall (docs/theory.md, section 2), and a stress on the walls would not be in equilibrium.
SceneText channel(int dimension, const Scheme& scheme) {
  const bool flat = dimension == 2;
  const std::string across = scheme.shape == "cubic_bspline" ? "0" : "-100 Pa";
  return {
      .grid = flat ? "{min: [-2 m, 0 m], max: [350 m, 2 m], cell: 1 m}"
                   : "{min: [-2 m, 0 m, 0 m], max: [350 m, 1 m, 1 m], cell: 1 m}",
      .material = "{model: linear_elastic, density: 1000 kg/m3, youngs_modulus: 1 kPa, poisson_ratio: 0}",
      .bodies =
          flat ? "  - {material: soil, box: {min: [0 m, 0 m], max: [345 m, 2 m]}, velocity: [1 m/s, 0]}"
               : "  - {material: soil, box: {min: [0 m, 0 m, 0 m], max: [345 m, 1 m, 1 m]}, velocity: [1 m/s, 0, 0]}",
      .boundaries =
          flat ? "{bottom: roller, top: roller}" : "{bottom: roller, top: roller, front: roller, back: roller}",
      .initial_stress =
          fmt::format("{{method: uniform, stress: [-100 Pa, {0}, {0}, 0{1}]}}", across, flat ? "" : ", 0, 0"),
      .scheme = scheme.with("time_step: 50 ms")};
}

struct Deviation {
  double stress = 0;    ///< largest change of a stress component, over |sigma|
  double velocity = 0;  ///< largest change of a velocity component, over v
};

Deviation deviation_after_translation(int dimension, const Scheme& scheme, double stretched) {
  const auto simulation = simulate(channel(dimension, scheme));
  Particles& particles = simulation->particles();
  const auto x0 = by_id(particles, "position");
  set_column(particles, "position", 0, [&](const auto& x) { return middle + (x[0] - middle) * (1 + stretched); });
  for (double& v : particles.columns.values(particles.volume)) v *= 1 + stretched;
  for (double& m : particles.columns.values(particles.mass)) m *= 1 + stretched;
  const int components = dimension == 2 ? 4 : 6;
  std::vector<std::vector<double>> before;
  for (int c = 0; c < components; ++c) before.push_back(by_id(particles, "stress", c));
  take_steps(*simulation, steps);

  Deviation largest;
  for (int c = 0; c < components; ++c) {
    const auto s = by_id(particles, "stress", c);
    const auto& at_start = before[static_cast<std::size_t>(c)];
    for (std::size_t p = 0; p < s.size(); ++p)
      if (x0[p] > reach && x0[p] < length - reach)
        largest.stress = std::max(largest.stress, std::abs(s[p] - at_start[p]) / std::abs(stress));
  }
  for (int a = 0; a < dimension; ++a) {
    const auto v = by_id(particles, "velocity", a);
    for (std::size_t p = 0; p < v.size(); ++p)
      if (x0[p] > reach && x0[p] < length - reach)
        largest.velocity = std::max(largest.velocity, std::abs(v[p] - (a == 0 ? velocity : 0)) / velocity);
  }
  return largest;
}

constexpr const char* smooth_shapes[] = {"ugimp", "quadratic_bspline", "cubic_bspline"};

class UniformMotion : public ::testing::TestWithParam<Scheme> {};

// A lattice that fits the cells has no quadrature error at all: the gate of 1e-10 is round-off over 40 steps.
TEST_P(UniformMotion, SmoothFunctionsKeepStressAndVelocity) {
  Scheme scheme = GetParam();
  for (const char* shape : smooth_shapes) {
    scheme.shape = shape;
    for (const int dimension : {2, 3}) {
      const Deviation d = deviation_after_translation(dimension, scheme, 0);
      EXPECT_LT(d.stress, 1e-10) << shape << ' ' << dimension << "-D";
      EXPECT_LT(d.velocity, 1e-10) << shape << ' ' << dimension << "-D";
    }
  }
}

// One that is e off meets the kinks of the B-spline's slope a share e too early or late: the error is of the order of e
// times that of linear functions, below 10 e kicks here, and goes to zero with e.
TEST_P(UniformMotion, ErrorOfSmoothFunctionsVanishesWithTheMisfit) {
  Scheme scheme = GetParam();
  for (const char* shape : smooth_shapes) {
    scheme.shape = shape;
    for (const double e : {1e-4, 1e-5})
      EXPECT_LT(deviation_after_translation(2, scheme, e).velocity, 10 * e * kick) << shape;
  }
}

// The negative control. A node between a cell of four points and one of two is accelerated by sigma V_p / h for each
// missing point: by about sigma / (2 rho h) for one step. That does not depend on e.
TEST_P(UniformMotion, LinearFailsAsPredicted) {
  Scheme scheme = GetParam();
  scheme.shape = "linear";
  for (const double e : {1e-4, 1e-5}) {
    const Deviation d = deviation_after_translation(2, scheme, e);
    EXPECT_GT(d.velocity, 0.5 * kick);
    EXPECT_LT(d.velocity, 5 * kick);
    EXPECT_GT(d.stress, 1e-3);
  }
}

INSTANTIATE_TEST_SUITE_P(Schemes, UniformMotion, ::testing::ValuesIn(transfers_and_timings()), transfer_and_timing);

}  // namespace
}  // namespace sluice
