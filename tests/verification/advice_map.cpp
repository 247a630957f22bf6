/// Is the advice good? Over the plane of Pi1 (drainage) and Pi2 (inertia) of a saturated column under a harmonic load,
/// the program runs all models that it has, and what each gets wrong is measured against Biot's closed form. The
/// cheapest model whose measured error is inside the tolerance is to be the one that the advisor takes.
///
/// The advisor sees the case only: it finds the way of the water, the stiffnesses and the groups by itself, and the
/// cases in total stresses are those that `physics: auto` would make. Costs are the steps that were taken, times what a
/// step costs beside one of total_stress (1, 1, 3, 4.6: docs/performance.md).
///
/// docs/advisor/regenerate draws what this test records.
#include "physics/advice/judgement.h"
#include "tests/verification/harmonic_scene.h"

namespace sluice::harmonic {
namespace {

constexpr double tolerance = 0.05;
constexpr std::array<double, 4> cost_of_step{1, 1, 3, 4.6};

/// In the order of the advisor's choices.
constexpr std::array<ColumnModel, 4> model{ColumnModel::drained, ColumnModel::undrained, ColumnModel::u_p,
                                           ColumnModel::full};

/// Every zone of the plane. Where hardly any water leaves, the skin that drains is a hundredth of the height, and cells
/// are smaller. Columns of total stresses have no damping but that of the scheme: loads near a resonance, Pi2 = 2.5
/// (and 0.25 for the drained column, which is far off there), grow over more periods. Where periods are long beside
/// waves, ten cells are as good as twenty.
const Point plane[] = {{-3.5, 0, 6, 40}, {-2.5, 0.5, 24, 40}, {-4, -1, 4, 60},  {-3, -0.5, 5, 40},
                       {-2, 0.7, 8, 40}, {-2, -0.5, 5},       {-1, -0.5, 5},    {-1, -2, 2},
                       {0, -2, 2},       {0, 0, 6},           {0.5, -1, 4},     {1, -2, 2},
                       {-0.5, 1, 8, 40}, {1, -3, 2, 10},      {2, -3.5, 2, 10}, {3, -4, 2, 10}};

std::string case_text(const Oscillation& oscillation) {
  return oscillation.column.scene().text() +
         fmt::format("advice: {{frequency: {} Hz, tolerance: {}}}\n", 1 / oscillation.period, tolerance);
}

/// Half of the limit of the step in every model, as by default.
int steps_in_a_period(const Oscillation& oscillation, std::size_t choice) {
  const exact::SaturatedSoil& soil = oscillation.column.soil;
  const double stiff = choice == 1 ? soil.modulus + soil.water_bulk_modulus / soil.porosity : soil.modulus;
  const double mass = choice >= 2 ? (1 - soil.porosity) * soil.solid_density : soil.density();
  return static_cast<int>(std::ceil(2 * oscillation.period / oscillation.column.cell() * std::sqrt(stiff / mass)));
}

Amplitudes run_choice(const Point& point, std::size_t choice, int cells) {
  const Oscillation oscillation(point, "v-w-p", cells);
  const Case definition = parse_case(case_text(oscillation), "column.yaml");
  Case taken = advice::with_choice(definition, advice::numbers_of(definition), choice);
  const int steps = steps_in_a_period(oscillation, choice);
  taken.scheme.fixed_time_step = oscillation.period / steps;
  const auto simulation = Simulation::create(taken);
  const double ratio = oscillation.column.soil.undrained_ratio();
  return run(*simulation, oscillation, steps, [&](const Particles& particles) {
    if (choice >= 2) return by_id(particles, "pore_pressure");
    auto pressure = by_id(particles, "stress", 1);
    for (double& p : pressure) p *= choice == 0 ? 0 : -ratio;
    return pressure;
  });
}

/// What is measured at a point, and what was said.
struct Finding {
  std::array<double, 4> measured{}, predicted{}, cost{};
  std::size_t advised = 0, cheapest = 3;
};

Finding findings(const Point& point) {
  Finding found;
  const Oscillation oscillation(point, "v-w-p", point.cells);
  const advice::Judgement judgement = advice::judge(parse_case(case_text(oscillation), "column.yaml"));
  found.advised = judgement.taken;
  for (std::size_t c = 0; c < model.size(); ++c) {
    const auto predicted = exact::model_error(model[c], oscillation.groups);
    Amplitudes limit = run_choice(point, c, point.cells);
    const bool near = std::max(predicted.displacement, predicted.pressure) < 0.3;  // else the coarse column will do
    if (near) limit = extrapolated(limit, run_choice(point, c, 2 * point.cells));
    const auto measured = error(limit, closed_form(ColumnModel::full, oscillation.groups, limit.depth));
    found.measured[c] = std::max(measured.displacement, measured.pressure);
    found.predicted[c] = std::max(predicted.displacement, predicted.pressure);
    found.cost[c] = steps_in_a_period(oscillation, c) * cost_of_step[c];
    EXPECT_NEAR(judgement.choices[c].demand.error, found.predicted[c], 1e-6 + 1e-3 * found.predicted[c]) << c;
  }
  for (std::size_t c = 0; c < model.size(); ++c)
    if (found.measured[c] < tolerance && found.cost[c] < found.cost[found.cheapest]) found.cheapest = c;
  return found;
}

class Advice : public ::testing::TestWithParam<Point> {};

// Never a model that is outside of the tolerance, and at none of the points one that costs more than it had to: how
// often the advice errs on the safe side is part of the test. (Where an error is predicted beside the tolerance what
// the discretisation adds, 1 to 3 %, might decide; no point lies there.)
TEST_P(Advice, IsTheCheapestModelWithinTheTolerance) {
  const Point& point = GetParam();
  const Finding found = findings(point);
  const std::string text = fmt::format(
      "{} {} advised {} cheapest {} measured {:.4f} {:.4f} {:.4f} {:.4f} predicted {:.4f} {:.4f} {:.4f} {:.4f}",
      point.lg_pi_1, point.lg_pi_2, found.advised, found.cheapest, found.measured[0], found.measured[1],
      found.measured[2], found.measured[3], found.predicted[0], found.predicted[1], found.predicted[2],
      found.predicted[3]);
  RecordProperty("point", text);
  SCOPED_TRACE(text);
  EXPECT_LT(found.measured[found.advised], tolerance) << "the advice errs on the unsafe side";
  EXPECT_EQ(found.advised, found.cheapest) << "the advice errs on the safe side";
  EXPECT_LT(found.measured[3], 0.03) << "what is left of the discretisation of v-w-p";
}

INSTANTIATE_TEST_SUITE_P(Plane, Advice, ::testing::ValuesIn(plane));

/// What the advice is at a point, from the closed forms alone: the letter of the choice, as below.
char advice_at(const Point& point) {
  const Oscillation oscillation(point, "v-w-p", 10);
  std::size_t best = 3;
  double least = steps_in_a_period(oscillation, 3) * cost_of_step[3];
  for (std::size_t c = 0; c < 3; ++c) {
    const auto off = exact::model_error(model[c], oscillation.groups, 60);
    const double cost = steps_in_a_period(oscillation, c) * cost_of_step[c];
    if (std::max(off.displacement, off.pressure) < tolerance && cost < least) best = c, least = cost;
  }
  return "DUPF"[best];
}

// The map behind the points: recorded for the figure. Its corners are what they must be.
TEST(AdviceMap, CornersOfThePlane) {
  const auto at = [](double lg_1, double lg_2) { return advice_at({lg_1, lg_2, 1}); };
  EXPECT_EQ(at(-5, -4), 'U');
  EXPECT_EQ(at(4, -4), 'D');
  EXPECT_EQ(at(0, -3), 'P');
  EXPECT_EQ(at(3, 1), 'F');
  constexpr double step = 0.1;
  for (int row = 0; row <= 62; ++row) {
    std::string letters;
    for (int column = 0; column <= 95; ++column) letters += at(-5 + step * column, -5 + step * row);
    RecordProperty(fmt::format("row_{:02}", row), letters);
  }
}

}  // namespace
}  // namespace sluice::harmonic
