/// What each model gets wrong in a column: the chart of models, worked verdicts, and loads that come and stay.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "physics/advice/column.h"
#include "physics/exact/terzaghi.h"

namespace sluice::advice {
namespace {

std::size_t index(ColumnModel model) {
  return static_cast<std::size_t>(std::ranges::find(models, model) - models.begin());
}
const std::size_t drained = index(ColumnModel::drained), undrained = index(ColumnModel::undrained),
                  quasi_static = index(ColumnModel::quasi_static), u_p = index(ColumnModel::u_p),
                  full = index(ColumnModel::full);

exact::SaturatedSoil soil(double conductivity, double modulus, double porosity = 0.4) {
  exact::SaturatedSoil s;
  s.conductivity = conductivity;
  s.modulus = modulus;
  s.porosity = porosity;
  s.water_bulk_modulus = 2.2e9;
  return s;
}

/// A soil, a height and a frequency that have these groups.
ColumnErrors at(double lg_pi_1, double lg_pi_2) {
  exact::SaturatedSoil s = soil(1, 1e7);
  s.solid_density = 1000 * (2 - s.porosity) / (1 - s.porosity);  // rho_w / rho = 1/2
  s.water_bulk_modulus = s.porosity * 99 * s.modulus;            // kappa = 0.99
  const double speed = std::sqrt(100 * s.modulus / s.density()), omega = std::pow(10, lg_pi_2 / 2) * speed;
  s.conductivity = std::pow(10, lg_pi_1) * s.gravity * 0.5 * omega / (speed * speed);
  return column_errors(s, 1, {omega, 0});
}

// The chart of the cheapest model within 5 % for n = 0.4, rho_w / rho = 0.5, kappa = 0.99, from an independent program.
// Columns lg Pi1 = -5, -4.5 ... 4. The advisor sees soils, heights and frequencies, and must find the groups.
TEST(AdviceColumn, IsTheChartOfModels) {
  const std::pair<double, const char*> chart[] = {{1.0, "UUUUPPFFFFFFFFFFFFF"},  {0.5, "UUUUUUUFFFFFFFFFFFF"},
                                                  {0.0, "UUUUUUPPFFFFFFFFFFF"},  {-0.5, "UUUUUPPPPFFFFFFFFFF"},
                                                  {-1.0, "UUUUUCCCCCFFFFFFFFF"}, {-1.5, "UUUUUCCCCCCFFFFFFFF"},
                                                  {-2.0, "UUUUUCCCCCCCFFFFFFF"}, {-3.0, "UUUUUCCCCCCCCCFFFFF"},
                                                  {-4.0, "UUUUUCCCCCCCCCCCCCD"}, {-6.0, "UUUUUCCCCCCCCCCCCCD"}};
  for (const auto& [lg2, row] : chart) {
    std::string computed;
    for (int i = 0; i < 19; ++i) computed += "DUCPF"[at(-5 + 0.5 * i, lg2).simplest(0.05)];
    EXPECT_EQ(computed, row) << "lg Pi2 = " << lg2;
  }
}

// The flow slide of a dam of hydraulic fill: 20 m, soft, k = 1e-5 ... 1e-7 m/s, 50 s. In that time it loses at most 2 %
// of its pressure (T_d = 2e-4 ... 2e-6): undrained.
TEST(AdviceColumn, ADamThatFlowsIsUndrained) {
  for (const double k : {1e-5, 1e-6, 1e-7}) {
    const ColumnErrors found = column_errors(soil(k, 2.7e6), 20, Loading::within(50));
    EXPECT_NEAR(found.groups.drainage(), 22 * k, 0.01 * 22 * k);
    EXPECT_EQ(found.simplest(0.05), undrained) << k;
  }
  EXPECT_NEAR(column_errors(soil(1e-5, 2.7e6), 20, Loading::within(50)).worst(undrained), 0.0209, 2e-4);
}

// The same dam shaken at 2 Hz: the water has no inertia of its own (Pi3 = 2e-5), and an elastic column would be
// undrained (T_d = 5e-7). That shaking builds up pressure is no matter of the column, but of the soil:
// Advice.Shaking...
TEST(AdviceColumn, ADamThatIsShakenHasWaterThatFollows) {
  const ColumnErrors found = column_errors(soil(1e-5, 2.7e6), 20, Loading::at_frequency(2));
  EXPECT_NEAR(found.groups.pi_3(), 2.5e-5, 3e-6);
  EXPECT_NEAR(found.groups.drainage(), 5.5e-7, 0.2e-7);
  EXPECT_LT(found.worst(u_p), 1e-3);
  EXPECT_NEAR(found.worst(undrained), std::pow(5.5e-7 / 2, 0.25), 0.007);
}

// A drain of gravel in it, k = 0.1 m/s: Pi3 = 0.25 at 2 Hz. The water does not follow the grains.
TEST(AdviceColumn, AGravelDrainThatIsShakenIsForVwp) {
  const ColumnErrors found = column_errors(soil(0.1, 2.7e6), 5, Loading::at_frequency(2));
  EXPECT_NEAR(found.groups.pi_3(), 0.25, 0.03);
  EXPECT_GT(found.worst(u_p), 0.05);
  EXPECT_EQ(found.simplest(0.05), full);
}

// Toyoura sand in a centrifuge: 10 m, 1 Hz, M = 50 MPa, k = 2e-4 m/s. Pi3 = 2.6e-4, T_d = 1.6e-3: u-p.
TEST(AdviceColumn, ACentrifugeIsForUp) {
  const ColumnErrors found = column_errors(soil(2e-4, 50e6), 10, Loading::at_frequency(1));
  EXPECT_NEAR(found.groups.drainage(), 1.6e-3, 1e-4);
  EXPECT_NEAR(found.groups.pi_3(), 2.6e-4, 2e-5);
  EXPECT_GE(found.simplest(0.05), quasi_static);
  EXPECT_LE(found.simplest(0.05), u_p);
}

// Beads of 1 mm that collapse in a laboratory: 0.1 m, 10 Hz, k = 1e-2 m/s. Pi3 = 0.13: v-w-p.
TEST(AdviceColumn, BeadsThatCollapseAreForVwp) {
  const ColumnErrors found = column_errors(soil(1e-2, 1e6), 0.1, Loading::at_frequency(10));
  EXPECT_NEAR(found.groups.pi_3(), 0.13, 0.01);
  EXPECT_EQ(found.simplest(0.05), full);
}

// Half-space and series meet; the mean is the integral of the share.
TEST(AdviceColumn, SharesOfThePressureAreTerzaghis) {
  EXPECT_NEAR(drained_share(1e-3 * (1 - 1e-9)), drained_share(1e-3), 1e-6);
  EXPECT_NEAR(mean_drained_share(1e-3 * (1 - 1e-9)), mean_drained_share(1e-3), 1e-6);
  EXPECT_NEAR(drained_share(0.197), 0.50034, 1e-5);  // the table of Terzaghi's solution
  for (const double T : {0.01, 0.3, 2.0}) {
    double sum = 0;
    constexpr int n = 20000;
    for (int i = 0; i < n; ++i) sum += drained_share((i + 0.5) / n * T) / n;
    EXPECT_NEAR(mean_drained_share(T), sum, 1e-5) << T;
  }
}

// A load that comes slowly is drained, one that comes at once is not, and between them neither is: T = 0.1 and 0.4 are
// the bounds that finite-element codes use for 10 % and 70 %, which hold for the water that has left a mean distance.
TEST(AdviceColumn, SlowLoadsAreDrainedAndFastOnesAreNot) {
  const exact::SaturatedSoil s = soil(1e-5, 1e7);
  const auto after = [&](double T) { return column_errors(s, 1, Loading::within(T / s.consolidation_coefficient())); };
  EXPECT_EQ(after(1e-3).simplest(0.05), undrained);
  EXPECT_EQ(after(0.1).simplest(0.05), quasi_static);
  EXPECT_EQ(after(1).simplest(0.05), quasi_static);
  EXPECT_EQ(after(7).simplest(0.05), drained);
}

// A load that is there from the start drains or does not, however short the run: nothing comes in that time, so that
// water needs no inertia. The control is a load that comes in it.
TEST(AdviceColumn, LoadsThatAreThereSetNothingInMotion) {
  const exact::SaturatedSoil s = soil(1e-3, 13.46e6, 0.3);
  EXPECT_GT(column_errors(s, 1, Loading::within(0.003)).worst(u_p), 0.05);
  const ColumnErrors found = column_errors(s, 1, Loading::for_a_time(0.003));
  EXPECT_EQ(found.worst(u_p), 0);
  EXPECT_DOUBLE_EQ(found.worst(undrained), drained_share(found.time_factor));
}

}  // namespace
}  // namespace sluice::advice
