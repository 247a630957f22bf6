/// The explicit two-phase step and the projection, on the same column of compressible water: two discretisations of the
/// same equations, v-w-p.
#include "tests/verification/saturated_column.h"

namespace sluice {
namespace {

constexpr double load = 1000;  // [Pa]

SaturatedColumn column(const std::string& formulation, int cells) {
  SaturatedColumn column;
  column.soil = sand(1e-3);
  column.soil.water_bulk_modulus = 5e8;
  column.cells = cells;
  column.formulation = formulation;
  column.load = "[[0 s, 0 Pa], [5 ms, 1 kPa]]";
  return column;
}

struct Answer {
  std::vector<double> pressure, height;
  std::string limiter;
  std::int64_t steps;
};

Answer run(const SaturatedColumn& column, double time) {
  const auto simulation = simulate(column);
  Answer answer;
  answer.height = heights(simulation->particles());
  answer.limiter = simulation->advance(time).limiter;
  simulation->advance_to(time);
  answer.pressure = by_id(simulation->particles(), "pore_pressure");
  answer.steps = simulation->steps();
  return answer;
}

double difference(const Answer& a, const Answer& b) {
  double sum = 0;
  for (std::size_t p = 0; p < a.pressure.size(); ++p) sum += std::pow((a.pressure[p] - b.pressure[p]) / load, 2);
  return std::sqrt(sum / static_cast<double>(a.pressure.size()));
}

// The projection damps the sound that it does not follow, and the explicit step does not: the load comes slowly beside
// the 2 ms of sound up and down. What is left are the errors of both in space and time, 1 % at 40 cells, less on more.
TEST(ExplicitTwoPhase, AgreesWithTheProjection) {
  const Answer sound = run(column("explicit", 40), 0.02), projected = run(column("v-w-p", 40), 0.02);
  EXPECT_EQ(sound.limiter, "sound");
  EXPECT_EQ(projected.limiter, "wave");
  EXPECT_GT(sound.steps, 5 * projected.steps);
  const double fine = difference(sound, projected);
  EXPECT_LT(fine, 0.01);
  EXPECT_LT(fine, difference(run(column("explicit", 10), 0.02), run(column("v-w-p", 10), 0.02)));
}

}  // namespace
}  // namespace sluice
