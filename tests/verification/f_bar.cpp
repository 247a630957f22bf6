/// F-bar on cell averages. Source: Coombs et al. (2018), in rates: the volumetric strain increment of a particle gives
/// way to the volume-weighted mean of its cell, the deviatoric one stays. Cells reach from node to node: with quadratic
/// B-splines, whose nodes stand in the middles of the grid's cells, they are those of the grid moved by half a cell.
#include <map>
#include <random>

#include "core/grid/geometry.h"
#include "core/transfer/shape_kernels.h"
#include "tests/verification/scene_fixture.h"

namespace sluice {
namespace {

std::unique_ptr<Simulation> block(int dimension, const Scheme& scheme, bool f_bar) {
  const bool flat = dimension == 2;
  return simulate(
      {.grid = flat ? "{min: [-9 m, -9 m], max: [9 m, 9 m], cell: 1 m}"
                    : "{min: [-6 m, -6 m, -6 m], max: [6 m, 6 m, 6 m], cell: 1 m}",
       .material = "{model: linear_elastic, density: 1000 kg/m3, youngs_modulus: 1 MPa, poisson_ratio: 0.3}",
       .bodies = flat ? "  - {material: soil, box: {min: [-6 m, -6 m], max: [6 m, 6 m]}}"
                      : "  - {material: soil, box: {min: [-3 m, -3 m, -3 m], max: [3 m, 3 m, 3 m]}}",
       .scheme = scheme.with(fmt::format("time_step: 1 ms, f_bar: {}", f_bar))});
}

struct Invariants {
  std::vector<double> mean;                   ///< (xx + yy + zz) / 3: the volumetric strain, times K
  std::vector<std::vector<double>> in_plane;  ///< what an equal change of all Dim axial strains leaves alone
};

Invariants invariants(const Particles& particles) {
  const int dimension = particles.dimension;
  std::vector<std::vector<double>> s;
  for (int c = 0; c < (dimension == 2 ? 4 : 6); ++c) s.push_back(by_id(particles, "stress", c));
  Invariants all;
  for (std::size_t p = 0; p < s[0].size(); ++p) all.mean.push_back((s[0][p] + s[1][p] + s[2][p]) / 3);
  for (int a = 1; a < dimension; ++a) {
    all.in_plane.push_back(s[0]);
    for (std::size_t p = 0; p < s[0].size(); ++p) all.in_plane.back()[p] -= s[static_cast<std::size_t>(a)][p];
  }
  for (std::size_t c = 3; c < s.size(); ++c) all.in_plane.push_back(s[c]);
  return all;
}

/// The cell from node to node that a particle stands in, as a key.
std::vector<std::array<int, 3>> cells(const Particles& particles, const std::string& shape) {
  const double shift = shape == "quadratic_bspline" ? 0.5 : 0;
  std::vector<std::array<int, 3>> all(particles.size(), {0, 0, 0});
  for (int a = 0; a < particles.dimension; ++a) {
    const auto x = by_id(particles, "position", a);
    for (std::size_t p = 0; p < x.size(); ++p)
      all[p][static_cast<std::size_t>(a)] = static_cast<int>(std::floor(x[p] + shift));
  }
  return all;
}

/// Cells from the rim of a body that notice in one step that nodes there see half of a field only: the farthest node
/// that does, and from there to its particles; so many for each mapping, and with quadratic B-splines half a cell more
/// to the others of a mean. An affine field shows them the other half.
double touched_by_rim(const Scheme& scheme) {
  const double mean = scheme.shape == "quadratic_bspline" ? 0.5 : 0;
  if (scheme.affine()) return 2 + mean;
  const double once = scheme.linear()                       ? 1
                      : scheme.shape == "ugimp"             ? 1.25
                      : scheme.shape == "quadratic_bspline" ? 2
                                                            : 3;
  const int mappings = 1 + (scheme.stress_update == "musl" ? 1 : 0) + (scheme.transfer == "xpic" ? 1 : 0);
  return std::max(2.0, once * mappings) + mean;
}

class FBar : public ::testing::TestWithParam<Scheme> {};

// A uniform volumetric strain is its own mean: the same stress as without F-bar, to round-off.
TEST_P(FBar, UniformVolumetricStrainIsUnchanged) {
  for (const int dimension : {2, 3}) {
    std::vector<Invariants> found;
    for (const bool f_bar : {false, true}) {
      const auto simulation = block(dimension, GetParam(), f_bar);
      for (int a = 0; a < dimension; ++a) {
        set_column(simulation->particles(), "velocity", a,
                   [&](const auto& x) { return -0.1 * x[static_cast<std::size_t>(a)]; });
        if (GetParam().affine())
          set_column(simulation->particles(), "affine_velocity", a * (dimension + 1), [](const auto&) { return -0.1; });
      }
      take_steps(*simulation, 1);
      found.push_back(invariants(simulation->particles()));
      if (GetParam().stress_update == "usf") continue;
      // Away from the rim, where nodes see half of the field only: K tr(de) = 1 MPa / (3 (1 - 0.6)) 0.1 dim dt.
      const auto x = by_id(simulation->particles(), "position", 0), y = by_id(simulation->particles(), "position", 1),
                 z = by_id(simulation->particles(), "position", dimension - 1);
      for (std::size_t p = 0; p < x.size(); ++p) {
        const bool inside = std::max({std::abs(x[p]), std::abs(y[p]), std::abs(z[p])}) <
                            (dimension == 2 ? 6 : 3) - touched_by_rim(GetParam());
        if (inside) {
          ASSERT_NEAR(found.back().mean[p], -1e6 / 1.2 * 0.1 * dimension * 1e-3, 1e-8)
              << dimension << "-D, f_bar " << f_bar;
        }
      }
    }
  }
}

// Random velocities strain the particles of a cell differently: a checkerboard and everything else that four or eight
// points can hold. With F-bar all particles of a cell have one mean stress, the volume-weighted mean of those without
// F-bar (particles are of equal volume), while the deviatoric part is as without. Tolerance: 1e-9 of the stresses,
// which are of the order of 1 kPa.
TEST_P(FBar, AVolumetricCheckerboardIsAveraged) {
  for (const int dimension : {2, 3}) {
    std::vector<Invariants> found;
    std::vector<std::array<int, 3>> cell;
    for (const bool f_bar : {false, true}) {
      const auto simulation = block(dimension, GetParam(), f_bar);
      std::mt19937 generator(3);
      std::normal_distribution<double> normal;
      for (int a = 0; a < dimension; ++a)
        set_column(simulation->particles(), "velocity", a, [&](const auto&) { return normal(generator); });
      // With USF the first step moves only, and the second strains; cells are those where strains are gathered.
      if (GetParam().stress_update == "usf") take_steps(*simulation, 1);
      cell = cells(simulation->particles(), GetParam().shape);
      take_steps(*simulation, 1);
      found.push_back(invariants(simulation->particles()));
    }
    struct Sum {
      double plain = 0, count = 0;
    };
    std::map<std::array<int, 3>, Sum> sums;
    for (std::size_t p = 0; p < cell.size(); ++p) {
      sums[cell[p]].plain += found[0].mean[p];
      ++sums[cell[p]].count;
    }
    double largest_change = 0;
    for (std::size_t p = 0; p < cell.size(); ++p) {
      const Sum& s = sums[cell[p]];
      ASSERT_NEAR(found[1].mean[p], s.plain / s.count, 1e-6) << dimension << "-D, particle " << p;
      largest_change = std::max(largest_change, std::abs(found[1].mean[p] - found[0].mean[p]));
      for (std::size_t i = 0; i < found[0].in_plane.size(); ++i)
        ASSERT_NEAR(found[1].in_plane[i][p], found[0].in_plane[i][p], 1e-6)
            << dimension << "-D, particle " << p << ", " << i;
    }
    EXPECT_GT(largest_change, 10) << "the field had nothing to average";
  }
}

/// The largest mean over cells, moved by `shift` of a cell, of the divergence of the motion that changes its sign from
/// node to node, in 1/h: the motion that would cost nothing if that mean were zero.
double mean_divergence_of_alternating_nodes(const std::string& name, double shift) {
  const auto shape = shape_registry<2>().find(name, {})();
  const GridGeometry<2> grid{{0, 0}, {20, 20}, {1, 1}, {20, 20}};
  double largest = 0;
  for (double cell = 8 - shift; cell < 12; ++cell) {
    double sum = 0;
    for (const double in_cell : {0.25, 0.75}) {
      std::array<double, domain_capacity<2>> domain{};
      shape->fill_domain(grid, 0.5, domain);
      const Stencil<2> s = shape->stencil(grid, {cell + in_cell, 9.5}, domain);
      for (std::size_t i = 0; i < static_cast<std::size_t>(s.count); ++i)
        sum += (s.node[i][0] % 2 == 0 ? 1 : -1) * s.gradient[i][0] / 2;
    }
    largest = std::max(largest, std::abs(sum));
  }
  return largest;
}

// Means over cells from node to node see the motion that alternates from node to node. The control: on the cells of the
// grid, quadratic B-splines hide it; clay that flows then gives way to it, and swells or carries too little.
TEST(CellsOfFBar, SeeTheMotionThatAlternatesFromNodeToNode) {
  for (const char* name : {"linear", "ugimp", "cubic_bspline", "quadratic_bspline"}) {
    const double shift = shape_registry<2>().find(name, {})()->node_shift();
    EXPECT_EQ(shift, std::string(name) == "quadratic_bspline" ? 0.5 : 0) << name;
    EXPECT_GT(mean_divergence_of_alternating_nodes(name, shift), 0.5) << name;
  }
  EXPECT_LT(mean_divergence_of_alternating_nodes("quadratic_bspline", 0), 1e-12);
}

INSTANTIATE_TEST_SUITE_P(Schemes, FBar, ::testing::ValuesIn(all_schemes()), scheme_name);

}  // namespace
}  // namespace sluice
