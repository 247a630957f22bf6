/// `initial_stress: {method: equilibrium}`: equilibrium with the strength of the materials. Sources: the elastic
/// solution where nothing yields; a column between walls, elastic and in the active state; Hill's thick cylinder; the
/// stability number gamma H / c of a vertical cut, at most 3.83 (slip circles: W. Fellenius 1927).
#include "core/parallel/parallel.h"
#include "tests/verification/thick_cylinder.h"

namespace sluice {
namespace {

std::string stress_of(const std::string& more) { return "{method: equilibrium" + more + "}"; }

/// The largest difference of stresses over the largest of them.
double difference(const Particles& a, const Particles& b) {
  double largest = 0, size = 0;
  for (int c = 0; c < (a.dimension == 2 ? 4 : 6); ++c) {
    const auto s = by_id(a, "stress", c), t = by_id(b, "stress", c);
    size = std::max(size, largest_magnitude(t));
    for (std::size_t p = 0; p < s.size(); ++p) largest = std::max(largest, std::abs(s[p] - t[p]));
  }
  return largest / size;
}

std::string complaint_of(const SceneText& scene) { return refusal_of(scene, "none"); }

// ---- elastic ----

/// An elastic slope with a reservoir at its foot; in 3-D a metre and a half of it.
SceneText elastic_slope(int dimension, const std::string& shape) {
  const bool flat = dimension == 2;
  SceneText scene{
      .grid = flat ? "{min: [0 m, 0 m], max: [16 m, 8 m], cell: 0.5 m}"
                   : "{min: [0 m, 0 m, 0 m], max: [16 m, 1.5 m, 8 m], cell: 0.5 m}",
      .bodies = flat ? "  - {material: soil, polygon: [[0 m, 0 m], [16 m, 0 m], [16 m, 1 m], [8 m, 5 m], [0 m, 5 m]]}"
                     : "  - {material: soil, box: {min: [0 m, 0 m, 0 m], max: [16 m, 1.5 m, 1 m]}}\n"
                       "  - {material: soil, box: {min: [0 m, 0 m, 1 m], max: [6 m, 1.5 m, 4 m]}}",
      .gravity = flat ? "[0, -10 m/s2]" : "[0, 0, -10 m/s2]",
      .boundaries = flat ? "{left: roller, right: roller, bottom: fixed}"
                         : "{left: roller, right: roller, front: roller, back: roller, bottom: fixed}",
      .scheme = {.shape = shape}};
  scene.more = "surface_loads: [{level: 3 m}]\n";
  return scene;
}

// Where nothing yields, the elastic solution solves the problem, and the stress update gives its stresses to round-off:
// 1e-9 of the largest. (Displacements of motions without strain, against weak springs, are 1e8 times those that count.)
TEST(Equilibrium, IsTheElasticOneWhereNothingYields) {
  for (const int dimension : {2, 3})
    for (const char* shape : {"linear", "ugimp", "quadratic_bspline", "cubic_bspline"})
      for (const int increments : {1, 3}) {
        SceneText scene = elastic_slope(dimension, shape);
        scene.initial_stress = "{method: elastic_equilibrium}";
        const auto elastic = simulate(scene);
        scene.initial_stress = stress_of(fmt::format(", increments: {}, tolerance: 1e-7", increments));
        EXPECT_LT(difference(simulate(scene)->particles(), elastic->particles()), increments == 1 ? 1e-9 : 1e-6)
            << dimension << "-D, " << shape << ", " << increments << " increments";
      }
}

// ---- a column between smooth walls ----

/// 10 m high; sigma_v = -20 kPa/m (10 m - z). The elastic K0 is 0.25.
SceneText column(int dimension, const std::string& material, const std::string& more = "") {
  const bool flat = dimension == 2;
  return {.grid = flat ? "{min: [0 m, 0 m], max: [2 m, 12 m], cell: 0.5 m}"
                       : "{min: [0 m, 0 m, 0 m], max: [1 m, 1 m, 12 m], cell: 0.5 m}",
          .material = "{density: 2000 kg/m3, youngs_modulus: 20 MPa, poisson_ratio: 0.2, " + material + "}",
          .bodies = flat ? "  - {material: soil, box: {min: [0 m, 0 m], max: [2 m, 10 m]}}"
                         : "  - {material: soil, box: {min: [0 m, 0 m, 0 m], max: [1 m, 1 m, 10 m]}}",
          .gravity = flat ? "[0, -10 m/s2]" : "[0, 0, -10 m/s2]",
          .boundaries = flat ? "{left: roller, right: roller, bottom: roller}"
                             : "{left: roller, right: roller, front: roller, back: roller, bottom: roller}",
          .initial_stress = stress_of(", tolerance: 1e-9" + more)};
}

/// By the quadrature with 2 points an axis the vertical stress is off by a twelfth of the weight of a cell at the floor
/// and the top, and by less elsewhere (theory, after (32c)); a hundredth for round-off and tolerance.
double vertical_tolerance(double weight) { return 1.01 / 12 * weight * 0.5; }

/// Asserts sigma_h = horizontal(sigma_v) at every particle, to the accuracy of the stress return, and the weight as
/// sigma_v.
template <class Horizontal>
void expect_stresses(const Particles& particles, const Horizontal& horizontal) {
  const int up = particles.dimension - 1;
  const auto z = by_id(particles, "position", up), vertical = by_id(particles, "stress", up);
  for (int c = 0; c < 3; ++c) {
    const auto s = by_id(particles, "stress", c);
    for (std::size_t p = 0; p < z.size(); ++p)
      if (c == up)
        EXPECT_NEAR(s[p], -20e3 * (10 - z[p]), vertical_tolerance(20e3)) << z[p];
      else
        EXPECT_NEAR(s[p], horizontal(vertical[p]), 1e-6 * 200e3) << z[p] << ", component " << c;
  }
}

// Tresca: down to where (1 - K0) sigma_v = 2 c the column is elastic, and below the stresses differ by 2 c. Strength
// 30 kPa: at a depth of 4 m.
TEST(Equilibrium, OfAColumnWithUndrainedStrength) {
  for (const int dimension : {2, 3})
    for (const char* more : {"", ", increments: 7"}) {
      const auto simulation = simulate(column(dimension, "model: tresca, strength: 30 kPa", more));
      expect_stresses(simulation->particles(), [](double v) { return std::min(0.25 * v, v + 60e3); });
    }
}

// Mohr-Coulomb with phi = 30 degrees and c = 0: K0 = 0.25 lies below the active 1/3, so that the whole column is in the
// active state, whatever the dilation.
TEST(Equilibrium, OfAColumnInTheActiveState) {
  for (const int dimension : {2, 3})
    for (const char* dilation : {"0 deg", "10 deg"}) {
      const auto simulation = simulate(column(
          dimension,
          fmt::format("model: mohr_coulomb, friction_angle: 30 deg, cohesion: 0 Pa, dilation_angle: {}", dilation)));
      expect_stresses(simulation->particles(), [](double v) { return v / 3; });
    }
}

// A strength that is a share of the initial overburden is tied to the elastic vertical stress: su = 0.3 sigma_v, so
// that sigma_h = sigma_v (1 - 0.6). The increments do not matter: the stress is remembered before.
TEST(Equilibrium, RemembersTheElasticOverburden) {
  for (const char* more : {"", ", increments: 4"}) {
    const auto simulation = simulate(column(2, "model: tresca, strength_ratio: 0.3, minimum_strength: 1 Pa", more));
    const auto overburden = by_id(simulation->particles(), "initial_vertical_stress");
    const auto vertical = by_id(simulation->particles(), "stress", 1),
               side = by_id(simulation->particles(), "stress", 0);
    for (std::size_t p = 0; p < vertical.size(); ++p) {
      EXPECT_NEAR(overburden[p], -vertical[p], 1e-6 * 200e3);
      EXPECT_NEAR(side[p] - vertical[p], 0.6 * overburden[p], 1e-6 * 200e3);
    }
  }
}

// ---- a thick cylinder ----

SceneText quarter(double cell, double pressure) {
  SceneText scene = quarter_cylinder(cell, "20 MPa", fmt::format("{} Pa", pressure));
  scene.initial_stress = stress_of(", increments: 5");
  return scene;
}

struct CylinderErrors {
  double stress;          ///< mean over the volume of |radial| and |hoop| off, over 2 c
  double plastic_radius;  ///< of the circle that holds the plastic volume [m]
};

CylinderErrors errors_of(const Particles& particles, double plastic) {
  const auto x = by_id(particles, "position", 0), y = by_id(particles, "position", 1), v = by_id(particles, "volume");
  const auto xx = by_id(particles, "stress", 0), yy = by_id(particles, "stress", 1), xy = by_id(particles, "stress", 3);
  const auto strain = by_id(particles, "equivalent_plastic_strain");
  double sum = 0, plastic_volume = 0;
  for (std::size_t p = 0; p < x.size(); ++p) {
    const double r = std::hypot(x[p], y[p]), c = x[p] / r, s = y[p] / r;
    const auto exact = cylinder.stress(r, plastic);
    sum += v[p] * std::abs(xx[p] * c * c + yy[p] * s * s + 2 * xy[p] * c * s - exact.radial);
    sum += v[p] * std::abs(xx[p] * s * s + yy[p] * c * c - 2 * xy[p] * c * s - exact.hoop);
    if (strain[p] > 0) plastic_volume += v[p];
  }
  return {sum / (2 * ::sluice::sum(v)) / (2 * cylinder.strength), std::sqrt(1 + 4 / M_PI * plastic_volume)};
}

// Plastic half-way through the wall. Tolerances: the faces are staircases of particles, which is an error of first
// order in the stress near them: 4 % of 2 c with cells of a tenth of the wall, and at least 1.5 times less with half of
// that. The plastic radius is met to 1.5 %, a quarter of the smaller cell.
TEST(Equilibrium, OfAThickCylinder) {
  const double plastic = 1.5;
  std::vector<CylinderErrors> errors;
  for (const double cell : {0.1, 0.05})
    errors.push_back(errors_of(simulate(quarter(cell, cylinder.pressure(plastic)))->particles(), plastic));
  EXPECT_LT(errors[0].stress, 0.04);
  EXPECT_GT(errors[0].stress / errors[1].stress, 1.5);
  for (const CylinderErrors& e : errors) EXPECT_NEAR(e.plastic_radius, plastic, 0.015 * plastic);
}

// The negative control: 3 % below the collapse pressure there is an equilibrium, 8 % above there is none.
TEST(Equilibrium, OfAThickCylinderEndsWithTheCollapsePressure) {
  const double collapse = cylinder.collapse_pressure();
  EXPECT_EQ(complaint_of(quarter(0.1, 0.97 * collapse)), "none");
  EXPECT_NE(complaint_of(quarter(0.1, 1.08 * collapse)).find("no equilibrium was found"), std::string::npos);
}

// ---- a vertical cut ----

constexpr double cut_height = 5, unit_weight = 20e3;

/// A vertical cut in clay whose strength gives this stability number gamma H / c.
SceneText cut(double number, const std::string& initial_stress, bool f_bar = true) {
  return {.grid = "{min: [0 m, 0 m], max: [20 m, 12 m], cell: 0.5 m}",
          .material = fmt::format("{{model: tresca, density: 2000 kg/m3, youngs_modulus: 20 MPa, poisson_ratio: 0.45, "
                                  "strength: {} Pa}}",
                                  unit_weight * cut_height / number),
          .bodies =
              "  - {material: soil, box: {min: [0 m, 0 m], max: [20 m, 5 m]}}\n"
              "  - {material: soil, box: {min: [0 m, 5 m], max: [10 m, 10 m]}}",
          .gravity = "[0, -10 m/s2]",
          .boundaries = "{left: roller, right: roller, bottom: fixed}",
          .initial_stress = initial_stress,
          .scheme = Scheme{}.with(f_bar ? "f_bar: true" : "")};
}

/// The largest kinetic energy in a second, some ten periods of the clay.
double largest_kinetic_energy(Simulation& simulation) {
  double largest = 0;
  while (simulation.time() < 1) {
    simulation.advance(1);
    largest = std::max(largest, energy(simulation, "kinetic"));
  }
  return largest;
}

// Below the limit the explicit run stays at rest. Forces out of balance are at most 1e-4 of the largest: accelerations
// of 1e-4 g, and energies of 1e-8 of those of a sudden load. The control is the elastic stress, which exceeds the
// strength at the foot of the cut.
TEST(Equilibrium, OfAVerticalCutBelowItsLimitStaysAtRest) {
  for (const bool f_bar : {true, false}) {
    const double sudden = largest_kinetic_energy(*simulate(cut(3, "{method: none}", f_bar)));
    const double elastic = largest_kinetic_energy(*simulate(cut(3, "{method: elastic_equilibrium}", f_bar)));
    const double plastic = largest_kinetic_energy(*simulate(cut(3, stress_of(""), f_bar)));
    EXPECT_LT(plastic, 1e-7 * sudden);
    EXPECT_LT(plastic, 1e-3 * elastic);
  }
}

// The cut stands at 3.5 and falls at 4.4, 15 % above the upper bound: on this grid the limit comes 4 % above that. What
// is said: where, how much is carried, how far from balance, what to do.
TEST(Equilibrium, OfAVerticalCutAboveItsLimitIsRefused) {
  EXPECT_EQ(complaint_of(cut(3.5, stress_of(""))), "none");
  const std::string message = complaint_of(cut(4.4, stress_of("")));
  for (const char* part :
       {"scene.yaml:", "initial_stress: no equilibrium was found: the materials carry 90.6 %", "% of weight and loads",
        "allowed: 0.0001", "most near (", "raise the strength", "`method: elastic_equilibrium`", "`tolerance`"})
    EXPECT_NE(message.find(part), std::string::npos) << message;
}

// ---- other materials, threads, keys ----

// Stiffness that follows the pressure: the elastic solution of a reference pressure of 1 kPa is far too soft where the
// pressure is 80 kPa, and Newton's method finds the equilibrium. It is the same as from the stiffness at 100 kPa,
// within the path: the two start from the same elastic stress.
TEST(Equilibrium, OfClayWhoseStiffnessFollowsThePressure) {
  const auto clay = [](const char* reference) {
    SceneText scene = column(2, "");
    scene.material = fmt::format(
        "{{model: modified_cam_clay, density: 2000 kg/m3, critical_stress_ratio: 1, lambda: 0.2, kappa: 0.04, "
        "initial_void_ratio: 1.2, overconsolidation_ratio: 1.5, reference_pressure: {}}}",
        reference);
    return simulate(scene);
  };
  const auto soft = clay("1 kPa"), stiff = clay("100 kPa");
  EXPECT_LT(difference(soft->particles(), stiff->particles()), 1e-6);
}

// Soil that hardly dilates, at a slope of 26.6 degrees with a friction angle of 35: stands, and stays at rest.
TEST(Equilibrium, OfASlopeWithFrictionStaysAtRest) {
  SceneText scene{.grid = "{min: [0 m, 0 m], max: [28 m, 9 m], cell: 0.5 m}",
                  .material =
                      "{model: mohr_coulomb, density: 2000 kg/m3, youngs_modulus: 20 MPa, poisson_ratio: 0.3, "
                      "friction_angle: 35 deg, cohesion: 1 kPa}",
                  .bodies =
                      "  - {material: soil, polygon: [[0 m, 0 m], [28 m, 0 m], [28 m, 2 m], [20 m, 2 m], [8 m, 8 "
                      "m], [0 m, 8 m]]}",
                  .gravity = "[0, -10 m/s2]",
                  .boundaries = "{left: roller, right: roller, bottom: fixed}",
                  .initial_stress = stress_of("")};
  const double at_rest = largest_kinetic_energy(*simulate(scene));
  scene.initial_stress = "{method: none}";
  EXPECT_LT(at_rest, 1e-6 * largest_kinetic_energy(*simulate(scene)));
}

TEST(Equilibrium, HasTheSameBitsOnAnyNumberOfThreads) {
  std::vector<std::vector<double>> stresses;
  const int before = thread_count();
  for (const int threads : {1, 2, 5}) {
    set_thread_count(threads);
    stresses.push_back(by_id(simulate(cut(3.5, stress_of("")))->particles(), "stress", 1));
  }
  set_thread_count(before);
  EXPECT_EQ(stresses[0], stresses[1]);
  EXPECT_EQ(stresses[0], stresses[2]);
}

TEST(Equilibrium, KeysBelongToIt) {
  EXPECT_NE(complaint_of(cut(3, "{method: elastic_equilibrium, increments: 3}"))
                .find("initial_stress: `increments` is for `method: equilibrium` only"),
            std::string::npos);
  EXPECT_NE(complaint_of(cut(3, "{method: k0, tolerance: 1e-3}"))
                .find("initial_stress: `tolerance` is for `method: equilibrium` only"),
            std::string::npos);
  EXPECT_NE(complaint_of(cut(3, stress_of(", increments: 0"))).find("increments"), std::string::npos);
  EXPECT_NE(complaint_of(cut(3, stress_of(", tolerance: 0"))).find("tolerance"), std::string::npos);
  EXPECT_NE(complaint_of(cut(3, "{method: equilibirum}")).find("did you mean 'equilibrium'"), std::string::npos);
}

// ---- with water ----

// A saturated column below a pond: effective stresses are in the active state under the buoyant weight.
TEST(Equilibrium, HasEffectiveStressesUnderWater) {
  SceneText scene = column(2,
                           "model: mohr_coulomb, friction_angle: 30 deg, cohesion: 0 Pa, water: {porosity: 0.4, "
                           "permeability: 1 mm/s}");
  scene.physics = "two_phase";
  scene.more = "water: {ponds: [{level: 11 m}], initial: {method: hydrostatic, level: 11 m}}\n";
  const auto simulation = simulate(scene);
  const auto vertical = by_id(simulation->particles(), "stress", 1), side = by_id(simulation->particles(), "stress", 0);
  const auto z = by_id(simulation->particles(), "position", 1);
  for (std::size_t p = 0; p < z.size(); ++p) {
    EXPECT_NEAR(side[p], vertical[p] / 3, 1e-6 * 200e3);
    EXPECT_NEAR(vertical[p], -(2000 - 600) * 10 * (10 - z[p]), vertical_tolerance(14e3)) << z[p];
  }
}

TEST(Equilibrium, RefusesBodiesOfWater) {
  SceneText scene = column(2, "model: linear_elastic, water: {porosity: 0.4, permeability: 1 mm/s}");
  scene.physics = "two_phase";
  scene.material += "\n  lake: {model: water}";
  scene.bodies += "\n  - {material: lake, box: {min: [0 m, 10 m], max: [2 m, 11 m]}}";
  EXPECT_NE(complaint_of(scene).find("`method: equilibrium` knows no bodies of water, and 'lake' is one"),
            std::string::npos)
      << complaint_of(scene);
}

}  // namespace
}  // namespace sluice
