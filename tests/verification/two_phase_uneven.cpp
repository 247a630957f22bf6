/// Particles that lie unevenly, as they do in soil that has deformed. A pressure that is the same everywhere then
/// pushes the nodes about, by an error of the sums over particles that grows with the pressure and not with its
/// gradient. In a deep column it is larger than what the gradient does, and a projection that does not count with it
/// overshoots in every step by more than it corrects (docs/theory.md, 9.4). Exact: Terzaghi; nothing there knows of
/// particles.
#include <random>

#include "physics/exact/terzaghi.h"
#include "tests/verification/saturated_column.h"

namespace sluice {
namespace {

constexpr double load = 1000;  // [Pa]

/// The column, two cells wide, with points moved by up to a tenth of a cell on each axis.
std::unique_ptr<Simulation> disturbed(const SaturatedColumn& column) {
  constexpr int wide = 2;
  SceneText text = column.scene();
  const double h = column.cell();
  const auto corner = [&](double up) {
    return column.dimension == 2 ? fmt::format("[{} m, {} m]", wide * h, up)
                                 : fmt::format("[{0} m, {0} m, {1} m]", wide * h, up);
  };
  const std::string zero = column.point(0, 0);
  text.grid = fmt::format("{{min: {}, max: {}, cell: {} m}}", zero, corner(column.height + 2 * h), h);
  text.bodies = fmt::format("  - {{material: soil, box: {{min: {}, max: {}}}}}", zero, corner(column.height));
  auto simulation = simulate(text);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> shift(-0.1 * h, 0.1 * h);
  Particles& particles = simulation->particles();
  for (int a = 0; a < particles.dimension; ++a)
    set_column(particles, "position", a, [&](const auto& x) { return x[static_cast<std::size_t>(a)] + shift(random); });
  return simulation;
}

SaturatedColumn deep(const std::string& formulation, double conductivity, double courant, int cells = 100) {
  SaturatedColumn column;
  column.soil = sand(conductivity);
  column.cells = cells;
  column.load = "1 kPa";
  column.initial = "{method: uniform, pressure: 1 kPa}";
  column.formulation = formulation;
  column.scheme = column.scheme.with(fmt::format("courant: {}", courant));
  return column;
}

/// Against Terzaghi, as a share of the load, at a time factor.
double error(const SaturatedColumn& column, double T) {
  const exact::ConsolidatingLayer layer{.soil = column.soil, .height = column.height, .load = load};
  const auto simulation = disturbed(column);
  const auto height = heights(simulation->particles());
  const double t = T * column.height * column.height / column.soil.consolidation_coefficient();
  simulation->advance_to(t);
  return pressure_error(simulation->particles(), height, [&](double z) { return layer.pressure(z, t); }) / load;
}
/// The run ends early, or is off by more than the load.
bool breaks(const SaturatedColumn& column, double T) {
  try {
    return !(error(column, T) < 1);
  } catch (const std::exception&) {
    return true;
  }
}

// 1 % of the load, when the shock has died that moving the points gives the soil; 0.1 % with points that lie evenly.
// The rest is that of points whose volume is not the space that they have.
TEST(UnevenPoints, ConsolidateAsEvenOnes) {
  for (const char* formulation : {"u-p", "v-w-p"})
    for (const double courant : {0.2, 0.5, 0.9}) {
      SCOPED_TRACE(fmt::format("{}, Courant {}", formulation, courant));
      EXPECT_LT(error(deep(formulation, 1e-3, courant), 0.05), 0.01);
      EXPECT_LT(error(deep(formulation, 1e-4, courant, 30), 0.01), 0.01);
    }
}

TEST(UnevenPoints, ConsolidateWithFlipAndInThreeDimensions) {
  for (const char* formulation : {"u-p", "v-w-p"}) {
    SaturatedColumn column = deep(formulation, 1e-3, 0.5);
    column.scheme.transfer = "flip";
    EXPECT_LT(error(column, 0.05), 0.01);
    column.scheme.transfer = "apic";
    column.dimension = 3;
    column.cells = 50;
    EXPECT_LT(error(column, 0.05), 0.01);
  }
}

// What makes it hard is the depth in cells.
TEST(UnevenPoints, ConsolidateInADeepColumn) {
  for (const char* formulation : {"u-p", "v-w-p"}) EXPECT_LT(error(deep(formulation, 1e-3, 0.5, 200), 0.05), 0.01);
}

// Soft soil that a load has pressed together by a fifth, the points as they then lie: it goes on to rest. The rate form
// of elasticity makes the final height exp(-q / M).
TEST(UnevenPoints, OfSoilPressedTogetherComeToRest) {
  for (const char* formulation : {"u-p", "v-w-p"}) {
    SaturatedColumn column;
    column.soil.modulus = 1e5;
    column.soil.conductivity = 2e-2;
    column.cells = 80;
    column.formulation = formulation;
    column.load = "[[0 s, 0 kPa], [2 s, 23 kPa]]";
    const auto top = [](const Simulation& simulation) {
      const auto height = heights(simulation.particles());
      return *std::max_element(height.begin(), height.end());
    };
    const auto simulation = simulate(column);
    const double before = top(*simulation);
    simulation->advance_to(8);
    EXPECT_LT(simulation->largest_speed(), 1e-3) << formulation;
    EXPECT_NEAR(top(*simulation) / (before * std::exp(-0.23)), 1, 2e-3);
  }
}

// The control.
TEST(UnevenPoints, BreakWithoutStabilisation) {
  for (const char* formulation : {"u-p", "v-w-p"})
    for (const double conductivity : {1e-3, 1e-4}) {
      SaturatedColumn column = deep(formulation, conductivity, 0.5);
      column.water = "stabilisation: false, ";
      EXPECT_TRUE(breaks(column, 0.01)) << formulation << ", k = " << conductivity;
    }
}

}  // namespace
}  // namespace sluice
