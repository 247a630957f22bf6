/// Bodies that do not stick to each other: what they do where they touch, against rigid bodies and waves.
#include <functional>

#include "core/simulation/physics_module.h"
#include "tests/verification/body_totals.h"
#include "tests/verification/resumed_run.h"
#include "tests/verification/scene_fixture.h"

namespace sluice {
namespace {

const std::string two_materials =
    "{model: linear_elastic, density: 1 kg/m3, youngs_modulus: 100 Pa, poisson_ratio: 0}\n"
    "  block: {model: linear_elastic, density: 1 kg/m3, youngs_modulus: 100 Pa, poisson_ratio: 0}";

// ---- two bars collide ----

constexpr double bar_length = 25, wave_speed = 10, bar_speed = 0.1;

/// Two equal bars run into each other head-on. Each is stopped by a wave that runs to its free end and comes back as
/// one that throws it back: contact lasts 2 L / c with the constant force rho c v A, and the bars part with exchanged
/// velocities and no stress.
SceneText bars(const Scheme& scheme, double h, bool contact, bool apart) {
  const double gap = apart ? 1 : 0;
  return {.grid = fmt::format("{{min: [-40 m, 0 m], max: [40 m, 1 m], cell: {} m}}", h),
          .material = two_materials,
          .bodies = fmt::format(
              "  - {{material: soil, box: {{min: [-{2} m, 0 m], max: [-{1} m, 1 m]}}, velocity: [{0}, 0 m/s]}}\n"
              "  - {{material: block, box: {{min: [{1} m, 0 m], max: [{2} m, 1 m]}}, velocity: [-{0}, 0 m/s]}}",
              bar_speed, gap, gap + bar_length),
          .boundaries = "{bottom: roller, top: roller}",
          .scheme = scheme,
          .more = contact ? "contact: {materials: [block]}\n" : ""};
}

struct Exchange {
  double velocity = 0;  ///< of the first bar over minus that before, 4 L / c after the bars begin to feel each other
  double rate = 0;      ///< at which it loses its momentum in between, over rho c v A
};

Exchange collide(const Scheme& scheme, double h, bool contact = true, bool apart = true) {
  const auto simulation = simulate(bars(scheme, h, contact, apart));
  const Particles& particles = simulation->particles();
  const double start = body_of(particles, "soil").momentum[0];
  double left = 1, touch = 0, high = 0, low = 0;
  while (left > 0.98) {
    simulation->advance(1e6);
    left = body_of(particles, "soil").momentum[0] / start;
    touch = simulation->time();
  }
  const double end = touch + 4 * bar_length / wave_speed;
  while (simulation->time() < end) {
    simulation->advance(end);
    left = body_of(particles, "soil").momentum[0] / start;
    if (high == 0 && left < 0.5) high = simulation->time();
    if (low == 0 && left < -0.5) low = simulation->time();
    EXPECT_LT(std::abs(total_momentum(particles, 0)), 1e-12 * start);
  }
  return {-left, bar_length / wave_speed / (low - high)};
}

class CollidingBars : public ::testing::TestWithParam<Scheme> {};

// The bars exchange their velocities but for what their ends lose, which are as wide as a shape function: with h = 1/2
// m, a fiftieth of a bar, 1 % with uGIMP, 3 % with CPDI, 4 % with quadratic and 7 % with cubic functions, and half of
// that with cells of half the size; a bar that meets a face with `normal: contact` loses as much. In between, the
// momentum falls with the rate rho c v A. Momentum of both together is round-off throughout.
TEST_P(CollidingBars, ExchangeTheirVelocitiesAndPart) {
  const Exchange coarse = collide(GetParam(), 0.5), fine = collide(GetParam(), 0.25);
  EXPECT_NEAR(coarse.velocity, 1, 0.08);
  EXPECT_NEAR((1 - fine.velocity) / (1 - coarse.velocity), 0.5, 0.05);
  EXPECT_NEAR(fine.rate, 1, 0.01);
}

INSTANTIATE_TEST_SUITE_P(Schemes, CollidingBars, ::testing::ValuesIn([] {
                           auto schemes = all_schemes();
                           std::erase_if(schemes,
                                         [](const Scheme& s) { return s.linear() || s.stress_update != "usl"; });
                           return schemes;
                         }()),
                         scheme_name);

// The negative control: bars that touch at the start part as well, but with one field of nodes they stick together,
// swing, and come forward again.
TEST(StickingBars, DoNotPart) {
  EXPECT_GT(collide({}, 0.5, true, false).velocity, 0.9);
  EXPECT_LT(collide({}, 0.5, false, false).velocity, -0.8);
}

// ---- a block on an elastic bench, in a frame that leans ----

constexpr double g = 10, slope = 0.5;  // tan of the angle

const std::string stiff_materials =
    "{model: linear_elastic, density: 2000 kg/m3, youngs_modulus: 20 MPa, poisson_ratio: 0.2}\n"
    "  block: {model: linear_elastic, density: 2000 kg/m3, youngs_modulus: 20 MPa, poisson_ratio: 0.2}";

std::string leaning_gravity() {
  const double cosine = 1 / std::hypot(1.0, slope);
  return fmt::format("[{} m/s2, {} m/s2]", g * slope * cosine, -g * cosine);
}

/// The bench is an endless layer, glued to the floor; the block lies on it in equilibrium.
SceneText sliding(const Scheme& scheme, double friction, const std::string& more = "") {
  return {.grid = "{min: [0 m, 0 m], max: [16 m, 5 m], cell: 0.5 m}",
          .material = stiff_materials,
          .bodies =
              "  - {material: soil, box: {min: [0 m, 0 m], max: [16 m, 2 m]}}\n"
              "  - {material: block, box: {min: [2 m, 2 m], max: [6 m, 3 m]}}",
          .gravity = leaning_gravity(),
          .boundaries = "{left: periodic, right: periodic, bottom: fixed}",
          .initial_stress = "{method: elastic_equilibrium}",
          .scheme = scheme,
          .more = fmt::format("contact: {{materials: [block], friction: {}{}}}\n", friction, more)};
}

const auto sliding_schemes = ::testing::Values(
    Scheme{"quadratic_bspline", "apic", "usl"}, Scheme{"cubic_bspline", "flip", "usl"}, Scheme{"ugimp", "tpic", "usl"},
    Scheme{"cpdi2", "flip", "usl"}, Scheme{"quadratic_bspline", "xpic", "usl"});

/// Way of the block until then [s].
double way(const SceneText& scene, double until = 1) {
  const auto simulation = simulate(scene);
  while (simulation->time() < until) simulation->advance(until);
  return body_of(simulation->particles(), "block").displacement(0);
}

class BlockOnBench : public ::testing::TestWithParam<Scheme> {};

// s = g (sin - mu cos) t^2 / 2. The stresses of the start hold a block that is glued to the bench; letting it go shakes
// both by less than a millimetre.
TEST_P(BlockOnBench, SlidesAsARigidOneDoes) {
  for (const double friction : {0.0, 0.2}) {
    const double expected = 0.5 * g * (slope - friction) / std::hypot(1.0, slope);
    EXPECT_NEAR(way(sliding(GetParam(), friction)), expected, 0.02 * expected) << friction;
  }
}

// Friction enough, or adhesion enough: it stays, but for what the bench gives.
TEST_P(BlockOnBench, StaysWhereFrictionHolds) {
  EXPECT_LT(std::abs(way(sliding(GetParam(), 0.7))), 0.01);
  EXPECT_LT(std::abs(way(sliding(GetParam(), 0.2, ", adhesion: 20 kPa"))), 0.01);
}

INSTANTIATE_TEST_SUITE_P(Schemes, BlockOnBench, sliding_schemes, scheme_name);

// With F-bar as well, where bench and block share the cells over which it averages.
TEST(BlockOnBenchWithFBar, SlidesAsARigidOneDoes) {
  const double expected = 0.5 * g * (slope - 0.2) / std::hypot(1.0, slope);
  EXPECT_NEAR(way(sliding(Scheme{}.with("f_bar: true"), 0.2)), expected, 0.02 * expected);
}

// The negative control: with one field of nodes the block is glued to the bench.
TEST(StickingBlock, StaysWithoutFriction) {
  SceneText scene = sliding({}, 0);
  scene.more = "";
  EXPECT_LT(std::abs(way(scene)), 0.01);
}

// ---- two blocks on an obstacle, one upon the other ----

constexpr double on_obstacle = 0.3, on_slab = 0.1, two_blocks_until = 0.5;

/// The slab slides on the obstacle and carries the block, which is less rough and runs ahead of it.
SceneText two_blocks(const Scheme& scheme, bool contact) {
  return {.grid = "{min: [0 m, 0 m], max: [16 m, 6 m], cell: 0.5 m}",
          .material = stiff_materials,
          .bodies =
              "  - {material: soil, box: {min: [2 m, 2 m], max: [8 m, 3 m]}}\n"
              "  - {material: block, box: {min: [3 m, 3 m], max: [5 m, 4 m]}}",
          .gravity = leaning_gravity(),
          .initial_stress = "{method: elastic_equilibrium}",
          .scheme = scheme,
          .more = fmt::format("obstacles: {{ramp: {{box: {{min: [-1 m, -1 m], max: [17 m, 2 m]}}, friction: {}}}}}\n{}",
                              on_obstacle,
                              contact ? fmt::format("contact: {{materials: [block], friction: {}}}\n", on_slab) : "")};
}

class TwoBlocks : public ::testing::TestWithParam<Scheme> {};

// Both as rigid ones: a = g cos (tan - mu) of the block, and of the slab, which has 3/4 of the mass, with the friction
// of both its sides. The obstacle carries the weight of both, and their mean friction over the way.
TEST_P(TwoBlocks, SlideUponEachOtherOnAnObstacle) {
  const auto simulation = simulate(two_blocks(GetParam(), true));
  double impulse[2] = {};
  while (simulation->time() < two_blocks_until) {
    const double dt = simulation->advance(two_blocks_until).dt;
    for (const auto& [name, value] : simulation->step_numbers()) {
      if (name == "ramp_force_x_N") impulse[0] += value * dt;
      if (name == "ramp_force_y_N") impulse[1] += value * dt;
    }
  }
  const double down = g / std::hypot(1.0, slope), half_square = 0.5 * two_blocks_until * two_blocks_until;
  const double of_block = down * (slope - on_slab) * half_square;
  const double of_slab = down * (slope + (0.25 * on_slab - on_obstacle) / 0.75) * half_square;
  EXPECT_NEAR(body_of(simulation->particles(), "block").displacement(0), of_block, 0.02 * of_block);
  EXPECT_NEAR(body_of(simulation->particles(), "soil").displacement(0), of_slab, 0.02 * of_block);
  const double weight = (6 + 2) * 2000 * down * two_blocks_until;
  EXPECT_NEAR(impulse[1], -weight, 0.02 * weight);
  EXPECT_NEAR(impulse[0], on_obstacle * weight, 0.02 * weight);
}

INSTANTIATE_TEST_SUITE_P(Schemes, TwoBlocks, sliding_schemes, scheme_name);

// The negative control: with one field of nodes the block stays on the slab.
TEST(TwoStickingBlocks, SlideAsOne) {
  const double together =
      g / std::hypot(1.0, slope) * (slope - on_obstacle) * 0.5 * two_blocks_until * two_blocks_until;
  EXPECT_NEAR(way(two_blocks({}, false), two_blocks_until), together, 0.02 * together);
}

// ---- the same on ground that adheres ----

constexpr double ground_adhesion = 7e3;  // [Pa]

/// `ground`: a face, or an obstacle with its surface at the same height. The material is ten times as stiff: until the
/// ground's resistance has come up to the middle of the slab, that falls freely.
SceneText two_blocks_on(const std::string& ground, const Scheme& scheme) {
  SceneText scene = two_blocks(scheme, true);
  for (std::size_t at; (at = scene.material.find("20 MPa")) != std::string::npos;)
    scene.material.replace(at, 6, "200 MPa");
  const std::string contact = fmt::format("contact: {{materials: [block], friction: {}}}\n", on_slab);
  const std::string surface = fmt::format("normal: fixed, adhesion: {} Pa", ground_adhesion);
  if (ground == "face") {
    scene.grid = "{min: [0 m, 2 m], max: [16 m, 6 m], cell: 0.5 m}";
    scene.boundaries = fmt::format("{{bottom: {{{}}}}}", surface);
    scene.more = contact;
  } else {
    scene.more =
        fmt::format("obstacles: {{ramp: {{box: {{min: [-1 m, -1 m], max: [17 m, 2 m]}}, {}}}}}\n{}", surface, contact);
  }
  return scene;
}

// The slab, 6 m long, is held by the adhesion times its length and drawn by the friction of the block: each body has
// an area of its own by which the ground adheres to it. The negative control without adhesion is the rest of the sum.
TEST(TwoBlocksOnAdhesiveGround, SlideUponEachOther) {
  const double down = g / std::hypot(1.0, slope), half_square = 0.5 * two_blocks_until * two_blocks_until;
  const double of_block = down * (slope - on_slab) * half_square;
  const double of_slab = (down * (slope + on_slab * 2 / 6) - ground_adhesion * 6 / (6 * 2000)) * half_square;
  for (const char* ground : {"face", "obstacle"}) {
    const auto simulation = simulate(two_blocks_on(ground, {}));
    while (simulation->time() < two_blocks_until) simulation->advance(two_blocks_until);
    EXPECT_NEAR(body_of(simulation->particles(), "block").displacement(0), of_block, 0.02 * of_block) << ground;
    EXPECT_NEAR(body_of(simulation->particles(), "soil").displacement(0), of_slab, 0.02 * of_block) << ground;
  }
}

// ---- waves from body to body and out of the grid ----

/// Share of the energy of a bar that is left when it has hit one of the same length at rest, whose other end meets a
/// face, and time has passed for its waves to leave there or to come back and throw the first bar away.
double energy_left(const std::string& face) {
  const auto simulation =
      simulate({.grid = fmt::format("{{min: [-40 m, 0 m], max: [{} m, 1 m], cell: 0.5 m}}", bar_length),
                .material = two_materials,
                .bodies = fmt::format(
                    "  - {{material: soil, box: {{min: [-{0} m, 0 m], max: [0 m, 1 m]}}, velocity: [{1}, 0 m/s]}}\n"
                    "  - {{material: block, box: {{min: [0 m, 0 m], max: [{0} m, 1 m]}}}}",
                    bar_length, 0.1 * bar_speed),  // slow, for the face lets the bar move by L v / c
                .boundaries = fmt::format("{{bottom: roller, top: roller, right: {}}}", face),
                .more = "contact: {materials: [block]}\n"});
  const double start = kinetic_and_elastic_energy(*simulation), end = 4.5 * bar_length / wave_speed;
  while (simulation->time() < end) simulation->advance(end);
  return kinetic_and_elastic_energy(*simulation) / start;
}

// The pulse of the impact, 2 L / c long, crosses the second bar and leaves it at the face that absorbs; the first bar
// stays where it was stopped. What is left: the ends lose and scatter some 4 % of the velocity (above), squared on the
// way through two of them. The negative control: a face that reflects sends the pulse back, and all energy stays.
TEST(AbsorbingFaceAndBodies, LetsTheWaveOfAnImpactOut) {
  EXPECT_LT(energy_left("{absorbing: {density: 1 kg/m3, p_wave: 10 m/s, s_wave: 7 m/s}}"), 0.01);
  EXPECT_GT(energy_left("roller"), 0.85);
}

// Two layers between a smooth wall and a face that absorbs press on both with their own horizontal stress: the face
// holds each body by itself. Tolerance: the weight compresses the layers by millimetres; round-off of that.
TEST(AbsorbingFaceAndBodies, HoldsEachBodyAtRest) {
  const auto simulation = simulate(
      {.grid = "{min: [0 m, 0 m], max: [8 m, 5 m], cell: 0.5 m}",
       .material = "{model: linear_elastic, density: 2000 kg/m3, youngs_modulus: 20 MPa, poisson_ratio: 0.1}\n"
                   "  block: {model: linear_elastic, density: 2000 kg/m3, youngs_modulus: 20 MPa, poisson_ratio: 0.4}",
       .bodies = "  - {material: soil, box: {min: [0 m, 0 m], max: [8 m, 2 m]}}\n"
                 "  - {material: block, box: {min: [0 m, 2 m], max: [8 m, 4 m]}}",
       .gravity = "[0, -10 m/s2]",
       .boundaries = "{left: roller, bottom: roller, right: {absorbing: {density: 2000 kg/m3, "
                     "p_wave: 100 m/s, s_wave: 60 m/s}}}",
       .initial_stress = "{method: elastic_equilibrium}",
       .more = "contact: {materials: [block]}\n"});
  while (simulation->time() < 1) simulation->advance(1);
  for (const char* name : {"soil", "block"})
    for (const std::size_t axis : {0u, 1u})
      EXPECT_LT(std::abs(body_of(simulation->particles(), name).displacement(axis)), 1e-6) << name << axis;
}

// ---- strain that F-bar averages ----

/// Largest stress in the second of two bodies after a step in which the first one is stretched away from it.
double stress_beside_a_stretched_body(bool contact) {
  const auto simulation = simulate({.grid = "{min: [0 m, 0 m], max: [8 m, 2 m], cell: 0.5 m}",
                                    .material = two_materials,
                                    .bodies = "  - {material: soil, box: {min: [0 m, 0 m], max: [4 m, 2 m]}}\n"
                                              "  - {material: block, box: {min: [4 m, 0 m], max: [8 m, 2 m]}}",
                                    .boundaries = "{bottom: roller, top: roller}",
                                    .scheme = Scheme{}.with("f_bar: true, time_step: 1 ms"),
                                    .more = contact ? "contact: {materials: [block]}\n" : ""});
  set_column(simulation->particles(), "velocity", 0, [](const auto& x) { return x[0] < 4 ? 0.01 * (x[0] - 4) : 0.0; });
  take_steps(*simulation, 1);
  const auto& particles = simulation->particles();
  const auto stress = by_id(particles, "stress"), x = by_id(particles, "position");
  double largest = 0;
  for (std::size_t p = 0; p < x.size(); ++p)
    if (x[p] > 4) largest = std::max(largest, std::abs(stress[p]));
  EXPECT_GT(largest_magnitude(stress), 1e-4);  // E times 1e-5, times the share of F-bar
  return largest;
}

// The other body is not strained at all, to the last bit, though they share cells: F-bar averages over those of a body.
// The negative control: one field of nodes strains both.
TEST(BodiesWithFBar, HaveMeansOfTheirOwn) {
  EXPECT_EQ(stress_beside_a_stretched_body(true), 0);
  EXPECT_GT(stress_beside_a_stretched_body(false), 1e-5);
}

// ---- a slope that crosses the cells ----

/// The same by vertical gravity, on a slope of 30 degrees whose surface the particles of both bodies follow in steps.
SceneText steep(const std::string& normal) {
  return {.grid = "{min: [0 m, 0 m], max: [5 m, 4 m], cell: 0.125 m}",
          .material =
              "{model: linear_elastic, density: 1800 kg/m3, youngs_modulus: 20 MPa, poisson_ratio: 0}\n"
              "  block: {model: linear_elastic, density: 1800 kg/m3, youngs_modulus: 20 MPa, poisson_ratio: 0}",
          .bodies =
              "  - {material: soil, polygon: [[0 m, 0 m], [5 m, 0 m], [5 m, 0.11325 m], [0 m, 3 m]]}\n"
              "  - {material: block, polygon: [[0.5196 m, 2.7 m], [1.8187 m, 1.95 m], [2.1937 m, 2.5995 m], "
              "[0.8946 m, 3.3495 m]]}",
          .gravity = "[0, -9.81 m/s2]",
          .boundaries = "{left: roller, right: roller, bottom: fixed}",
          .initial_stress = "{method: elastic_equilibrium}",
          .more = fmt::format("contact: {{materials: [block], friction: 0.2{}}}\n", normal)};
}

double way_down(const SceneText& scene) {
  const auto simulation = simulate(scene);
  while (simulation->time() < 0.6) simulation->advance(0.6);
  const Body block = body_of(simulation->particles(), "block");
  return block.displacement(0) * std::cos(std::atan(1) * 4 / 6) - block.displacement(1) * 0.5;
}

// s = g (sin - mu cos) t^2 / 2 with the normal of the slope.
TEST(SteepSlope, SlidesWithTheNormalThatIsGiven) {
  const double expected = 0.5 * 9.81 * (0.5 - 0.2 * std::sqrt(0.75)) * 0.36;
  EXPECT_NEAR(way_down(steep(", normal: [1, 1.7320508]")), expected, 0.03 * expected);
}

// The negative control: normals from particles follow the steps, and the bodies catch on each other.
TEST(SteepSlope, CatchesOnStepsWithoutIt) {
  const double expected = 0.5 * 9.81 * (0.5 - 0.2 * std::sqrt(0.75)) * 0.36;
  EXPECT_LT(way_down(steep("")), 0.7 * expected);
}

// cases/10_sliding_into_clay.yaml: the block comes to the clay as a rigid one does, and is stopped by it.
TEST(SlidingIntoClay, IsStopped) {
  const auto simulation = Simulation::create(load_case(std::string(SLUICE_CASES_DIR) + "/10_sliding_into_clay.yaml"));
  const auto run_to = [&](double time) {
    while (simulation->time() < time) simulation->advance(time);
    return body_of(simulation->particles(), "block");
  };
  const double expected = 0.5 * 9.81 * (0.5 - 0.3 * std::sqrt(0.75)) * 1.4 * 1.4;
  EXPECT_NEAR(run_to(1.4).displacement(0), expected, 0.01 * expected);
  EXPECT_LT(body_of(simulation->particles(), "clay").displacement(0), 1e-3);
  EXPECT_LT(std::abs(run_to(2.2).velocity(0)), 0.1);
  EXPECT_GT(body_of(simulation->particles(), "clay").displacement(0), 0.01);
}

// ---- conservation ----

/// Two discs graze each other. Linear momentum is kept to round-off, and the angular momentum of APIC, which its affine
/// fields carry in part, to round-off, too: both bodies have their impulses at one place, the node.
TEST(GrazingDiscs, KeepMomentum) {
  const auto simulation = simulate(
      {.grid = "{min: [-5 m, -5 m], max: [5 m, 5 m], cell: 0.25 m}",
       .material = two_materials,
       .bodies = "  - {material: soil, circle: {centre: [-1.5 m, 0.6 m], radius: 1 m}, velocity: [1, 0 m/s]}\n"
                 "  - {material: block, circle: {centre: [1.5 m, -0.6 m], radius: 1 m}, velocity: [-1, 0 m/s]}",
       .more = "contact: {materials: [block], friction: 0.5}\n"});
  const Particles& particles = simulation->particles();
  const auto mass = by_id(particles, "mass");
  const auto angular = [&] {
    const auto x = by_id(particles, "position"), y = by_id(particles, "position", 1);
    const auto u = by_id(particles, "velocity"), v = by_id(particles, "velocity", 1);
    const auto c_xy = by_id(particles, "affine_velocity", 1), c_yx = by_id(particles, "affine_velocity", 2);
    double all = 0;  // with D = h^2 / 4
    for (std::size_t p = 0; p < mass.size(); ++p)
      all += mass[p] * (x[p] * v[p] - y[p] * u[p] + 0.0625 / 4 * (c_yx[p] - c_xy[p]));
    return all;
  };
  const double before = angular(), momentum = body_of(particles, "soil").momentum[0];
  while (simulation->time() < 3) simulation->advance(3);
  EXPECT_LT(std::abs(total_momentum(particles, 0)), 1e-12 * momentum);
  EXPECT_LT(std::abs(total_momentum(particles, 1)), 1e-12 * momentum);
  EXPECT_NEAR(angular() / before, 1, 1e-12);
  EXPECT_LT(body_of(particles, "soil").velocity(0), 0.9);  // they have touched
}

// Bodies that move together do not know that they are two.
TEST(TouchingBodies, MoveAsOne) {
  const auto simulation = simulate(
      {.grid = "{min: [0 m, 0 m], max: [8 m, 8 m], cell: 0.5 m}",
       .material = two_materials +
                   "\n  third: {model: linear_elastic, density: 3 kg/m3, youngs_modulus: 50 Pa, poisson_ratio: 0}",
       .bodies = "  - {material: soil, box: {min: [1 m, 1 m], max: [2 m, 3 m]}, velocity: [1, 2 m/s]}\n"
                 "  - {material: block, box: {min: [2 m, 1 m], max: [3 m, 2 m]}, velocity: [1, 2 m/s]}\n"
                 "  - {material: third, box: {min: [2 m, 2 m], max: [3 m, 3 m]}, velocity: [1, 2 m/s]}",
       .more = "contact: {materials: [block, third], friction: 0.3}\n"});
  while (simulation->time() < 2) simulation->advance(2);
  const Particles& particles = simulation->particles();
  for (const double v : by_id(particles, "velocity")) EXPECT_NEAR(v, 1, 1e-12);
  for (const double v : by_id(particles, "velocity", 1)) EXPECT_NEAR(v, 2, 1e-12);
}

// ---- what does not go with it ----

std::string refusal(const std::function<void(SceneText&)>& change) {
  SceneText scene = sliding({}, 0.2);
  change(scene);
  return refusal_of(scene);
}

TEST(ContactRefused, SaysWhatAndWhere) {
  EXPECT_EQ(refusal([](SceneText&) {}), "");
  EXPECT_EQ(
      refusal([](SceneText& s) { s.scheme.stress_update = "usf"; }),
      "scene.yaml:4:10: contact: it does not go with `stress_update: usf`; it gains energy where bodies meet; take "
      "usl");
  EXPECT_EQ(
      refusal([](SceneText& s) { s.scheme.more = "integration: implicit_static, time_step: 1 s"; }),
      "scene.yaml:4:10: contact: it does not go with `integration: implicit_static`; take `integration: explicit`");
  EXPECT_EQ(refusal([](SceneText& s) { s.more = "contact: {materials: [blok]}\n"; }),
            "scene.yaml:4:22: contact: unknown material 'blok'; allowed: soil, block; did you mean 'block'?");
  EXPECT_EQ(refusal([](SceneText& s) { s.more = "contact: {materials: [block], friction: -1}\n"; }),
            "scene.yaml:4:41: friction is -1; it must be at least 0");
  EXPECT_NE(refusal([](SceneText& s) { s.more += "surface_loads: [{pressure: 1 kPa}]\n"; }).find("`surface_loads`"),
            std::string::npos);
}

// ---- in space, on several threads, after a restart ----

TEST(ContactInSpace, SlidesAndDoesNotDependOnThreads) {
  const auto make = [] {
    return simulate(
        {.grid = "{min: [0 m, 0 m, 0 m], max: [8 m, 4 m, 4 m], cell: 0.5 m}",
         .material =
             "{model: linear_elastic, density: 2000 kg/m3, youngs_modulus: 5 MPa, poisson_ratio: 0.2}\n"
             "  block: {model: linear_elastic, density: 2000 kg/m3, youngs_modulus: 5 MPa, poisson_ratio: 0.2}\n"
             "  crown: {model: linear_elastic, density: 2000 kg/m3, youngs_modulus: 5 MPa, poisson_ratio: 0.2}",
         .bodies = "  - {material: soil, box: {min: [0 m, 0 m, 0 m], max: [8 m, 4 m, 1 m]}}\n"
                   "  - {material: block, box: {min: [2 m, 1 m, 1 m], max: [4 m, 3 m, 1.5 m]}}\n"
                   "  - {material: crown, box: {min: [2 m, 1 m, 1.5 m], max: [4 m, 3 m, 2 m]}}",
         .gravity = "[4 m/s2, 0, -10 m/s2]",
         .boundaries = "{left: periodic, right: periodic, front: periodic, back: periodic, bottom: fixed}",
         .initial_stress = "{method: elastic_equilibrium}",
         .more = "contact: {materials: [soil], friction: 0.2}\n"});
  };
  const auto reference = run_and_resume(make, 0.5, 37, {"position", "velocity", "stress"});
  const double expected = 0.5 * (4 - 0.2 * 10) * 0.25;
  for (const char* name : {"block", "crown"})
    EXPECT_NEAR(body_of(reference->particles(), name).displacement(0), expected, 0.03 * expected) << name;
}

}  // namespace
}  // namespace sluice
