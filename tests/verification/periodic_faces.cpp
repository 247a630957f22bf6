/// Periodic faces: what leaves through one comes in at the other, and nothing that happens at the seam differs from
/// what happens elsewhere.
#include <functional>
#include <map>
#include <numbers>

#include "core/parallel/parallel.h"
#include "tests/verification/scene_fixture.h"

namespace sluice {
namespace {

constexpr double pi = std::numbers::pi;

// ---- F1 over two periods: a bar of constant stress moves as a whole ----

constexpr int turns = 2, cells = 24;

/// With cubic B-splines the stress acts along the bar only: two particles do not integrate their slopes in the cell at
/// a wall (docs/theory.md, section 2).
SceneText bar(int dimension, const Scheme& scheme) {
  const bool flat = dimension == 2;
  const std::string across = scheme.shape == "cubic_bspline" ? "0" : "-100 Pa";
  return {.grid = flat ? "{min: [-3 m, 0 m], max: [21 m, 2 m], cell: 1 m}"
                       : "{min: [-3 m, 0 m, 0 m], max: [21 m, 1 m, 1 m], cell: 1 m}",
          .material = "{model: linear_elastic, density: 1000 kg/m3, youngs_modulus: 1 kPa, poisson_ratio: 0}",
          .bodies = flat
                        ? "  - {material: soil, box: {min: [-3 m, 0 m], max: [21 m, 2 m]}, velocity: [1 m/s, 0]}"
                        : "  - {material: soil, box: {min: [-3 m, 0 m, 0 m], max: [21 m, 1 m, 1 m]}, velocity: [1 m/s, "
                          "0, 0]}",
          .boundaries = flat ? "{left: periodic, right: periodic, bottom: roller, top: roller}"
                             : "{left: periodic, right: periodic, bottom: roller, top: roller, front: roller, back: "
                               "roller}",
          .initial_stress =
              fmt::format("{{method: uniform, stress: [-100 Pa, {0}, {0}, 0{1}]}}", across, flat ? "" : ", 0, 0"),
          .scheme = scheme.with("time_step: 0.2 s")};
}

/// Largest change of a stress component over |sigma|, and of a velocity component over v, in two turns.
double deviation_after_two_turns(int dimension, const Scheme& scheme) {
  const auto simulation = simulate(bar(dimension, scheme));
  const Particles& particles = simulation->particles();
  const int components = dimension == 2 ? 4 : 6;
  std::vector<std::vector<double>> before;
  for (int c = 0; c < components; ++c) before.push_back(by_id(particles, "stress", c));
  take_steps(*simulation, 5 * cells * turns);
  double largest = 0;
  for (int c = 0; c < components; ++c) {
    const auto s = by_id(particles, "stress", c);
    for (std::size_t p = 0; p < s.size(); ++p)
      largest = std::max(largest, std::abs(s[p] - before[static_cast<std::size_t>(c)][p]) / 100);
  }
  for (int a = 0; a < dimension; ++a)
    for (const double v : by_id(particles, "velocity", a)) largest = std::max(largest, std::abs(v - (a == 0 ? 1 : 0)));
  for (std::size_t p = 0; p < particles.size(); ++p)
    largest = std::max(largest, std::abs(particles.displacement(p, 0) / (turns * cells) - 1));
  return largest;
}

class PeriodicBar : public ::testing::TestWithParam<Scheme> {};

// The gate of 1e-10 is round-off over 240 steps, in which every particle crosses every cell twice.
TEST_P(PeriodicBar, SmoothFunctionsCarryItRoundTwice) {
  Scheme scheme = GetParam();
  for (const char* shape : {"ugimp", "quadratic_bspline", "cubic_bspline", "cpdi", "cpdi2"}) {
    scheme.shape = shape;
    if (scheme.by_corners() && scheme.transfer == "apic") continue;
    for (const int dimension : {2, 3})
      EXPECT_LT(deviation_after_two_turns(dimension, scheme), 1e-10) << shape << ' ' << dimension << "-D";
  }
}

// The negative control: a node between a cell of two points and one of one is pushed by sigma V_p / h. In steps of a
// quarter of a cell, points a thousandth off the lattice come to the edge of their cell from both sides at one time.
TEST_P(PeriodicBar, LinearFunctionsDoNot) {
  Scheme scheme = GetParam();
  scheme.shape = "linear";
  SceneText scene = bar(2, scheme);
  scene.scheme.more = "time_step: 0.25 s";
  const auto simulation = simulate(scene);
  Particles& particles = simulation->particles();
  set_column(particles, "position", 0, [](const auto& x) { return x[0] + 1e-3 * std::sin(2 * pi * x[0] / cells); });
  take_steps(*simulation, 4 * cells * turns);
  double largest = 0;
  for (const double s : by_id(particles, "stress")) largest = std::max(largest, std::abs(s + 100) / 100);
  EXPECT_GT(largest, 1e-3);
}

INSTANTIATE_TEST_SUITE_P(Schemes, PeriodicBar, ::testing::ValuesIn(transfers_and_timings()), transfer_and_timing);

// Where particles are, and how often they have come round.
TEST(PeriodicPlaces, CrossingsAreCounted) {
  const auto simulation = simulate(bar(2, {}));
  take_steps(*simulation, 5 * 30);  // 30 m: one turn and a quarter
  const Particles& particles = simulation->particles();
  const auto crossings = by_id(particles, "crossings"), x0 = by_id(particles, "initial_position"),
             x = by_id(particles, "position");
  for (std::size_t p = 0; p < x.size(); ++p) {
    EXPECT_GE(x[p], -3 - 1.0);  // up to a cell beyond an end, between two sorts
    EXPECT_LT(x[p], 21 + 1.0);
    EXPECT_NEAR(x[p] + 24 * crossings[p], x0[p] + 30, 1e-9);
    EXPECT_GE(crossings[p], 1);
    EXPECT_LE(crossings[p], 2);
  }
}

// ---- a plane wave through the seam ----

/// A wave runs along a periodic bar of unit density and modulus for so many periods; the share of a period that it is
/// late. Small amplitude: particles stay where they are.
double lateness(const Scheme& scheme, int periods, double seam) {
  constexpr double v0 = 1e-6, k = 2 * pi / cells;
  constexpr int steps_a_period = 480;
  const auto simulation =
      simulate({.grid = fmt::format("{{min: [{} m, 0 m], max: [{} m, 1 m], cell: 1 m}}", seam, seam + cells),
                .material = "{model: linear_elastic, density: 1 kg/m3, youngs_modulus: 1 Pa, poisson_ratio: 0}",
                .bodies = fmt::format(
                    "  - {{material: soil, particles_per_cell: 16, box: {{min: [{} m, 0 m], max: [{} m, 1 m]}}}}", seam,
                    seam + cells),
                .boundaries = "{left: periodic, right: periodic, bottom: roller, top: roller}",
                .scheme = scheme.with(fmt::format("time_step: {} s", static_cast<double>(cells) / steps_a_period))});
  Particles& particles = simulation->particles();
  set_column(particles, "velocity", 0, [](const auto& x) { return v0 * std::sin(k * x[0]); });
  set_column(particles, "stress", 0, [](const auto& x) { return -v0 * std::sin(k * x[0]); });
  const auto x0 = by_id(particles, "initial_position");
  take_steps(*simulation, periods * steps_a_period);
  const auto v = by_id(particles, "velocity");
  double sine = 0, cosine = 0;
  for (std::size_t p = 0; p < v.size(); ++p) sine += v[p] * std::sin(k * x0[p]), cosine += v[p] * std::cos(k * x0[p]);
  return std::atan2(cosine, sine) / (2 * pi);
}

class PlaneWave : public ::testing::TestWithParam<Scheme> {};

/// The frequency of a wave by linear theory over c k, for many particles in a cell. With theta = k h: particles hold
/// v = sum_i N_i w_i, the nodes with their lumped masses see M w, and the forces are K u: omega^2 = M K, each the
/// transform of the matrix of the splines on a uniform lattice (h = 1).
double relative_frequency(const std::string& shape, double theta) {
  const double c1 = std::cos(theta), c2 = std::cos(2 * theta), c3 = std::cos(3 * theta);
  double mass = (4 + 2 * c1) / 6, stiffness = 2 - 2 * c1;
  if (shape == "quadratic_bspline") mass = (66 + 52 * c1 + 2 * c2) / 120, stiffness = (6 - 4 * c1 - 2 * c2) / 6;
  if (shape == "cubic_bspline")
    mass = (2416 + 2382 * c1 + 240 * c2 + 2 * c3) / 5040, stiffness = (80 - 30 * c1 - 48 * c2 - 2 * c3) / 120;
  return std::sqrt(mass * stiffness) / theta;
}

// In three periods of 24 cells a wave is late by 2.5 % of a period with linear, 4.9 % with quadratic and 6.5 % with
// cubic functions. Velocities are half a step old. The tolerance of 2 % of that is for the number of particles in a
// cell, four along the bar.
TEST_P(PlaneWave, IsAsLateAsTheoryHasIt) {
  const double late = 3 * (1 - relative_frequency(GetParam().shape, 2 * pi / cells)) + 0.5 / 480;
  EXPECT_NEAR(lateness(GetParam(), 3, 0), late, 0.02 * late);
}

// And the seam is nowhere: the same wave with the seam elsewhere in it.
TEST_P(PlaneWave, DoesNotFeelTheSeam) { EXPECT_NEAR(lateness(GetParam(), 1, 0), lateness(GetParam(), 1, -9), 1e-10); }

INSTANTIATE_TEST_SUITE_P(Schemes, PlaneWave,
                         ::testing::Values(Scheme{"linear", "flip", "usf"}, Scheme{"linear", "flip", "usl"},
                                           Scheme{"quadratic_bspline", "flip", "usf"},
                                           Scheme{"quadratic_bspline", "flip", "usl"},
                                           Scheme{"cubic_bspline", "flip", "usf"},
                                           Scheme{"cubic_bspline", "flip", "usl"}),
                         scheme_name);

// ---- the seam is nowhere ----

/// A scene of which the seam cuts through the middle of things, or not: `shift` moves the grid along its periodic axes.
using SceneAt = std::function<SceneText(double shift)>;

/// One component of a column by place of birth: the grid has moved, so identities differ.
std::map<std::vector<long>, double> by_birth(const Particles& particles, const std::string& column, int component,
                                             double period) {
  std::map<std::vector<long>, double> values;
  for (std::size_t p = 0; p < particles.size(); ++p) {
    std::vector<long> place;
    for (int a = 0; a < particles.dimension; ++a) {
      const double x = particles.columns.data(particles.initial_position, a)[p];
      place.push_back(std::lround(1e4 * (x - std::floor(x / period) * period)) % std::lround(1e4 * period));
    }
    values[place] = particles.columns.data(particles.columns.find(column), component)[p];
  }
  return values;
}

struct Compared {
  std::string column;
  int component;
  double tolerance;
};

void expect_no_seam(const SceneAt& scene, int steps, double shift, double period,
                    const std::vector<Compared>& columns) {
  const auto here = simulate(scene(0)), there = simulate(scene(shift));
  ASSERT_EQ(here->particles().size(), there->particles().size());
  take_steps(*here, steps);
  take_steps(*there, steps);
  for (const auto& [column, component, tolerance] : columns) {
    const auto a = by_birth(here->particles(), column, component, period),
               b = by_birth(there->particles(), column, component, period);
    ASSERT_EQ(a.size(), here->particles().size());
    double largest = 0, difference = 0;
    for (const auto& [place, value] : a) {
      ASSERT_TRUE(b.contains(place));
      largest = std::max(largest, std::abs(value));
      difference = std::max(difference, std::abs(value - b.at(place)));
    }
    EXPECT_GT(largest, 0) << column;
    EXPECT_LT(difference, tolerance * largest) << column << ' ' << component;
  }
}

/// A block on a rough floor, pushed aside; with the grid from `shift` on, the seam cuts it in two.
SceneText pushed_block(const Scheme& scheme, double shift, const std::string& more = "") {
  const bool whole = shift == 0;
  return {
      .grid = fmt::format("{{min: [{} m, 0 m], max: [{} m, 5 m], cell: 0.5 m}}", shift, shift + 8),
      .material =
          "{model: mohr_coulomb, density: 1800 kg/m3, youngs_modulus: 1 MPa, poisson_ratio: 0.3, friction_angle: 30 "
          "deg, cohesion: 1 kPa}",
      .bodies = whole ? "  - {material: soil, box: {min: [2 m, 0 m], max: [6 m, 2 m]}, velocity: [1.5 m/s, 0]}"
                      : "  - {material: soil, box: {min: [4 m, 0 m], max: [6 m, 2 m]}, velocity: [1.5 m/s, 0]}\n"
                        "  - {material: soil, box: {min: [10 m, 0 m], max: [12 m, 2 m]}, velocity: [1.5 m/s, 0]}",
      .gravity = "[0, -9.81 m/s2]",
      .boundaries = "{left: periodic, right: periodic, bottom: {normal: fixed, friction: 0.4}}",
      .scheme = scheme,
      .more = more};
}

class Seam : public ::testing::TestWithParam<Scheme> {};

// The tolerance is round-off, which yielding lets grow over the steps.
TEST_P(Seam, IsNowhere) {
  expect_no_seam([&](double shift) { return pushed_block(GetParam().with("time_step: 1 ms"), shift); }, 80, 4, 8,
                 {{"velocity", 0, 1e-8}, {"velocity", 1, 1e-8}, {"stress", 0, 1e-8}, {"stress", 3, 1e-8}});
}

// All axes but the last are periodic, the seam in the corner of a block.
TEST_P(Seam, IsNowhereInSpace) {
  const auto scene = [&](double shift) {
    std::string bodies;
    for (const double x : {0.0, 4.0})
      for (const double y : {0.0, 4.0})
        if (shift != 0 || (x == 0 && y == 0))
          bodies += fmt::format(
              "  - {{material: soil, box: {{min: [{} m, {} m, 0 m], max: [{} m, {} m, 1 m]}}, velocity: [1, 2, 0 "
              "m/s]}}\n",
              shift == 0 ? 1
              : x == 0   ? 2
                         : 5,
              shift == 0 ? 1
              : y == 0   ? 2
                         : 5,
              shift == 0 ? 3
              : x == 0   ? 3
                         : 6,
              shift == 0 ? 3
              : y == 0   ? 3
                         : 6);
    return SceneText{
        .grid = fmt::format("{{min: [{0} m, {0} m, 0 m], max: [{1} m, {1} m, 2 m], cell: 0.5 m}}", shift, shift + 4),
        .bodies = bodies,
        .gravity = "[0, 0, -9.81 m/s2]",
        .boundaries = "{left: periodic, right: periodic, front: periodic, back: periodic, bottom: fixed}",
        .scheme = GetParam().with("time_step: 2 ms")};
  };
  expect_no_seam(scene, 40, 2, 4, {{"velocity", 0, 1e-8}, {"velocity", 2, 1e-8}, {"stress", 2, 1e-8}});
}

INSTANTIATE_TEST_SUITE_P(Schemes, Seam, ::testing::ValuesIn(all_schemes()), scheme_name);

TEST(SeamOfMore, IsNowhereWithMeansOverCells) {
  for (const char* shape : {"linear", "quadratic_bspline"})
    expect_no_seam(
        [&](double shift) {
          return pushed_block({shape, "flip", "usl", 1, "f_bar: true, time_step: 1 ms"}, shift);
        },
        80, 4, 8, {{"velocity", 0, 1e-8}, {"stress", 0, 1e-8}, {"stress", 3, 1e-8}});
}

// The obstacle lies at the seam, reaches over it, and moves through it.
TEST(SeamOfMore, IsNowhereWithObstacles) {
  const auto scene = [](double shift) {
    return pushed_block({.more = "time_step: 1 ms"}, shift,
                        fmt::format("obstacles: {{ram: {{box: {{min: [{} m, 0 m], max: [{} m, 1 m]}}, friction: 0.3, "
                                    "velocity: [4 m/s, 0]}}}}\n",
                                    shift == 0 ? 0.9 : 8.9, shift == 0 ? 1.9 : 9.9));
  };
  expect_no_seam(scene, 80, 4, 8, {{"velocity", 0, 1e-8}, {"velocity", 1, 1e-8}, {"stress", 0, 1e-8}});
}

// Steps from balance to balance, and an equilibrium at the start.
TEST(SeamOfMore, IsNowhereWithImplicitSteps) {
  for (const char* integration : {"implicit_static", "implicit_newmark"}) {
    const auto scene = [&](double shift) {
      SceneText text = pushed_block({"quadratic_bspline", "flip", "usl", 1,
                                     fmt::format("integration: {}, time_step: 20 ms, tolerance: 1e-10", integration)},
                                    shift);
      text.material = "{model: linear_elastic, density: 1800 kg/m3, youngs_modulus: 200 kPa, poisson_ratio: 0.3}";
      text.boundaries = "{left: periodic, right: periodic, bottom: fixed}";
      return text;
    };
    expect_no_seam(scene, 6, 4, 8, {{"stress", 0, 1e-6}, {"stress", 1, 1e-6}, {"stress", 3, 1e-6}});
  }
}

TEST(SeamOfMore, IsNowhereInEquilibrium) {
  for (const char* method : {"elastic_equilibrium", "equilibrium", "k0"})
    expect_no_seam(
        [&](double shift) {
          SceneText text = pushed_block({.more = "time_step: 1 ms"}, shift);
          text.boundaries = "{left: periodic, right: periodic, bottom: fixed}";
          text.material =
              "{model: mohr_coulomb, density: 1800 kg/m3, youngs_modulus: 1 MPa, poisson_ratio: 0.3, friction_angle: "
              "30 "
              "deg, cohesion: 20 kPa}";
          text.initial_stress = fmt::format("{{method: {}}}", method);
          return text;
        },
        1, 4, 8, {{"stress", 0, 1e-5}, {"stress", 1, 1e-5}});
}

// Soil with water, in all formulations: the pressure is solved for across the seam. The tolerance is that of the
// solver.
TEST(SeamOfMore, IsNowhereWithWater) {
  for (const char* formulation : {"u-p", "v-w-p", "explicit"}) {
    const auto scene = [&](double shift) {
      SceneText text = pushed_block({.more = "time_step: 0.2 ms"}, shift,
                                    fmt::format("water: {{formulation: {}, bulk_modulus: 20 MPa, initial: {{method: "
                                                "hydrostatic, level: 2 m}}}}\n",
                                                formulation));
      text.material =
          "{model: linear_elastic, density: 1800 kg/m3, youngs_modulus: 1 MPa, poisson_ratio: 0.3, water: {porosity: "
          "0.4, "
          "permeability: 1e-3 m/s}}";
      text.physics = "two_phase";
      return text;
    };
    SCOPED_TRACE(formulation);
    expect_no_seam(scene, 40, 4, 8, {{"pore_pressure", 0, 1e-6}, {"velocity", 0, 1e-6}, {"stress", 0, 1e-6}});
  }
}

TEST(SeamOfMore, IsNowhereWithWaterInSpace) {
  const auto scene = [](double shift) {
    std::string bodies;
    for (const double x : {1.0, 5.0})
      if (shift != 0 || x == 1)
        bodies += fmt::format(
            "  - {{material: soil, box: {{min: [{} m, 0 m, 0 m], max: [{} m, 4 m, 1.5 m]}}, velocity: [1, 0, 0 "
            "m/s]}}\n",
            shift == 0 ? 1
            : x == 1   ? 2
                       : 5,
            shift == 0 ? 3
            : x == 1   ? 3
                       : 6);
    return SceneText{
        .grid = fmt::format("{{min: [{} m, 0 m, 0 m], max: [{} m, 4 m, 3 m], cell: 0.5 m}}", shift, shift + 4),
        .material =
            "{model: linear_elastic, density: 1800 kg/m3, youngs_modulus: 1 MPa, poisson_ratio: 0.3, water: "
            "{porosity: 0.4, permeability: 1e-3 m/s}}",
        .bodies = bodies,
        .gravity = "[0, 0, -9.81 m/s2]",
        .boundaries = "{left: periodic, right: periodic, front: periodic, back: periodic, bottom: fixed}",
        .scheme = {.more = "time_step: 0.5 ms"},
        .physics = "two_phase",
        .more = "water: {initial: {method: hydrostatic, level: 1.5 m}}\n"};
  };
  expect_no_seam(scene, 15, 2, 4, {{"pore_pressure", 0, 1e-6}, {"velocity", 0, 1e-6}, {"stress", 2, 1e-6}});
}

// ---- motion along a periodic axis ----

// Free fall through the bottom and in at the top, four turns: v = -g t and s = -g t^2 / 2, to round-off.
TEST(PeriodicFall, FallsForEver) {
  for (const auto& scheme :
       {Scheme{"quadratic_bspline", "apic", "usl"}, Scheme{"cpdi2", "tpic", "usf"}, Scheme{"linear", "flip", "musl"}}) {
    const auto simulation = simulate({.grid = "{min: [0 m, 0 m], max: [4 m, 8 m], cell: 1 m}",
                                      .bodies = "  - {material: soil, box: {min: [1 m, 2 m], max: [3 m, 4 m]}}",
                                      .gravity = "[0, -10 m/s2]",
                                      .boundaries = "{bottom: periodic, top: periodic}",
                                      .scheme = scheme});
    while (simulation->time() < 2.5) simulation->advance(2.5);
    const Particles& particles = simulation->particles();
    for (std::size_t p = 0; p < particles.size(); ++p) EXPECT_NEAR(particles.displacement(p, 1), -31.25, 1e-9);
    // Velocities are half a step old.
    const double v = total_momentum(particles, 1) / sum(by_id(particles, "mass"));
    EXPECT_NEAR(v, -25, 10 * 0.1);
    EXPECT_NEAR(total_momentum(particles, 0), 0, 1e-9);
  }
}

// An infinite layer slides down a plane that is tilted by 30 degrees, in a frame that leans with it: the acceleration
// is g (sin - mu cos), the stress that of its weight. Exact, for nothing varies along the plane but round-off.
TEST(PeriodicSlope, SlidesAsAnInfiniteSlope) {
  const double g = 10, a = g * 0.5, n = g * std::sqrt(0.75), mu = 0.3;
  const auto simulation = simulate(
      {.grid = "{min: [0 m, 0 m], max: [8 m, 3 m], cell: 1 m}",
       .bodies = "  - {material: soil, box: {min: [0 m, 0 m], max: [8 m, 2 m]}}",
       .gravity = fmt::format("[{} m/s2, {} m/s2]", a, -n),
       .boundaries = fmt::format("{{left: periodic, right: periodic, bottom: {{normal: fixed, friction: {}}}}}", mu),
       .initial_stress = "{method: equilibrium}",
       .scheme = {.more = "time_step: 2 ms"}});
  // The equilibrium holds the layer at the floor, where it now slides: shear waves run through it, and the mean stays.
  const double end = 3;
  while (simulation->time() < end) simulation->advance(end);
  const Particles& particles = simulation->particles();
  double mean = 0;
  for (std::size_t p = 0; p < particles.size(); ++p)
    mean += particles.displacement(p, 0) / static_cast<double>(particles.size());
  EXPECT_NEAR(mean, 0.5 * (a - mu * n) * end * end, 0.005 * 0.5 * (a - mu * n) * end * end);
}

// Momentum along a periodic axis is kept whatever happens: a jet of noise in an elastic bar.
TEST(PeriodicMomentum, IsRoundOff) {
  for (const auto& scheme : all_schemes()) {
    if (scheme.linear()) continue;
    const auto simulation = simulate(bar(2, scheme));
    Particles& particles = simulation->particles();
    std::uint32_t random = 1;
    set_column(particles, "velocity", 0, [&](const auto&) {
      random = random * 1664525u + 1013904223u;
      return 0.1 * (random / 4294967296.0 - 0.5) + 1;
    });
    const double before = total_momentum(particles, 0);
    take_steps(*simulation, 60);
    EXPECT_NEAR(total_momentum(particles, 0) / before, 1, 1e-12) << scheme.name();
  }
}

// ---- the same bits ----

void expect_same_bits(const Simulation& a, const Simulation& b) {
  ASSERT_EQ(a.particles().id, b.particles().id);
  for (const ColumnSpec& spec : a.particles().columns.specs())
    for (int c = 0; spec.role == Role::state && c < spec.components; ++c)
      EXPECT_EQ(by_id(a.particles(), spec.name, c), by_id(b.particles(), spec.name, c)) << spec.name;
}

TEST(PeriodicBits, DependNeitherOnThreadsNorOnARestart) {
  const auto make = [] {
    auto text = pushed_block({.more = "time_step: 2 ms, f_bar: true"}, 4);
    text.grid = "{min: [4 m, 0 m], max: [12 m, 5 m], cell: 0.125 m}";
    return simulate(text);
  };
  set_thread_count(1);
  const auto reference = make(), first = make();
  take_steps(*reference, 120);
  take_steps(*first, 65);
  Archive archive;
  first->store(archive);
  set_thread_count(3);
  const auto other = make(), resumed = make();
  take_steps(*other, 120);
  resumed->restore(archive);
  take_steps(*resumed, 55);
  set_thread_count(1);
  EXPECT_GT(largest_magnitude(by_id(reference->particles(), "crossings")), 0);
  expect_same_bits(*reference, *other);
  expect_same_bits(*reference, *resumed);
}

}  // namespace
}  // namespace sluice
