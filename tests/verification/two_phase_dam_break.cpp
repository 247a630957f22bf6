/// Collapse of a column of water twice as high as wide on a smooth bed. Its front is compared with potential flow
/// without friction, and with the experiment of Martin & Moyce (1952), n^2 = 2; and a surface must stay calm in
/// steps of any length.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

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

}  // namespace sluice
