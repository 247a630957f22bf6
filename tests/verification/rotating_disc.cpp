/// F11: a free elastic disc in rotation. Sources: conservation of angular momentum (Jiang et al. 2015 for APIC on
/// B-splines, where the affine field carries m h^2 / 4 per unit of C); the elastic solution of a rotating disc in plane
/// strain.
#include "tests/verification/rotating_disc.h"
#include "core/grid/blocks.h"
#include "physics/materials/materials.h"

namespace sluice {
namespace {

using namespace disc;

/// Largest difference between the in-plane deviatoric stress and that of the elastic solution, over rho Omega^2 R^2.
double deviatoric_error(const Particles& particles) {
  const auto xx = by_id(particles, "stress", 0), yy = by_id(particles, "stress", 1), xy = by_id(particles, "stress", 3);
  const auto x = by_id(particles, "position", 0), y = by_id(particles, "position", 1);
  double largest = 0;
  for (std::size_t p = 0; p < xx.size(); ++p) {
    const double r = std::hypot(x[p], y[p]), c = x[p] / r, s = y[p] / r, half = (A - B) * r * r / -2;
    largest =
        std::max({largest, std::abs((xx[p] - yy[p]) / 2 - half * (c * c - s * s)), std::abs(xy[p] - half * 2 * c * s)});
  }
  return largest / (density * spin * spin * radius * radius);
}

/// Linear functions give APIC no constant h^2 / 4, and their small nodal masses do not hold a free rim (F7): B-splines
/// only.
std::vector<Scheme> affine_schemes() {
  auto schemes = all_schemes();
  std::erase_if(schemes, [](const Scheme& s) { return !s.affine() || !s.shape.ends_with("bspline"); });
  return schemes;
}

class RotatingDisc : public ::testing::TestWithParam<Scheme> {};

// Gates: 1e-6 of the angular momentum with APIC (measured: 1e-12, round-off), 5e-5 with TPIC (measured: 4e-5; see the
// next test). And a tenth of rho Omega^2 R^2 for the deviatoric
// stress over three turns (measured: 0.08; the rim is ragged at this cell size, and no stress is seen to grow from turn
// to turn). Strain is taken at the beginning of the step (USL) or at its end (USF), not in its middle: a turning disc
// grows or shrinks by Omega^2 dt / 2 of its radius a second without being strained, and its energy changes twice as
// fast at given momentum.
TEST_P(RotatingDisc, KeepsItsMomentumAndItsStress) {
  const auto simulation = rotating_disc(GetParam());
  const double momentum = angular_momentum(simulation->particles(), GetParam()),
               kinetic = energy(*simulation, "kinetic");
  for (const int turns : {1, 2, 3}) {
    simulation->advance_to(turns * 2 * pi / spin);
    const double dt = simulation->time() / static_cast<double>(simulation->steps());
    EXPECT_NEAR(angular_momentum(simulation->particles(), GetParam()) / momentum, 1,
                GetParam().transfer == "apic" ? 1e-6 : 5e-5);
    EXPECT_LT(deviatoric_error(simulation->particles()), 0.1);
    EXPECT_NEAR(energy(*simulation, "kinetic") / kinetic, 1, 1.1 * spin * spin * dt * simulation->time() + 1e-3);
  }
}

INSTANTIATE_TEST_SUITE_P(Schemes, RotatingDisc, ::testing::ValuesIn(affine_schemes()), scheme_name);

// TPIC does not keep angular momentum, but loses it with the second order of the cells only. Along an axis the weights
// of its gradient and of APIC's moment differ by 2 t (1/4 - t^2) (1, -2, 1) / h for quadratic functions, t from the
// middle of the cell: by the curvature of the velocity, which a rigid rotation has not, times a function that is as
// often negative as positive. What is left comes of vibrations and of the ragged rim. Over a turn the largest change is
// 1.4e-5 with cells of 0.1 R, and quarters at least with each halving; the 1e-6 that APIC is held to, it reaches there.
TEST(RotatingDiscWithTpic, LosesMomentumWithTheSecondOrderOfTheCells) {
  const auto largest_change = [](const std::string& shape, double h) {
    const Scheme scheme = {shape, "tpic", "usl", 1, {}};
    const auto simulation = rotating_disc(scheme, h);
    const double momentum = angular_momentum(simulation->particles(), scheme, h);
    double largest = 0;
    for (const int half_turns : {1, 2}) {
      simulation->advance_to(half_turns * pi / spin);
      largest = std::max(largest, std::abs(angular_momentum(simulation->particles(), scheme, h) / momentum - 1));
    }
    return largest;
  };
  for (const char* shape : {"quadratic_bspline", "cubic_bspline"}) {
    const double coarse = largest_change(shape, 0.1), fine = largest_change(shape, 0.025);
    EXPECT_LT(fine, coarse / 16) << shape;
    EXPECT_LT(fine, 1e-6) << shape;
  }
}

// The negative controls: PIC hands no rotation on within a cell, and loses most of it in one turn. So does FLIP with 5
// % of PIC, of which some thousand steps make a turn.
TEST(RotatingDiscWithPic, LosesItsMomentum) {
  const auto left_after_a_turn = [](double flip) {
    const Scheme scheme = {"quadratic_bspline", "flip", "musl", flip, {}};
    const auto simulation = rotating_disc(scheme);
    const double momentum = angular_momentum(simulation->particles(), scheme);
    simulation->advance_to(2 * pi / spin);
    return angular_momentum(simulation->particles(), scheme) / momentum;
  };
  EXPECT_LT(left_after_a_turn(0), 0.3);
  EXPECT_LT(left_after_a_turn(0.95), 0.3);
}

/// Turns the stress of points by pure rotation increments, one at a time, through Materials::update_stress.
template <int Dim>
class Turntable {
 public:
  using Tensor = std::array<double, symmetric_components<Dim>>;
  using Spin = std::array<double, spin_components<Dim>>;

  explicit Turntable(const Tensor& stress) : materials_(definition()), particles_(Dim), block_{}, zero_(8, 0.0) {
    materials_.declare(particles_.columns);
    particles_.resize(1);
    particles_.material_names = {"soil"};
    particles_.columns.data(particles_.mass)[0] = 1;
    particles_.columns.data(particles_.volume)[0] = 1e-3;
    for (std::size_t c = 0; c < stress.size(); ++c)
      particles_.columns.data(particles_.stress, static_cast<int>(c))[0] = stress[c];
    GridGeometry<Dim> grid;
    grid.max.fill(8);
    grid.cell.fill(1);
    grid.cells.fill(8);
    blocks_.sort(particles_, grid, 1);
    block_ = blocks_.particle_blocks()[0];
  }

  void turn(Spin spin_increment) {
    StrainIncrements<Dim> increments;
    for (auto& strain : increments.strain) strain = zero_.data();
    for (std::size_t c = 0; c < spin_increment.size(); ++c) increments.rotation[c] = &spin_increment[c];
    materials_.update_stress(particles_, particles_.mass, blocks_, block_, increments, 1.0, 0.0);
  }

  Tensor stress() const {
    Tensor s;
    for (std::size_t c = 0; c < s.size(); ++c)
      s[c] = particles_.columns.data(particles_.stress, static_cast<int>(c))[0];
    return s;
  }

 private:
  static Case definition() {
    Case c;
    c.grid.cell.assign(Dim, 1.0);
    c.materials.emplace_back(
        "soil", read_yaml_text("{model: linear_elastic, density: 1000 kg/m3, youngs_modulus: 1 MPa}", "soil"));
    return c;
  }

  Materials<Dim> materials_;
  Particles particles_;
  Blocks<Dim> blocks_;
  ParticleBlock<Dim> block_;
  std::vector<double> zero_;
};

template <std::size_t N>
void expect_stress(const std::array<double, N>& found, const std::array<double, N>& expected, double tolerance) {
  for (std::size_t c = 0; c < N; ++c) EXPECT_NEAR(found[c], expected[c], tolerance) << "component " << c;
}

// A uniaxial stress must come back after a full turn. Each step turns by 2 atan(w / 2) (Hughes & Winget 1980), so the
// angle of 2000 steps is short of the turn by w^2 / 12 of it, 5e-6 rad: twice that, of the stress, shows in the shear.
TEST(JaumannRotation, UniaxialStressReturnsAfterAFullTurn) {
  constexpr int steps = 2000;
  const double w = 2 * pi / steps, miss = 2 * pi * w * w / 12;
  Turntable<2> plane({1, 0, 0, 0});
  for (int i = 0; i < steps; ++i) plane.turn({w});
  expect_stress<4>(plane.stress(), {1, 0, 0, -miss}, 1e-6);

  Turntable<3> space({1, 0, 0.5, 0, 0, 0});
  for (int i = 0; i < steps; ++i) space.turn({-w, 0, 0});  // w_xy = -w_yx
  expect_stress<6>(space.stress(), {1, 0, 0.5, -miss, 0, 0}, 1e-6);
}

// With increments whose tangent is exact, tan(w / 2) = w' / 2, a quarter turn brings xx to yy without any error, about
// each axis.
TEST(JaumannRotation, QuarterTurnsAreExact) {
  constexpr int steps = 50;
  const double w = 2 * std::tan(pi / 4 / steps);
  Turntable<2> plane({3, 1, 2, 0.5});
  for (int i = 0; i < steps; ++i) plane.turn({w});
  expect_stress<4>(plane.stress(), {1, 3, 2, -0.5}, 1e-13);
  Turntable<3> about_z({1, 2, 3, 0, 0, 0}), about_x({1, 2, 3, 0, 0, 0}), about_y({1, 2, 3, 0, 0, 0});
  for (int i = 0; i < steps; ++i) {
    about_z.turn({w, 0, 0});
    about_x.turn({0, w, 0});
    about_y.turn({0, 0, w});
  }
  expect_stress<6>(about_z.stress(), {2, 1, 3, 0, 0, 0}, 1e-13);
  expect_stress<6>(about_x.stress(), {1, 3, 2, 0, 0, 0}, 1e-13);
  expect_stress<6>(about_y.stress(), {3, 2, 1, 0, 0, 0}, 1e-13);
}

// A rotation about a slanted axis keeps the invariants of any stress, and a hydrostatic stress altogether: round-off.
TEST(JaumannRotation, InvariantsAndHydrostaticStressStay) {
  Turntable<3> any({3, -1, 2, 0.5, -0.7, 1.1}), pressure({-5, -5, -5, 0, 0, 0});
  for (int i = 0; i < 1000; ++i) {
    any.turn({0.02, -0.03, 0.05});
    pressure.turn({0.02, -0.03, 0.05});
  }
  const auto s = any.stress();
  const double squares = s[0] * s[0] + s[1] * s[1] + s[2] * s[2] + 2 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]);
  EXPECT_NEAR(s[0] + s[1] + s[2], 4, 1e-12);
  EXPECT_NEAR(squares, 14 + 2 * (0.25 + 0.49 + 1.21), 1e-11);
  expect_stress<6>(pressure.stress(), {-5, -5, -5, 0, 0, 0}, 1e-12);
}

}  // namespace
}  // namespace sluice
