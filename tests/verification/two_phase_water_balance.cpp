/// Where the water is and where it goes: its mass, closed boxes, given pressures, heads and fluxes on faces.
#include "tests/verification/saturated_column.h"

namespace sluice {
namespace {

constexpr double unit_weight = 9810;  // of water [N/m3]

/// Mean over particles at heights in [low, high) of a column of the particles.
double mean_between(const Particles& particles, const std::string& name, int component, double low, double high) {
  const auto z = heights(particles), values = by_id(particles, name, component);
  double sum = 0, count = 0;
  for (std::size_t p = 0; p < z.size(); ++p)
    if (z[p] >= low && z[p] < high) sum += values[p], count += 1;
  return sum / count;
}

// ---- mass ----

/// A soft column that a load presses together by a fifth.
SaturatedColumn oedometer(const std::string& formulation) {
  SaturatedColumn column;
  column.soil = sand(1e-2);
  column.soil.modulus = 1e5;
  column.cells = 20;
  column.formulation = formulation;
  column.load = "[[0 s, 0 Pa], [5 s, 23 kPa]]";
  column.scheme = column.scheme.with("courant: 0.8");
  return column;
}

// By construction: grains keep their mass to the last digit, and what is no grain is water, to 1e-10. Independent of
// that: Darcy's flux through the top, from the gradient of the pressure in the topmost points, adds up to the water
// that was lost, to 2.5 %: its gradient is that half a cell below the surface, where the flux of a column of 20 cells
// that compacts evenly, which grows with the height, is 2.5 % less. The control, a book-keeping that gives each point
// the water of the start, would be wrong by half.
TEST(WaterBalance, OfADrainedOedometer) {
  for (const char* formulation : {"u-p", "v-w-p"}) {
    SCOPED_TRACE(formulation);
    const SaturatedColumn column = oedometer(formulation);
    const auto simulation = simulate(column);
    const Particles& particles = simulation->particles();
    const auto grains = by_id(particles, "solid_mass");
    const double volume = sum(by_id(particles, "volume")), mass = sum(by_id(particles, "mass"));
    double outflow = 0;  // per area
    while (simulation->time() < 30) {
      const auto z = heights(particles);
      const double top = *std::max_element(z.begin(), z.end());
      const StepInfo step = simulation->advance(30);
      outflow -= step.dt * column.soil.conductivity / unit_weight *
                 mean_between(particles, "pore_pressure_gradient", 1, top - 0.1 * column.cell(), 2);
    }
    EXPECT_EQ(by_id(particles, "solid_mass"), grains);
    const auto v = by_id(particles, "volume"), n = by_id(particles, "porosity"), m = by_id(particles, "mass");
    const double lost = volume - sum(v), water = 1000 * dot(v, n);
    EXPECT_NEAR(lost / volume, 0.2, 0.02);
    EXPECT_NEAR((sum(m) + 1000 * lost) / mass, 1, 1e-10);
    EXPECT_NEAR((sum(grains) + water) / sum(m), 1, 1e-10);
    EXPECT_NEAR(outflow * column.cell() / lost, 1, 0.5 / column.cells);
    EXPECT_GT(0.4 * volume / dot(v, n), 1.9) << "water of the start over that of now";
  }
}

// ---- closed boxes ----

SaturatedColumn box(const std::string& formulation) {
  SaturatedColumn column;
  column.cells = 10;
  column.room = 0;
  column.formulation = formulation;
  return column;
}

SceneText closed(const SaturatedColumn& column) {
  SceneText scene = column.scene();
  scene.boundaries.insert(1, "top: roller, ");
  return scene;
}

/// Mean pressure after water has entered a closed box, over its volume over n V / K.
double filling(const std::string& formulation, int cells) {
  SaturatedColumn column = box(formulation);
  column.cells = cells;
  column.soil.water_bulk_modulus = 1e8;
  column.faces = "{top: {flux: [[0 s, -1 mm/s], [0.05 s, -1 mm/s], [0.0501 s, 0 m/s]]}}";
  const auto simulation = simulate(closed(column));
  simulation->advance_to(0.1);
  const auto p = by_id(simulation->particles(), "pore_pressure");
  return sum(p) / static_cast<double>(p.size()) / (1e-3 * 0.05005 * 1e8 / 0.4);
}

// Water that enters raises the mean pressure by its volume over n V / K: exactly with u-p, but for the round number of
// steps. With v-w-p half of it comes in with the nodes on the face, whose relative velocity is that of the soil around
// them, half a cell inside: an error of first order, here where the flow falls from q at the face to nothing.
TEST(ClosedBox, HoldsItsMeanPressureByTheStiffnessOfTheWater) {
  EXPECT_NEAR(filling("u-p", 10), 1, 0.01);
  const double coarse = 1 - filling("v-w-p", 10), fine = 1 - filling("v-w-p", 20);
  EXPECT_LT(std::abs(coarse), 0.06);
  EXPECT_LT(std::abs(fine), 0.6 * std::abs(coarse));
}

// No water in, no mean pressure: weight makes it fall from the bottom to the top around zero.
TEST(ClosedBox, WeightLeavesTheMeanPressure) {
  SaturatedColumn column = box("u-p");
  column.soil.water_bulk_modulus = 2.2e9;
  column.gravity = "[0, -9.81]";
  column.initial_stress = "{method: elastic_equilibrium}";
  const auto simulation = simulate(closed(column));
  simulation->advance_to(1);
  const auto p = by_id(simulation->particles(), "pore_pressure"), z = heights(simulation->particles());
  EXPECT_NEAR(sum(p) / static_cast<double>(p.size()), 0, 0.01 * unit_weight);
  for (std::size_t i = 0; i < p.size(); ++i) EXPECT_NEAR(p[i], unit_weight * (0.5 - z[i]), 0.01 * unit_weight) << z[i];
}

TEST(ClosedBox, OfIncompressibleWaterIsAnError) {
  for (const char* formulation : {"u-p", "v-w-p"}) {
    SaturatedColumn column = box(formulation);
    column.gravity = "[0, -9.81]";
    const auto simulation = simulate(closed(column));
    try {
      simulation->advance(1);
      ADD_FAILURE() << "nothing determines the pressure";
    } catch (const CaseError& error) {
      const std::string message = error.what();
      for (const char* part : {"is not determined", "incompressible and closed in", "bulk_modulus, or drain it"})
        EXPECT_NE(message.find(part), std::string::npos) << message;
    }
  }
}

// ---- faces ----

/// Stiff and pervious: the flow follows what happens on the faces within milliseconds.
SaturatedColumn pervious(const std::string& formulation, const std::string& faces) {
  SaturatedColumn column;
  column.soil = sand(1e-2);
  column.soil.modulus = 1e8;
  column.cells = 20;
  column.formulation = formulation;
  column.faces = faces;
  return column;
}

// A pressure gamma_w 0.5 t at the base makes the steady flow q = k 0.5 t / H. Where the correction of the pressure is
// taken to be zero on such a face, none would flow. 1 %: the pressure trails by H^2 / (3 c_v), 4 ms of the second.
TEST(Faces, PressureThatRisesDrivesSteadyFlow) {
  for (const char* formulation : {"u-p", "v-w-p"}) {
    const auto simulation = simulate(pervious(formulation, "{bottom: {pressure: [[0 s, 0 Pa], [1 s, 4905 Pa]]}}"));
    simulation->advance_to(1);
    const Particles& particles = simulation->particles();
    const auto p = by_id(particles, "pore_pressure"), slope = by_id(particles, "pore_pressure_gradient", 1);
    const auto z = heights(particles);
    // n times the relative velocity, or what Darcy's law makes of the gradient.
    std::vector<double> flow = formulation[0] == 'v' ? by_id(particles, "relative_velocity", 1) : slope;
    for (double& f : flow) f *= formulation[0] == 'v' ? 0.4 : -1e-2 / unit_weight;
    for (std::size_t i = 0; i < p.size(); ++i) {
      EXPECT_NEAR(p[i], 4905 * (1 - z[i]), 0.01 * 4905) << formulation << " at " << z[i];
      EXPECT_NEAR(slope[i], -4905, 0.02 * 4905) << formulation << " at " << z[i];
      EXPECT_NEAR(flow[i], 5e-3, 1e-4) << formulation << " at " << z[i];
    }
  }
}

// Water that enters through the base with 2 mm/s needs the gradient q / k, 0.2 of its weight.
TEST(Faces, FluxMakesItsGradient) {
  for (const char* formulation : {"u-p", "v-w-p"}) {
    const auto simulation = simulate(pervious(formulation, "{bottom: {flux: -2 mm/s}}"));
    simulation->advance_to(0.2);
    const auto p = by_id(simulation->particles(), "pore_pressure"), z = heights(simulation->particles());
    for (std::size_t i = 0; i < p.size(); ++i)
      EXPECT_NEAR(p[i], 0.2 * unit_weight * (1 - z[i]), 0.002 * unit_weight) << formulation << " at " << z[i];
  }
}

/// A block between a wall of water on the left and a lower one on the right, under a lid: flow along x.
SceneText confined(double width, double cell, const std::string& permeability, const std::string& faces) {
  SaturatedColumn column;
  column.cells = 10;
  column.room = 0;
  column.permeability = permeability;
  column.faces = faces;
  column.gravity = "[0, -9.81]";
  column.initial = "{method: steady_seepage}";
  column.initial_stress = "{method: elastic_equilibrium}";
  SceneText scene = closed(column);
  scene.grid = fmt::format("{{min: [0 m, 0 m], max: [{} m, 1 m], cell: [{} m, 0.1 m]}}", width, cell);
  scene.bodies = fmt::format("  - {{material: soil, box: {{min: [0 m, 0 m], max: [{} m, 1 m]}}}}", width);
  return scene;
}

// Two heads: p falls along x from one hydrostatic column to the other, and stays so.
TEST(Faces, HeadsDriveHorizontalFlow) {
  const auto simulation = simulate(confined(1, 0.1, "1 mm/s", "{left: {head: 3 m}, right: {head: 2 m}}"));
  simulation->advance_to(0.2);
  const Particles& particles = simulation->particles();
  const auto p = by_id(particles, "pore_pressure"), x = by_id(particles, "position"), z = heights(particles);
  for (std::size_t i = 0; i < p.size(); ++i)
    EXPECT_NEAR(p[i], unit_weight * (3 - x[i] - z[i]), 0.01 * unit_weight) << x[i] << ", " << z[i];
}

// Soil that lets water pass four times as well along x is, twice as long, the same as isotropic soil: exactly so on
// cells that are twice as long. From the left to the top, so that water flows along both axes.
TEST(Faces, UnequalPermeabilitiesStretchTheFlow) {
  const std::string faces = "{left: {pressure: 10 kPa}, top: {pressure: 0 Pa}, right: impermeable}";
  const auto wide = simulate(confined(2, 0.2, "[4 mm/s, 1 mm/s]", faces));
  const auto plain = simulate(confined(1, 0.1, "1 mm/s", faces));
  const auto p = by_id(wide->particles(), "pore_pressure"), q = by_id(plain->particles(), "pore_pressure");
  ASSERT_EQ(p.size(), q.size());
  for (std::size_t i = 0; i < p.size(); ++i) EXPECT_NEAR(p[i], q[i], 1e-6 * 10e3);
  EXPECT_GT(largest_magnitude(by_id(plain->particles(), "pore_pressure_gradient", 0)), 1000);
  // The step holds the flow that the steady solution found, but for the cells around the corner where the given
  // pressure jumps.
  wide->advance_to(0.5);
  const Particles& particles = wide->particles();
  const auto later = by_id(particles, "pore_pressure"), x = by_id(particles, "position"), z = heights(particles);
  for (std::size_t i = 0; i < p.size(); ++i)
    if (std::hypot(x[i] / 2, 1 - z[i]) > 0.3) {
      EXPECT_NEAR(later[i], p[i], 0.02 * 10e3) << x[i] << ", " << z[i];
    }
}

}  // namespace
}  // namespace sluice
