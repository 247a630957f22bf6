/// Saturated soil under its own weight: settling after it was deposited at once, and at rest. Sources: (EX.5), (EX.6),
/// and hydrostatics.
#include "physics/exact/terzaghi.h"
#include "tests/verification/saturated_column.h"

namespace sluice {
namespace {

constexpr double unit_weight = 9810;  // of water [N/m3]

// Deposited at once: the water carries all the weight at first. Excess pressures within 1 % of the largest from T =
// 0.05 to 1, settlement within 1 % of the final one.
TEST(SelfWeight, ConsolidatesAsTheSolution) {
  for (const char* formulation : {"u-p", "v-w-p"})
    for (const int dimension : {2, 3}) {
      SCOPED_TRACE(fmt::format("{}, {}-D", formulation, dimension));
      SaturatedColumn column;
      column.soil = sand(1e-3);
      column.dimension = dimension;
      column.cells = 20;
      column.formulation = formulation;
      column.gravity = dimension == 2 ? "[0, -9.81]" : "[0, 0, -9.81]";
      column.scheme = column.scheme.with("courant: 0.9");
      const exact::ConsolidatingLayer layer{
          .soil = column.soil, .height = 1, .self_weight = column.soil.buoyant_unit_weight()};
      const auto simulation = simulate(column);
      Particles& particles = simulation->particles();
      const double whole = column.soil.density() * 9.81;
      set_column(particles, "pore_pressure", 0, [&](const auto& x) { return whole * (1 - x[dimension - 1]); });
      set_column(particles, "pore_pressure_gradient", dimension - 1, [&](const auto&) { return -whole; });
      const auto start = heights(particles);
      const std::vector<double> factors = dimension == 2 ? std::vector{0.05, 0.2, 0.5, 1.0} : std::vector{0.05, 0.2};
      for (const double T : factors) {
        const double t = T / column.soil.consolidation_coefficient();
        simulation->advance_to(t);
        const auto exact = [&](double z) { return layer.pressure(z, t) + unit_weight * (1 - z); };
        EXPECT_LT(pressure_error(particles, start, exact), 0.01 * layer.self_weight) << T;
        const auto now = heights(particles);
        const double final = layer.self_weight / (2 * column.soil.modulus);
        for (std::size_t p = 0; p < now.size(); ++p)
          ASSERT_NEAR(now[p] - start[p], layer.displacement(start[p], t), 0.01 * final) << T << ", " << start[p];
      }
    }
}

// Ten seconds at rest, with the surface on the edge of cells and inside of them: the pressure is that of water at rest
// to 1 % of the largest, the kinetic energy stays below 1e-8 of m g H, nothing creeps.
TEST(SelfWeight, AtRestNothingMoves) {
  for (const char* formulation : {"u-p", "v-w-p"})
    for (const double height : {1.0, 0.95}) {
      SCOPED_TRACE(fmt::format("{}, height {}", formulation, height));
      SaturatedColumn column;
      column.soil = sand(1e-3);
      column.cells = 10;
      column.formulation = formulation;
      column.gravity = "[0, -9.81]";
      column.initial = fmt::format("{{method: hydrostatic, level: {} m}}", height);
      column.initial_stress = "{method: elastic_equilibrium}";
      SceneText scene = column.scene();
      scene.grid = "{min: [0 m, 0 m], max: [1 m, 1.2 m], cell: 0.1 m}";
      scene.bodies = fmt::format("  - {{material: soil, box: {{min: [0 m, 0 m], max: [1 m, {} m]}}}}", height);
      const auto simulation = simulate(scene);
      const Particles& particles = simulation->particles();
      const auto start = heights(particles);
      const double weight = sum(by_id(particles, "mass")) * 9.81;
      double early = 0, late = 0, noise = 0;
      while (simulation->time() < 10) {
        simulation->advance(10);
        const double kinetic = energy(*simulation, "kinetic") / weight;
        (simulation->time() < 5 ? early : late) = std::max(simulation->time() < 5 ? early : late, kinetic);
        if (simulation->steps() % 100 == 0)
          noise =
              std::max(noise, pressure_error(particles, start, [&](double z) { return unit_weight * (height - z); }));
      }
      EXPECT_LT(noise, 0.01 * unit_weight * height);
      EXPECT_LT(early, 1e-8);
      EXPECT_LE(late, early);
      const auto end = heights(particles);
      for (std::size_t p = 0; p < end.size(); ++p) ASSERT_NEAR(end[p], start[p], 0.01 * column.cell());
    }
}

}  // namespace
}  // namespace sluice
