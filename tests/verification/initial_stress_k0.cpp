/// `initial_stress: {method: k0}`. Source: the overburden of layers, sigma_v(z) = -sum gamma_i t_i above z, and
/// sigma_h = K0 sigma_v, which is in equilibrium where the ground is level.
#include "tests/verification/scene_fixture.h"

namespace sluice {
namespace {

constexpr double gravity = 10, height = 10, sand_top = 6;
constexpr double sand_weight = 2000 * gravity, clay_weight = 1500 * gravity;

/// 4 m of clay (K0 = 1 - sin 30 = 0.5) on 6 m of sand (K0 = 0.4), two cells wide.
std::string column(int dimension, double h, const std::string& shape, const std::string& initial_stress,
                   int per_axis = 2) {
  const bool flat = dimension == 2;
  const auto point = [&](double side, double up) {
    return flat ? fmt::format("[{} m, {} m]", side, up) : fmt::format("[{0} m, {0} m, {1} m]", side, up);
  };
  const int per_cell = flat ? per_axis * per_axis : per_axis * per_axis * per_axis;
  return fmt::format(
      "schema: 1\nphysics: total_stress\nend_time: 10 s\ngrid: {{min: {}, max: {}, cell: {} m}}\ngravity: {}\n"
      "materials:\n"
      "  sand: {{model: linear_elastic, density: 2000 kg/m3, youngs_modulus: 20 MPa}}\n"
      "  clay: {{model: mohr_coulomb, density: 1500 kg/m3, youngs_modulus: 5 MPa, friction_angle: 30 deg, cohesion: 5 "
      "kPa}}\n"
      "bodies:\n  - {{material: sand, particles_per_cell: {}, layer: {{top: 6 m}}}}\n"
      "  - {{material: clay, particles_per_cell: {}, layer: {{bottom: 6 m, top: 10 m}}}}\n"
      "boundaries: {{bottom: fixed, left: roller, right: roller{}}}\n"
      "initial_stress: {}\nscheme: {{shape: {}}}\n",
      point(0, 0), point(2 * h, 12), h, flat ? "[0, -10 m/s2]" : "[0, 0, -10 m/s2]", per_cell, per_cell,
      flat ? "" : ", front: roller, back: roller", initial_stress, shape);
}

std::unique_ptr<Simulation> simulation(const std::string& text) {
  return Simulation::create(parse_case(text, "k0.yaml"));
}

double exact_vertical(double z) {
  return z > sand_top ? -clay_weight * (height - z) : -clay_weight * (height - sand_top) - sand_weight * (sand_top - z);
}

/// Largest difference from the exact vertical stress over the largest stress; and asserts that the others follow.
double vertical_error(const Particles& particles) {
  const int up = particles.dimension - 1;
  const auto z = by_id(particles, "position", up), vertical = by_id(particles, "stress", up);
  double largest = 0;
  for (std::size_t p = 0; p < z.size(); ++p)
    largest = std::max(largest, std::abs(vertical[p] - exact_vertical(z[p])) / -exact_vertical(0));
  for (int c = 0; c < (particles.dimension == 2 ? 4 : 6); ++c) {
    if (c == up) continue;
    const auto s = by_id(particles, "stress", c);
    for (std::size_t p = 0; p < z.size(); ++p) {
      const double k0 = c >= 3 ? 0 : z[p] > sand_top ? 0.5 : 0.4;
      EXPECT_NEAR(s[p], k0 * vertical[p], 1e-12 * -exact_vertical(0));
    }
  }
  return largest;
}

const std::string k0 = "{method: k0, k0: {sand: 0.4}}";

// With linear functions two points an axis integrate the weight and the stress of a cell exactly: nothing is left to
// balance, and the stress of every particle is the exact one to round-off, 1e-12 of the largest: sums of some 100
// terms, and solutions of the balance whose right-hand side is round-off.
TEST(K0, LayersAreExactWithLinearFunctions) {
  for (const int dimension : {2, 3})
    for (const double h : {1.0, 0.5})
      EXPECT_LT(vertical_error(simulation(column(dimension, h, "linear", k0))->particles()), 1e-12)
          << dimension << "-D, " << h;
}

/// Mean of the same.
double mean_error(const Particles& particles) {
  const int up = particles.dimension - 1;
  const auto z = by_id(particles, "position", up), vertical = by_id(particles, "stress", up);
  double sum = 0;
  for (std::size_t p = 0; p < z.size(); ++p) sum += std::abs(vertical[p] - exact_vertical(z[p])) / -exact_vertical(0);
  return sum / static_cast<double>(z.size());
}

// With quadratic functions the points do not integrate exactly where functions end: at the base, the top and the
// boundary of the layers (theory, after (32c)). What the balance adds there is a fixed share of the weight of a cell
// and dies out within a few cells: of first order in the largest error (found: gamma h / 12, in the cell at the base;
// bound with 1 % of room), and of second order in the mean, 4 times less with half the cell, to a tenth.
TEST(K0, BalanceAddsLittle) {
  for (const int dimension : {2, 3}) {
    double mean[2];
    for (const int fine : {0, 1}) {
      const double h = fine ? 0.5 : 1;
      const auto balanced = simulation(column(dimension, h, "quadratic_bspline", k0));
      EXPECT_LT(vertical_error(balanced->particles()), 1.01 * sand_weight * h / 12 / -exact_vertical(0));
      mean[fine] = mean_error(balanced->particles());
    }
    EXPECT_NEAR(mean[0] / mean[1], 4, 0.4) << dimension << "-D";
  }
}

/// Largest acceleration of a particle in a first step over gravity.
double acceleration(Simulation& simulation) {
  const auto info = simulation.advance(1e6);
  return simulation.largest_speed() / (0.5 * info.dt) / gravity;  // velocities live at half steps
}

// The balance leaves of the vertical forces what three passes with a spring of 1e-8 leave, which is round-off; sideways
// the sums of N' over a lattice vanish to round-off. Stresses are up to H / h weights of a cell, so one part in 1e16 of
// them is 1e-15 of g, some 100 terms a node: 1e-11 of g is room over that. Then nothing moves: 50 steps later the
// largest speed is still round-off. The controls: without initial stress the column falls with g; and with the exact
// stress at the points, not balanced, the node next to the base is off by gamma h / 16 on a mass of 11/16 rho h: 1/11
// g, of which the particle at 3/4 of the cell gets N = 0.65625. The acceleration is found from a small difference of
// large forces in a step that stiffness already changes: 1e-6.
TEST(K0, LevelGroundIsAtRest) {
  for (const int dimension : {2, 3})
    for (const char* shape : {"linear", "quadratic_bspline"})
      for (const int per_axis : {1, 2, 3}) {
        const auto still = simulation(column(dimension, 1, shape, k0, per_axis));
        EXPECT_LT(acceleration(*still), 1e-11) << dimension << "-D, " << shape << ", " << per_axis;
        take_steps(*still, 50);
        EXPECT_LT(still->largest_speed(), 1e-11) << dimension << "-D, " << shape << ", " << per_axis;
      }
  EXPECT_NEAR(acceleration(*simulation(column(2, 1, "quadratic_bspline", "{method: none}"))), 1, 0.01);
  const auto unbalanced = simulation(column(2, 1, "quadratic_bspline", k0));
  set_column(unbalanced->particles(), "stress", 1, [](const auto& x) { return exact_vertical(x[1]); });
  EXPECT_NEAR(acceleration(*unbalanced), 0.65625 / 11, 1e-6);
}

// A surface that ends within a cell is balanced as well; the top of the bodies is where their slabs end.
TEST(K0, LevelGroundThatEndsWithinACellIsAtRest) {
  for (const int dimension : {2, 3}) {
    const auto still = simulation(column(dimension, 0.8, "quadratic_bspline", k0));
    EXPECT_LT(acceleration(*still), 1e-11);
  }
}

// A given surface that is the top gives the same; one above adds the weight of what is missing, here 1.5 m of clay,
// everywhere; one below takes away what lies above it.
TEST(K0, GivenSurface) {
  const auto vertical = [](const std::string& surface) {
    return by_id(simulation(column(2, 1, "linear", "{method: k0, k0: 0.5, surface: " + surface + "}"))->particles(),
                 "stress", 1);
  };
  const auto z = by_id(simulation(column(2, 1, "linear", "{method: none}"))->particles(), "position", 1);
  const auto top = vertical("top"), level = vertical("10 m"), above = vertical("11.5 m"),
             below = vertical("[[0 m, 8 m], [1 m, 8 m]]");
  for (std::size_t p = 0; p < top.size(); ++p) {
    EXPECT_NEAR(level[p], top[p], 1e-8);
    EXPECT_NEAR(above[p], top[p] - 1.5 * clay_weight, 1e-8);
    EXPECT_NEAR(below[p], std::min(0.0, top[p] + 2 * clay_weight), 1e-8) << z[p];
  }
}

std::string slope(const std::string& more) {
  return "schema: 1\nphysics: total_stress\nend_time: 10 s\ngrid: {min: [0 m, 0 m], max: [20 m, 12 m], cell: 0.5 m}\n"
         "gravity: [0, -10 m/s2]\n"
         "materials: {soil: {model: linear_elastic, density: 2000 kg/m3, youngs_modulus: 20 MPa}}\n"
         "bodies: [{material: soil, polygon: [[0 m, 0 m], [20 m, 0 m], [20 m, 4 m], [0 m, 10 m]]}]\n"
         "boundaries: {bottom: fixed, left: roller, right: roller}\n"
         "initial_stress: {method: k0, k0: 0.5" +
         more + "}\n";
}

// Under a slope the vertical stress is the weight above, but nothing holds the change of the horizontal stress along
// the slope: K0 gamma tan(beta) = 0.5 g rho 0.3, so that it begins to move sideways with 0.15 g. Tolerance: the mean
// over the middle of the slope, to 2 %. With the surface as a line the stress is the depth below it to what the balance
// adds.
TEST(K0, ASlopeMoves) {
  const auto moving = simulation(slope(", surface: [[0 m, 10 m], [20 m, 4 m]]"));
  const auto x = by_id(moving->particles(), "position", 0), z = by_id(moving->particles(), "position", 1),
             vertical = by_id(moving->particles(), "stress", 1);
  const auto middle = [&](std::size_t p) { return x[p] > 6 && x[p] < 14 && z[p] > 2 && z[p] < 10 - 0.3 * x[p] - 1.5; };
  for (std::size_t p = 0; p < x.size(); ++p)
    if (middle(p)) {
      EXPECT_NEAR(vertical[p], -2e4 * (10 - 0.3 * x[p] - z[p]), 0.02 * 2e5);
    }
  const auto info = moving->advance(1e6);
  const auto speed = by_id(moving->particles(), "velocity", 0);
  double sum = 0, count = 0;
  for (std::size_t p = 0; p < x.size(); ++p)
    if (middle(p)) sum += speed[p], ++count;
  EXPECT_NEAR(sum / count / (0.5 * info.dt) / gravity, 0.15, 0.003);
}

// Saturated ground with water at rest below a pond: effective stress of the buoyant weight, whatever the depth of the
// pond. Dry density 1590, porosity 0.4: saturated 1990, buoyant 990 kg/m3.
TEST(K0, EffectiveStressUnderWater) {
  for (const std::string depth : {"0.5", "3"}) {
    const std::string level = std::to_string(1 + std::stod(depth));
    const auto still = simulation(
        "schema: 1\nphysics: two_phase\nend_time: 1 s\ngrid: {min: [0 m, 0 m], max: [0.2 m, 1.4 m], cell: 0.1 m}\n"
        "gravity: [0, -10 m/s2]\n"
        "materials: {soil: {model: linear_elastic, density: 1590 kg/m3, youngs_modulus: 10 MPa, water: {porosity: 0.4, "
        "permeability: 1e-3 m/s}}}\n"
        "bodies: [{material: soil, layer: {top: 1 m}}]\n"
        "boundaries: {bottom: roller, left: roller, right: roller}\n"
        "initial_stress: {method: k0, k0: 0.6}\nscheme: {shape: linear}\n"
        "water: {initial: {method: hydrostatic, level: " +
        level + " m}, ponds: [{level: " + level + " m}]}\n");
    const auto z = by_id(still->particles(), "position", 1), vertical = by_id(still->particles(), "stress", 1),
               sideways = by_id(still->particles(), "stress", 0);
    for (std::size_t p = 0; p < z.size(); ++p) {
      EXPECT_NEAR(vertical[p], -9900 * (1 - z[p]), 1e-8) << depth;  // of pressures up to 4e4 Pa: round-off
      EXPECT_NEAR(sideways[p], 0.6 * vertical[p], 1e-8) << depth;
    }
  }
}

// The water table lies 4 m below the top: wet below, dry above.
TEST(K0, WaterTable) {
  const auto still = simulation(
      "schema: 1\nphysics: two_phase\nend_time: 1 s\ngrid: {min: [0 m, 0 m], max: [2 m, 12 m], cell: 1 m}\n"
      "gravity: [0, -10 m/s2]\n"
      "materials: {soil: {model: linear_elastic, density: 1600 kg/m3, youngs_modulus: 10 MPa, water: {porosity: 0.4, "
      "permeability: 1e-3 m/s}}}\n"
      "bodies: [{material: soil, layer: {top: 10 m}}]\n"
      "boundaries: {bottom: roller, left: roller, right: roller}\n"
      "initial_stress: {method: k0, k0: 0.6}\nscheme: {shape: linear}\n"
      "water: {table: [[0 m, 6 m], [2 m, 6 m]], initial: {method: hydrostatic}}\n");
  const auto z = by_id(still->particles(), "position", 1), vertical = by_id(still->particles(), "stress", 1);
  for (std::size_t p = 0; p < z.size(); ++p)
    EXPECT_NEAR(vertical[p], z[p] > 6 ? -16e3 * (10 - z[p]) : -64e3 - 10e3 * (6 - z[p]), 1e-7) << z[p];
}

std::string error_of(const std::string& text) {
  try {
    simulation(text);
  } catch (const CaseError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(K0, Messages) {
  EXPECT_EQ(error_of(column(2, 1, "linear", "{method: k0}")),
            "k0.yaml:13:17: initial_stress: there is no k0 for 'sand', which has no friction_angle to take 1 - "
            "sin(friction_angle) from; give k0: {sand: 0.5}");
  EXPECT_EQ(error_of(column(2, 1, "linear", "{method: k0, k0: {sadn: 0.5}}")),
            "k0.yaml:13:35: k0: unknown material 'sadn'; allowed: sand, clay; did you mean 'sand'?");
  EXPECT_EQ(error_of(column(2, 1, "linear", "{method: none, k0: 0.5}")),
            "k0.yaml:13:36: initial_stress: `k0` is for `method: k0` only");
  EXPECT_EQ(error_of(column(2, 1, "linear", "{method: k0, k0: -1}")), "k0.yaml:13:34: k0 is -1; it must be at least 0");
  EXPECT_EQ(error_of(column(2, 1, "linear", "{method: k0, k0: 1, surface: [[1, 2, m], [1, 3, m]]}")),
            "k0.yaml:13:58: surface: x = 1 m must be greater than that of the point before, 1 m");
  EXPECT_NE(error_of(column(2, 1, "linear", "{method: k0, k0: 1, surface: tpo}")).find("did you mean 'top'?"),
            std::string::npos);
  std::string sideways = column(2, 1, "linear", "{method: k0, k0: 1}");
  sideways.replace(sideways.find("[0, -10 m/s2]"), 13, "[1 m/s2, -10]");
  EXPECT_NE(error_of(sideways).find("needs gravity that points down the last axis"), std::string::npos);
  std::string open = column(2, 1, "linear", "{method: k0, k0: 1}");
  open.replace(open.find("bottom: fixed, "), 15, "");
  EXPECT_NE(error_of(open).find("nothing holds the bodies against gravity"), std::string::npos);
}

}  // namespace
}  // namespace sluice
