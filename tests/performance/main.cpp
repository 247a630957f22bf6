/// Measures particle-steps per second on the dam, against the plain kernel of plain_kernel.h, in one run.
///
///   sluice_performance [--smoke] [--sizes 1 0.25 0.125] [--only linear]
///   sluice_performance --mappings    every shape function and transfer instead, on the dam itself
///   sluice_performance --solver      the sparse solvers instead (solver.h)
///   sluice_performance --two-phase [--only step]   steps with pore water instead (two_phase.h)
///   sluice_performance --materials   the constitutive models alone (materials.h)
///
/// `--only` leaves out the kernels whose names do not contain the word; the plain one stays.
/// Every figure is a rate of bursts taken in turn (plain, linear, quadratic, …, plain, …), so that a machine whose
/// speed drifts disturbs all alike; ratios are medians of the ratios within a turn. The state is that of the dam while
/// it slides.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "core/case/case.h"
#include "core/parallel/parallel.h"
#include "core/simulation/simulation.h"
#include "core/transfer/shape_kernels.h"
#include "core/transfer/transfer_scheme.h"
#include "materials.h"
#include "plain_kernel.h"
#include "solver.h"
#include "two_phase.h"

namespace {

using namespace sluice;

const std::string case_file = std::string(SLUICE_CASES_DIR) + "/12_lower_san_fernando_paper.yaml";

Case dam(double cell, const std::string& shape, const std::string& transfer, const std::string& timing) {
  const std::string h = fmt::format("{} m", cell), dt = fmt::format("{} s", 1e-3 * cell);
  return load_case(case_file, {{"grid.cell", h},
                               {"scheme.time_step", dt},
                               {"scheme.shape", shape},
                               {"scheme.transfer", transfer},
                               {"scheme.stress_update", timing},
                               {"end_time", "1000 s"}});
}

/// The same particles, in the order of their creation, for the plain kernel.
struct Plain {
  plain::Body body;
  plain::Grid grid;
  std::vector<plain::Material> materials;
  double dt;

  Plain(const Case& definition, const Simulation& simulation) : dt(*definition.scheme.fixed_time_step) {
    const Particles& ps = simulation.particles();
    const std::size_t n = ps.size();
    for (auto* column :
         {&body.x, &body.y, &body.vx, &body.vy, &body.m, &body.V, &body.sxx, &body.syy, &body.szz, &body.sxy})
      column->resize(n);
    body.ep.assign(n, 0);
    body.material.resize(n);
    const auto column = [&](ColumnId id, int c, std::vector<double>& to) {
      for (std::size_t p = 0; p < n; ++p) to[static_cast<std::size_t>(ps.id[p])] = ps.columns.data(id, c)[p];
    };
    column(ps.position, 0, body.x), column(ps.position, 1, body.y);
    column(ps.velocity, 0, body.vx), column(ps.velocity, 1, body.vy);
    column(ps.mass, 0, body.m), column(ps.volume, 0, body.V);
    column(ps.stress, 0, body.sxx), column(ps.stress, 1, body.syy), column(ps.stress, 2, body.szz),
        column(ps.stress, 3, body.sxy);
    for (std::size_t p = 0; p < n; ++p) body.material[static_cast<std::size_t>(ps.id[p])] = ps.material[p];
    const GridCase& g = definition.grid;
    grid.x0 = g.min[0], grid.y0 = g.min[1], grid.h = g.cell[0];
    grid.nx = static_cast<int>(std::lround((g.max[0] - g.min[0]) / g.cell[0])) + 1;
    grid.ny = static_cast<int>(std::lround((g.max[1] - g.min[1]) / g.cell[1])) + 1;
    grid.friction = definition.faces.at("bottom").friction;
    const auto nodes = static_cast<std::size_t>(grid.nx) * static_cast<std::size_t>(grid.ny);
    for (auto* field : {&grid.m, &grid.px, &grid.py, &grid.fx, &grid.fy, &grid.vx, &grid.vy, &grid.ax, &grid.ay})
      field->resize(nodes);
    // Table 1 of the case, in the order of its materials.
    const double lambda = 2e6 * 0.3 / (1.3 * 0.4), shear = 2e6 / 2.6, degree = M_PI / 180;
    const std::map<std::string, std::pair<double, double>> strength = {{"rolled_fill", {31, 14.4e3}},
                                                                       {"ground_shale", {27, 24e3}},
                                                                       {"clay_core", {0, 30e3}},
                                                                       {"upper_hydraulic_fill", {35, 1}},
                                                                       {"lower_hydraulic_fill", {35, 1}},
                                                                       {"drain", {37, 1}},
                                                                       {"berm", {37, 4.8e3}},
                                                                       {"liquefied", {0, 2e3}}};
    for (const auto& name : ps.material_names) {
      const auto [phi, c] = strength.at(name);
      materials.push_back({lambda, shear, std::sin(phi * degree), std::cos(phi * degree), c, 0});
    }
  }
  void step() { plain::step(body, grid, materials, -9.81, dt); }
};

struct Contestant {
  std::string name;
  int threads;
  std::function<void()> step;
  std::vector<double> rates = {};  // million particle-steps per second, one a turn
};

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

/// Median over the turns of the ratio of two contestants' rates.
double ratio(const Contestant& a, const Contestant& b) {
  std::vector<double> ratios;
  for (std::size_t i = 0; i < a.rates.size(); ++i) ratios.push_back(a.rates[i] / b.rates[i]);
  return median(ratios);
}

void take_turns(std::vector<Contestant>& contestants, std::size_t particles, int turns, double seconds) {
  using Clock = std::chrono::steady_clock;
  for (int turn = -1; turn < turns; ++turn)  // the first turn warms up and is not counted
    for (auto& c : contestants) {
      set_thread_count(c.threads);
      c.step();
      const auto start = Clock::now();
      double elapsed = 0;
      std::size_t steps = 0;
      while (elapsed < seconds) {
        c.step();
        ++steps;
        elapsed = std::chrono::duration<double>(Clock::now() - start).count();
      }
      if (turn >= 0) c.rates.push_back(static_cast<double>(steps * particles) / elapsed / 1e6);
    }
}

void print_stages(const std::string& name, const Simulation& simulation) {
  double total = 0;
  for (const auto& [stage, seconds] : simulation.stage_seconds()) total += seconds;
  fmt::print("    {:<28}", name);
  for (const auto& [stage, seconds] : simulation.stage_seconds())
    if (seconds > 0) fmt::print(" {} {:.0f} %", stage, 100 * seconds / total);
  fmt::print("\n");
}

/// Returns the linear one-thread rate.
double compare(double cell, const std::string& kernels, int turns, double seconds, double in_cache_rate) {
  const Case linear_case = dam(cell, "linear", "flip", "usf");
  const Case quadratic_case = dam(cell, "quadratic_bspline", "apic", "usl");
  const double far = 1000;
  set_thread_count(2);
  const auto warmed = [&](const Case& definition) {
    auto simulation = Simulation::create(definition);
    for (int i = 0; i < static_cast<int>(1000 * cell); ++i) simulation->advance(far);
    return simulation;
  };
  const auto linear = warmed(linear_case), quadratic = warmed(quadratic_case);
  Plain reference(linear_case, *linear);
  const std::size_t particles = linear->particles().size();
  std::vector<Contestant> all = {
      {"plain linear USF", 1, [&] { reference.step(); }},
      {"linear FLIP USF", 1, [&] { linear->advance(far); }},
      {"linear FLIP USF", 2, [&] { linear->advance(far); }},
      {"quadratic APIC USL", 1, [&] { quadratic->advance(far); }},
      {"quadratic APIC USL", 2, [&] { quadratic->advance(far); }},
  };
  std::erase_if(all, [&](const Contestant& c) {
    return c.name.find(kernels) == std::string::npos && !c.name.starts_with("plain");
  });
  take_turns(all, particles, turns, seconds);
  fmt::print("{} particles (cells of {} m)\n", particles, cell);
  fmt::print("  {:<22}{:>8}{:>20}{:>16}{:>20}\n", "kernel", "threads", "10^6 p-steps/s", "times plain",
             "times one thread");
  for (std::size_t i = 0; i < all.size(); ++i)
    fmt::print("  {:<22}{:>8}{:>20.1f}{:>16.2f}{:>20}\n", all[i].name, all[i].threads, median(all[i].rates),
               ratio(all[i], all[0]), all[i].threads == 2 ? fmt::format("{:.2f}", ratio(all[i], all[i - 1])) : "");
  print_stages("linear FLIP USF", *linear);
  print_stages("quadratic APIC USL", *quadratic);
  if (in_cache_rate > 0)
    fmt::print("  linear, one thread: {:.0f} % of the rate of the smallest size\n",
               100 * median(all[1].rates) / in_cache_rate);
  return median(all[1].rates);
}

/// Every shape function with FLIP, and every transfer with quadratic B-splines, on one thread. Stresses
/// are updated first: linear functions do not survive the slide otherwise.
void compare_mappings(bool smoke) {
  std::vector<std::pair<std::string, std::string>> schemes;
  for (const auto& shape : shape_registry<2>().names()) schemes.emplace_back(shape, "flip");
  for (const auto& transfer : transfer_registry().names())
    if (transfer != "flip") schemes.emplace_back("quadratic_bspline", transfer);
  std::stable_sort(schemes.begin(), schemes.end(),
                   [](const auto& a, const auto& b) { return (a.first == "linear") > (b.first == "linear"); });
  const double far = 1000;
  std::vector<std::unique_ptr<Simulation>> simulations;
  std::vector<Contestant> all;
  set_thread_count(1);
  for (const auto& [shape, transfer] : schemes) {
    simulations.push_back(Simulation::create(dam(1, shape, transfer, "usf")));
    for (int i = 0; i < 100; ++i) simulations.back()->advance(far);
    all.push_back({shape + ", " + transfer, 1, [s = simulations.back().get(), far] { s->advance(far); }});
  }
  take_turns(all, simulations[0]->particles().size(), smoke ? 1 : 7, smoke ? 0.02 : 0.15);
  fmt::print("Mappings: {} particles, one thread\n", simulations[0]->particles().size());
  fmt::print("  {:<28}{:>16}{:>24}\n", "shape, transfer", "10^6 p-steps/s", "cost, times linear");
  for (const auto& c : all) fmt::print("  {:<28}{:>16.1f}{:>24.2f}\n", c.name, median(c.rates), ratio(all[0], c));
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<double> cells;
  std::string kernels;
  bool smoke = false, solver = false, water = false, materials = false, mappings = false;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--smoke")
      smoke = true;
    else if (word == "--solver")
      solver = true;
    else if (word == "--mappings")
      mappings = true;
    else if (word == "--two-phase")
      water = true;
    else if (word == "--materials")
      materials = true;
    else if (word == "--only" && i + 1 < argc)
      kernels = argv[++i];
    else if (word != "--sizes")
      cells.push_back(std::stod(word));
  }
  if (solver || smoke) measure_solvers(smoke);
  if (water || smoke) measure_two_phase(smoke, kernels == "step");
  if (materials || smoke) measure_materials(smoke);
  if (mappings || smoke) compare_mappings(smoke);
  if (solver || water || materials || mappings) return 0;
  if (cells.empty()) cells = smoke ? std::vector<double>{1} : std::vector<double>{1, 0.25, 0.125};
  double in_cache = 0;
  for (const double cell : cells) {
    const double rate = compare(cell, kernels, smoke ? 1 : 7, smoke ? 0.05 : 0.5, in_cache);
    if (in_cache == 0) in_cache = rate;
  }
  return 0;
}
