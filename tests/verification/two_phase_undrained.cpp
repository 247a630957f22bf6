/// A load that comes at once on soil that cannot drain: the water takes it, p = q, without ringing. Time steps far
/// below the time of a wave through a cell are the hard case (Vermeer & Verruijt 1981 and others; docs/theory.md,
/// section 9). Overshoot is counted as usual after 200 steps, below the topmost cell, where the pressure falls to the
/// drained end.
#include <Eigen/Dense>
#include <numbers>

#include "tests/verification/saturated_column.h"

namespace sluice {
namespace {

constexpr double load = 1000;  // [Pa]

SaturatedColumn column(const std::string& formulation, const std::string& shape, double courant, bool stabilised) {
  SaturatedColumn column;
  column.soil = sand(1e-8);
  column.load = "1 kPa";
  column.formulation = formulation;
  column.water = fmt::format("stabilisation: {}, ", stabilised);
  column.scheme.shape = shape;
  column.scheme = column.scheme.with(fmt::format("courant: {}", courant));
  return column;
}

struct Extremes {
  double least = INFINITY, largest = -INFINITY;  ///< of p / q
  void add(double p) { least = std::min(least, p), largest = std::max(largest, p); }
};

/// Below the topmost cell, at the end of each of `steps` steps; the last entry is what is looked at.
std::vector<Extremes> pressures(const SaturatedColumn& column, int steps) {
  const auto simulation = simulate(column);
  const auto height = heights(simulation->particles());
  std::vector<Extremes> all;
  for (int i = 0; i < steps; ++i) {
    simulation->advance(1e6);
    const auto pressure = by_id(simulation->particles(), "pore_pressure");
    Extremes now;
    for (std::size_t p = 0; p < pressure.size(); ++p)
      if (height[p] < column.height - column.cell()) now.add(pressure[p] / load);
    all.push_back(now);
  }
  return all;
}

constexpr const char* formulations[] = {"u-p", "v-w-p"};
constexpr const char* shapes[] = {"linear", "quadratic_bspline"};

// 12 % at every step length. With the shortest steps 200 of them are ten times of a wave through a cell, too short for
// the transient of the next test to die; then 1000, and the pressure neither rings nor sags by more than 12 %.
TEST(UndrainedLoad, DoesNotRing) {
  for (const char* formulation : formulations)
    for (const char* shape : shapes)
      for (const double courant : {0.05, 0.1, 0.2, 0.41, 0.6, 0.9}) {
        SCOPED_TRACE(fmt::format("{}, {}, Courant {}", formulation, shape, courant));
        const auto found = pressures(column(formulation, shape, courant, true), courant < 0.1 ? 1000 : 200);
        EXPECT_LT(found[199].largest, 1.12);
        EXPECT_LT(found.back().largest, 1.12);
        EXPECT_GT(found.back().least, 0.88);
      }
}

// What the stabilisation costs: it lets no pressure change at once. The water takes up a sudden load like a mass on a
// spring, to nearly twice the load and back, with the period pi h / c, one for the whole column. It is over after the
// time of some waves through a cell, which the grid does not resolve, and not there if the load takes ten of those to
// come.
TEST(UndrainedLoad, StabilisedWaterTakesAMomentToRespond) {
  const SaturatedColumn sudden = column("u-p", "quadratic_bspline", 0.05, true);
  const auto found = pressures(sudden, 1000);
  const auto first = std::max_element(found.begin(), found.begin() + 100,
                                      [](const Extremes& a, const Extremes& b) { return a.largest < b.largest; });
  EXPECT_GT(first->largest, 1.5);
  EXPECT_LT(first->largest, 2.1);
  EXPECT_NEAR((first - found.begin() + 1) * 0.05, std::numbers::pi / 2, 0.1 * std::numbers::pi / 2);
  for (auto late = found.begin() + 500; late != found.end(); ++late) EXPECT_LT(late->largest, 1.12);

  SaturatedColumn slow = sudden;
  const double wave = slow.cell() / std::sqrt(slow.soil.modulus / slow.soil.density());  // time of one through a cell
  slow.load = fmt::format("[[0 s, 0 kPa], [{} s, 1 kPa]]", 10 * wave);
  for (const Extremes& step : pressures(slow, 1000)) EXPECT_LT(step.largest, 1.12);
}

// The control. A point-based code maps the pressure from vertices to points and back in every step, which damps what
// rings: without stabilisation it shows 20 to 50 % here, not the 84 % of the scheme on a mesh, below.
TEST(UndrainedLoad, RingsWithoutStabilisation) {
  for (const char* formulation : formulations)
    for (const char* shape : shapes) {
      const auto found = pressures(column(formulation, shape, 0.05, false), 200);
      EXPECT_GT(found.back().largest, 1.2) << formulation << ", " << shape;
      EXPECT_GT(found.front().largest, 0.9) << "without delay";
    }
}

/// The incremental projection on a mesh of linear elements, as published, for a soil that cannot drain: largest p / q
/// below the top after some steps. With `stabilised`, tau = max(0, h^2 / (4 M) - dt^2 / rho) joins the Laplacian.
double largest_on_mesh(double courant, bool stabilised, int steps) {
  const exact::SaturatedSoil soil = sand(0);
  const int cells = 40;
  const double h = 1.0 / cells, rho = soil.density(), M = soil.modulus, dt = courant * h * std::sqrt(rho / M);
  const double tau = stabilised ? std::max(0.0, h * h / (4 * M) - dt * dt / rho) : 0;
  Eigen::MatrixXd laplacian = Eigen::MatrixXd::Zero(cells, cells);  // without the top vertex, where p = 0
  for (int i = 0; i < cells; ++i) {
    laplacian(i, i) = i == 0 ? 1 : 2;
    if (i > 0) laplacian(i, i - 1) = laplacian(i - 1, i) = -1;
  }
  const Eigen::LLT<Eigen::MatrixXd> solver(laplacian * (dt / rho + tau / dt) / h);
  Eigen::VectorXd v = Eigen::VectorXd::Zero(cells + 1), p = v, mass = Eigen::VectorXd::Constant(cells + 1, rho * h);
  Eigen::VectorXd stress = Eigen::VectorXd::Zero(cells);
  mass[0] = mass[cells] = rho * h / 2;
  const auto accelerate = [&](const Eigen::VectorXd& total) {  // by the total stress of the elements; the base is fixed
    for (int e = 0; e < cells; ++e) v[e] += dt * total[e] / mass[e], v[e + 1] -= dt * total[e] / mass[e + 1];
    v[0] = 0;
  };
  const auto means = [&](const Eigen::VectorXd& at) -> Eigen::VectorXd {
    return (at.head(cells) + at.tail(cells)) / 2;
  };
  for (int step = 0; step < steps; ++step) {
    accelerate(stress - means(p));
    v[cells] -= dt * load / mass[cells];
    Eigen::VectorXd volume = Eigen::VectorXd::Zero(cells + 1), change = volume;
    for (int e = 0; e < cells; ++e)
      for (const int i : {e, e + 1}) volume[i] -= (v[e + 1] - v[e]) / 2;
    change.head(cells) = solver.solve(volume.head(cells));
    p += change;
    accelerate(-means(change));
    for (int e = 0; e < cells; ++e) stress[e] += M * dt * (v[e + 1] - v[e]) / h;
  }
  return p.head(cells).maxCoeff() / load;
}

// What is cured: above 80 % on a mesh at a twentieth of the critical step; and the cure there.
TEST(UndrainedLoad, RingsOnAMeshAsPublished) {
  EXPECT_GT(largest_on_mesh(0.05, false, 200), 1.8);
  EXPECT_LT(largest_on_mesh(0.9, false, 200), 1.12);
  EXPECT_LT(largest_on_mesh(0.05, true, 1000), 1.12);
}

// The stabilisation goes with the compliance of the skeleton, which is large where the soil is liquefied. It is capped
// there: no pressure goes astray, and nothing moves faster than a fall.
TEST(UndrainedLoad, OfLiquefiedSoilStaysBounded) {
  for (const double modulus : {1e6, 1e4, 1e2})
    for (const double step : {1e-5, 1e-3}) {
      SCOPED_TRACE(fmt::format("M = {} Pa, steps of {} s", modulus, step));
      SaturatedColumn soft = column("u-p", "quadratic_bspline", 0.5, true);
      soft.soil.modulus = modulus;
      soft.cells = 20;
      soft.gravity = "[0, -9.81]";
      soft.load = "";
      soft.initial = "{method: hydrostatic, level: 1 m}";
      soft.scheme = soft.scheme.with(fmt::format("time_step: {} s", step));
      const double weight = soft.soil.density() * 9.81;
      if (step > 0.5 * soft.cell() / std::sqrt(modulus / soft.soil.density())) continue;
      const auto simulation = simulate(soft);
      double largest = 0;
      for (int i = 0; i < 500; ++i) {
        simulation->advance(1e6);
        largest = std::max(largest, largest_magnitude(by_id(simulation->particles(), "pore_pressure")));
      }
      EXPECT_LT(largest, 2.1 * weight) << "twice the weight of the column";
      EXPECT_LT(simulation->largest_speed(), 9.81 * simulation->time());
    }
}

}  // namespace
}  // namespace sluice
