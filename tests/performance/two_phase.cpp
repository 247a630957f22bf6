#include "two_phase.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "core/case/case.h"
#include "core/parallel/parallel.h"
#include "core/simulation/simulation.h"
#include "physics/exact/terzaghi.h"

namespace {

using namespace sluice;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

/// A saturated block of soil under its own weight, `cells` of 1 m along each axis (the last one up), 4 or 8 points
/// each.
Case saturated_block(const std::vector<int>& cells, const std::string& physics, const std::string& formulation) {
  std::string top, zeros, corner;
  for (std::size_t a = 0; a < cells.size(); ++a) {
    const bool up = a + 1 == cells.size();
    zeros += a == 0 ? "0 m" : ", 0 m";
    corner += fmt::format("{}{} m", a == 0 ? "" : ", ", cells[a]);
    top += fmt::format("{}{} m", a == 0 ? "" : ", ", cells[a] + (up ? 4 : 0));
  }
  const bool wet = physics == "two_phase";
  const std::string pores = wet ? ", water: {porosity: 0.4, permeability: 1e-6 m/s}" : "";
  std::string text = fmt::format(
      "schema: 1\nphysics: {}\ngrid: {{min: [{}], max: [{}], cell: 1 m}}\n"
      "gravity: [{}-9.81 m/s2]\nmaterials:\n  soil: {{model: mohr_coulomb, density: {} kg/m3, youngs_modulus: 50 MPa, "
      "friction_angle: 35 deg, cohesion: 5 kPa{}}}\n"
      "bodies: [{{material: soil, box: {{min: [{}], max: [{}]}}}}]\n"
      "boundaries: {{bottom: roller, left: roller, right: roller{}}}\n"
      "scheme: {{shape: quadratic_bspline, transfer: apic, stress_update: usl}}\nend_time: 1000 s\n",
      physics, zeros, top, cells.size() == 2 ? "0, " : "0, 0, ", wet ? 1590 : 1990, pores, zeros, corner,
      cells.size() == 2 ? "" : ", front: roller, back: roller");
  if (wet)
    text += fmt::format(
        "water: {{formulation: {}, bulk_modulus: 2.2 GPa, initial: {{method: hydrostatic, level: {} m}}}}\n",
        formulation, cells.back());
  return parse_case(text, "benchmark.yaml");
}

struct Runner {
  std::string name;
  std::unique_ptr<Simulation> simulation;
  std::vector<double> step_seconds = {};  // one a turn

  Runner(std::string what, const Case& definition)
      : name(std::move(what)), simulation(Simulation::create(definition)) {}
};

/// Steps in turns, `steps` a turn; the first turn is not counted.
void take_turns(std::vector<Runner>& runners, int turns, int steps) {
  for (int turn = -1; turn < turns; ++turn)
    for (Runner& runner : runners) {
      const auto start = Clock::now();
      for (int i = 0; i < steps; ++i) runner.simulation->advance(1000);
      if (turn >= 0) runner.step_seconds.push_back(seconds_since(start) / steps);
    }
}

double pressure_share(const Simulation& simulation) {
  double all = 0;
  const auto stages = simulation.stage_seconds();
  for (const auto& [stage, seconds] : stages) all += seconds;
  return (stages.at("pressure_assembly") + stages.at("pressure_solve")) / all;
}

double total(const Simulation& simulation, const std::string& name) {
  for (const auto& [key, value] : simulation.totals())
    if (key == name) return value;
  return 0;
}

void compare_step(const std::vector<int>& cells, int turns, int steps, bool both) {
  std::vector<Runner> runners;
  runners.emplace_back("total_stress", saturated_block(cells, "total_stress", ""));
  runners.emplace_back("two_phase u-p", saturated_block(cells, "two_phase", "u-p"));
  if (both) runners.emplace_back("two_phase v-w-p", saturated_block(cells, "two_phase", "v-w-p"));
  take_turns(runners, turns, steps);
  for (const Runner& runner : runners) {
    std::vector<double> ratios;
    for (std::size_t i = 0; i < runner.step_seconds.size(); ++i)
      ratios.push_back(runner.step_seconds[i] / runners[0].step_seconds[i]);
    const auto numbers = runner.simulation->step_numbers();
    const double unknowns = numbers.empty() ? 0 : numbers[0].second;
    const double solves = total(*runner.simulation, "pressure_solves");
    fmt::print("  {:<4}{:>10}{:>10}  {:<16}{:>12.2f}{:>10.2f}", fmt::format("{}-D", cells.size()),
               runner.simulation->particles().size(), unknowns, runner.name, 1e3 * median(runner.step_seconds),
               median(ratios));
    if (solves > 0)
      fmt::print("{:>12.0f} %{:>12.2f}{:>12.1f}", 100 * pressure_share(*runner.simulation),
                 total(*runner.simulation, "pressure_factorizations") / solves,
                 total(*runner.simulation, "pressure_iterations") / solves);
    fmt::print("\n");
  }
}

void print_stages(const Simulation& simulation) {
  double all = 0;
  for (const auto& [stage, seconds] : simulation.stage_seconds()) all += seconds;
  for (const auto& [stage, seconds] : simulation.stage_seconds())
    if (seconds > 0) fmt::print("    {:<20}{:>6.1f} %\n", stage, 100 * seconds / all);
}

// ---- projection against explicit ----

constexpr double load = 10e3, modulus = 10e6 * 0.7 / (1.3 * 0.4), conductivity = 1e-6;

/// A layer of 1 m, `across` cells wide and `high` cells high, that consolidates under a load on its top.
Case layer(int across, int high, const std::string& formulation, double end) {
  const double h = 1.0 / high, width = across * h;
  return parse_case(
      fmt::format("schema: 1\nphysics: two_phase\ngrid: {{min: [0 m, 0 m], max: [{0} m, {1} m], cell: {2} m}}\n"
                  "materials:\n  soil: {{model: linear_elastic, density: 1855 kg/m3, youngs_modulus: 10 MPa, "
                  "water: {{porosity: 0.3, permeability: {3} m/s}}}}\n"
                  "bodies: [{{material: soil, box: {{min: [0 m, 0 m], max: [{0} m, 1 m]}}}}]\n"
                  "boundaries: {{bottom: roller, left: roller, right: roller}}\nsurface_loads: [{{pressure: {4} Pa}}]\n"
                  "water: {{formulation: {5}, bulk_modulus: 2.2 GPa, initial: {{method: uniform, pressure: {4} Pa}}}}\n"
                  "end_time: {6} s\n",
                  width, 1 + 2 * h, h, conductivity, load, formulation, end),
      "layer.yaml");
}

/// Root-mean-square error of the pressure over the load.
double error(const Simulation& simulation, double time) {
  const Particles& ps = simulation.particles();
  const double factor = conductivity * modulus / (1000 * 9.81);
  double sum = 0;
  for (std::size_t p = 0; p < ps.size(); ++p) {
    const double z = ps.columns.data(ps.initial_position, 1)[p];
    const double exact = exact::terzaghi_pressure(1 - z, factor * time);
    sum += std::pow(ps.columns.data(ps.columns.find("pore_pressure"))[p] / load - exact, 2);
  }
  return std::sqrt(sum / static_cast<double>(ps.size()));
}

void compare_explicit(int across, int high, double end) {
  double seconds[2];
  fmt::print("\nProjection against explicit step: consolidating layer, k = 1e-6 m/s, K_w = 2.2 GPa, to {} s\n", end);
  for (int i = 0; i < 2; ++i) {
    const std::string name = i == 0 ? "u-p" : "explicit";
    const auto simulation = Simulation::create(layer(across, high, name, end));
    const auto start = Clock::now();
    simulation->advance_to(end);
    seconds[i] = seconds_since(start);
    fmt::print("  {:<10}{:>8} particles{:>9} steps{:>10.2f} s   rms error of the pressure {:.3f} %\n", name,
               simulation->particles().size(), simulation->steps(), seconds[i], 100 * error(*simulation, end));
  }
  fmt::print("  the projection is {:.1f} times as fast\n", seconds[1] / seconds[0]);
}

}  // namespace

void measure_two_phase(bool smoke, bool step_alone) {
  set_thread_count(2);
  fmt::print("Two-phase step beside that of total_stress on the same particles, two threads\n");
  fmt::print("  {:<4}{:>10}{:>10}  {:<16}{:>12}{:>10}{:>14}{:>12}{:>12}\n", "", "particles", "unknowns", "physics",
             "ms a step", "times", "pressure", "factors", "iterations");
  if (smoke) {
    compare_step({20, 10}, 1, 5, true);
    compare_explicit(4, 10, 0.002);
    return;
  }
  compare_step({100, 50}, 7, 40, true);
  if (!step_alone) {
    compare_step({360, 250}, 5, 5, false);
    compare_step({720, 500}, 3, 3, false);
    compare_step({40, 40, 18}, 3, 3, false);
  }
  Runner runner("", saturated_block({100, 50}, "two_phase", "u-p"));
  for (int i = 0; i < 300; ++i) runner.simulation->advance(1000);
  fmt::print("  where the time of a step goes, {} particles:\n", runner.simulation->particles().size());
  print_stages(*runner.simulation);
  if (!step_alone) compare_explicit(100, 50, 0.02);
}
