/// Collapse of a column of water twice as high as wide on a smooth bed. Its front is compared with potential flow
/// without friction, and with the experiment of Martin & Moyce (1952), n^2 = 2; and a surface must stay calm in
/// steps of any length.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "core/simulation/physics_module.h"
#include "tests/verification/scene_fixture.h"

namespace sluice {
namespace {

constexpr double a = 0.05715;  // width of the column [m]
constexpr double g = 9.81;

/// T = t sqrt(2g/a) and the front Z = x/a.
using Front = std::array<double, 2>;

/// Potential flow by boundary elements (docs/validation/column_potential_flow.py).
constexpr std::array<Front, 6> potential_flow{
    {{0.402, 1.118}, {0.602, 1.236}, {0.804, 1.382}, {1.0, 1.545}, {1.2, 1.727}, {1.402, 1.912}}};
/// Martin & Moyce, a = 2.25 in.
constexpr std::array<Front, 5> experiment{
    {{1.219, 1.474}, {1.997, 2.292}, {2.547, 2.995}, {3.345, 4.134}, {4.034, 4.944}}};

std::string column(const std::string& cell, const std::string& scheme, double end) {
  return fmt::format(
      "schema: 1\nphysics: two_phase\ngrid: {{min: [0, 0], max: [0.40005, 0.17145], cell: {} mm}}\n"
      "gravity: [0, -9.81 m/s2]\nmaterials: {{w: {{model: water}}}}\n"
      "bodies: [{{material: w, box: {{min: [0, 0], max: [0.05715, 0.1143]}}}}]\n"
      "boundaries: {{bottom: roller, left: roller, right: roller}}\n"
      "water: {{initial: {{method: hydrostatic, level: 0.1143}}}}\n{}outflow: remove\nend_time: {} s\n",
      cell, scheme.empty() ? "" : "scheme: {" + scheme + "}\n", end);
}

/// Place of the outermost particle in units of a, from 1 at the start.
class Column {
 public:
  Column(const std::string& cell, const std::string& scheme)
      : simulation_(Simulation::create(parse_case(column(cell, scheme, 1), "column.yaml"))), start_(outermost()) {}

  void advance_to(double scaled_time) { simulation_->advance_to(scaled_time * std::sqrt(a / (2 * g))); }
  double front() const { return 1 + (outermost() - start_) / a; }
  double speed() const { return simulation_->largest_speed(); }
  Simulation& simulation() { return *simulation_; }

 private:
  double outermost() const {
    const auto x = by_id(simulation_->particles(), "position");
    return *std::max_element(x.begin(), x.end());
  }
  std::unique_ptr<Simulation> simulation_;
  double start_;
};

}  // namespace

/// Neither has friction, viscosity or a diaphragm: the front agrees as well as cells of a/20 resolve it.
TEST(TwoPhaseDamBreak, front_is_that_of_potential_flow) {
  Column water("2.8575", "");
  for (const auto& [time, place] : potential_flow) {
    water.advance_to(time);
    EXPECT_NEAR(water.front() - 1, place - 1, 0.03 * place) << "T = " << time;
  }
}

/// The experiment starts late: its front lags behind potential flow from the beginning, by a time that hardly changes.
/// Pulling the diaphragm took that long. Shifted by it, the fronts agree within 5 % (but for the point at T = 4.034,
/// which lies 6 % below the line through its neighbours).
TEST(TwoPhaseDamBreak, front_is_that_of_the_experiment_but_for_its_start) {
  constexpr double late = 0.3;
  Column shifted("2.8575", ""), unshifted("2.8575", "");
  for (const auto& [time, place] : experiment) {
    shifted.advance_to(time - late);
    EXPECT_NEAR(shifted.front() / place, 1, time == 4.034 ? 0.08 : 0.05) << "T = " << time;
    unshifted.advance_to(time);
    EXPECT_GT(unshifted.front() / place, 1.08) << "T = " << time;
    EXPECT_LT(unshifted.front() / place, 1.20) << "T = " << time;
  }
}

/// The splash at the end wall included, no particle becomes faster than twice the tip of a dam break, 2 sqrt(g 2a).
TEST(TwoPhaseDamBreak, nothing_is_shot_out_of_the_water) {
  Column water("1.905", "");
  double largest = 0;
  while (water.simulation().time() < 0.3) {
    water.simulation().advance(0.3);
    largest = std::max(largest, water.speed());
  }
  EXPECT_LT(largest, 2 * 2 * std::sqrt(g * 2 * a));
}

/// Steps a hundredth of those that the limits allow: what a step does wrong at the surface must not add up. (It did
/// where volume was balanced with other weights than those with which the pressure pushes the particles outside.)
TEST(TwoPhaseDamBreak, surface_is_calm_in_short_steps) {
  for (const char* cell : {"5.715", "2.8575"}) {
    Column water(cell, "time_step: 10 us");
    double largest = 0;
    for (int i = 0; i < 4000; ++i) {
      water.simulation().advance(1);
      largest = std::max(largest, water.speed());
    }
    EXPECT_LT(largest, 0.9) << cell;  // 40 ms after the start the front moves at 0.7 m/s
  }
}

namespace {

// ---- against a box (Koshizuka & Oka 1996) ----

/// A column of 0.146 m by 0.292 m in a tank with a box of 24 mm by 48 mm on its floor: its splash runs along walls in
/// films that are thinner than a cell.
std::string against_a_box(double courant, bool join_films) {
  return fmt::format(
      "schema: 1\nphysics: two_phase\ngrid: {{min: [0 m, 0 m], max: [0.584 m, 0.876 m], cell: 7.3 mm}}\n"
      "gravity: [0, -9.81 m/s2]\nmaterials: {{w: {{model: water}}}}\n"
      "bodies: [{{material: w, box: {{min: [0 m, 0 m], max: [146 mm, 292 mm]}}}}]\n"
      "obstacles: {{box: {{box: {{min: [292 mm, -10 mm], max: [316 mm, 48 mm]}}}}}}\n"
      "boundaries: {{bottom: roller, left: roller, right: roller}}\nscheme: {{courant: {}}}\n"
      "water: {{initial: {{method: hydrostatic, level: 292 mm}}, join_films: {}}}\noutflow: remove\nend_time: 1 s\n",
      courant, join_films);
}

constexpr std::array<double, 2> steps_of_splashes{0.3, 0.4};
constexpr double end_of_splash = 0.75;  // [s]

}  // namespace

// It comes to the end in steps of two lengths, with all points but a drop or two that fly over the tank, and never with
// more energy than at the start: no film throws its points away. A tenth of a percent is for the errors of the
// projection in the first steps.
TEST(DamBreakAgainstABox, Splashes) {
  for (const double courant : steps_of_splashes) {
    const auto simulation = Simulation::create(parse_case(against_a_box(courant, true), "box.yaml"));
    const auto mechanical = [&] { return energy(*simulation, "kinetic") + energy(*simulation, "potential"); };
    const double start = mechanical();
    const std::size_t points = simulation->particles().size();
    double most = 0;
    while (simulation->time() < end_of_splash) {
      simulation->advance(end_of_splash);
      most = std::max(most, mechanical() / start);
    }
    EXPECT_LT(most, 1.001) << courant;
    EXPECT_GE(simulation->particles().size() + 2, points) << courant;
  }
}

// The negative control: films whose nodes move on their own burst. When they do is chance; here they do in both.
TEST(DamBreakAgainstABox, BurstsWhereFilmsAreNotJoined) {
  int burst = 0;
  for (const double courant : steps_of_splashes) {
    const auto simulation = Simulation::create(parse_case(against_a_box(courant, false), "box.yaml"));
    try {
      simulation->advance_to(end_of_splash);
    } catch (const PhysicsError&) {
      ++burst;
    }
  }
  EXPECT_GE(burst, 1);
}

// ---- a film on a floor that leans ----

// A single row of points, an eighth of a cell above a rough floor: its two nodes at the floor move as one, and friction
// is that of all its weight: g (sin - mu cos) t^2 / 2. Tolerance: the weight compresses the film, some 1e-5 of its way.
TEST(ThinFilm, SlidesWithTheFrictionOfItsWeight) {
  const double slope = 0.5, friction = 0.2, cosine = 1 / std::hypot(1.0, slope);
  const auto simulation = simulate(
      {.grid = "{min: [0 m, 0 m], max: [4 m, 4 m], cell: 0.5 m}",
       .material = "{model: linear_elastic, density: 1600 kg/m3, youngs_modulus: 1 MPa, poisson_ratio: 0, water: "
                   "{porosity: 0.4, permeability: 1e-4 m/s}}",
       .bodies = "  - {material: soil, box: {min: [0 m, 0 m], max: [4 m, 0.125 m]}, particles_per_cell: 16}",
       .gravity = fmt::format("[{} m/s2, {} m/s2]", g * slope * cosine, -g * cosine),
       .boundaries =
           fmt::format("{{left: periodic, right: periodic, bottom: {{normal: fixed, friction: {}}}}}", friction),
       .physics = "two_phase"});
  simulation->advance_to(0.5);
  const double expected = 0.5 * 0.25 * g * cosine * (slope - friction);
  const Particles& particles = simulation->particles();
  for (std::size_t p = 0; p < particles.size(); ++p) {
    ASSERT_NEAR(particles.displacement(p, 0), expected, 1e-4 * expected) << p;
    ASSERT_NEAR(particles.displacement(p, 1), 0, 1e-4 * expected) << p;
  }
}

}  // namespace sluice
