/// F11: a free elastic disc in rotation. Sources: conservation of angular momentum (Jiang et al. 2015 for APIC on B-splines,
/// where the affine field carries m h^2 / 4 per unit of C); the elastic solution of a rotating disc in plane strain.
#include <numbers>

#include "core/grid/blocks.h"
#include "physics/materials/materials.h"
#include "tests/verification/scene_fixture.h"

namespace sluice {
namespace {

constexpr double pi = std::numbers::pi, radius = 0.5, spin = 1, density = 1000, poisson = 0.3, h = 0.1;

/// Stresses of the rotating disc: sigma_r = A (R^2 - r^2), sigma_theta = A R^2 - B r^2.
constexpr double A = (3 - 2 * poisson) / (8 * (1 - poisson)) * density * spin * spin;
constexpr double B = (1 + 2 * poisson) / (8 * (1 - poisson)) * density * spin * spin;

std::string circle() {
  std::string points;
  for (int i = 0; i < 72; ++i)
    points += fmt::format("{}[{} m, {} m]", i ? ", " : "", radius * std::cos(pi * i / 36), radius * std::sin(pi * i / 36));
  return "[" + points + "]";
}

std::unique_ptr<Simulation> disc(const Scheme& scheme) {
  auto simulation = simulate({.grid = "{min: [-1 m, -1 m], max: [1 m, 1 m], cell: 0.1 m}",
                              .material = "{model: linear_elastic, density: 1000 kg/m3, youngs_modulus: 0.2 MPa, poisson_ratio: 0.3}",
                              .bodies = fmt::format("  - {{material: soil, polygon: {}}}", circle()),
                              .scheme = scheme});
  Particles& particles = simulation->particles();
  set_column(particles, "velocity", 0, [](const auto& x) { return -spin * x[1]; });
  set_column(particles, "velocity", 1, [](const auto& x) { return spin * x[0]; });
  if (scheme.affine()) {
    set_column(particles, "affine_velocity", 1, [](const auto&) { return -spin; });
    set_column(particles, "affine_velocity", 2, [](const auto&) { return spin; });
  }
  const auto stress = [&](int component, const auto& value) {
    set_column(particles, "stress", component, [&](const auto& x) {
      const double r = std::hypot(x[0], x[1]), c = x[0] / r, s = x[1] / r;
      return value(A * (radius * radius - r * r), A * radius * radius - B * r * r, c, s);
    });
  };
  stress(0, [](double sr, double st, double c, double s) { return sr * c * c + st * s * s; });
  stress(1, [](double sr, double st, double c, double s) { return sr * s * s + st * c * c; });
  stress(2, [](double sr, double st, double, double) { return poisson * (sr + st); });
  stress(3, [](double sr, double st, double c, double s) { return (sr - st) * c * s; });
  return simulation;
}

/// sum m (x v_y - y v_x), and with B-splines and APIC sum m h^2 / 4 (C_yx - C_xy).
double angular_momentum(const Particles& particles, bool affine) {
  const auto m = by_id(particles, "mass");
  const auto x = by_id(particles, "position", 0), y = by_id(particles, "position", 1);
  const auto vx = by_id(particles, "velocity", 0), vy = by_id(particles, "velocity", 1);
  double l = 0;
  for (std::size_t p = 0; p < m.size(); ++p) l += m[p] * (x[p] * vy[p] - y[p] * vx[p]);
  if (!affine) return l;
  const auto cxy = by_id(particles, "affine_velocity", 1), cyx = by_id(particles, "affine_velocity", 2);
  for (std::size_t p = 0; p < m.size(); ++p) l += m[p] * h * h / 4 * (cyx[p] - cxy[p]);
  return l;
}

/// Largest difference between the in-plane deviatoric stress and that of the elastic solution, over rho Omega^2 R^2.
double deviatoric_error(const Particles& particles) {
  const auto xx = by_id(particles, "stress", 0), yy = by_id(particles, "stress", 1), xy = by_id(particles, "stress", 3);
  const auto x = by_id(particles, "position", 0), y = by_id(particles, "position", 1);
  double largest = 0;
  for (std::size_t p = 0; p < xx.size(); ++p) {
    const double r = std::hypot(x[p], y[p]), c = x[p] / r, s = y[p] / r, half = (A - B) * r * r / -2;
    largest = std::max({largest, std::abs((xx[p] - yy[p]) / 2 - half * (c * c - s * s)), std::abs(xy[p] - half * 2 * c * s)});
  }
  return largest / (density * spin * spin * radius * radius);
}

class RotatingDisc : public ::testing::TestWithParam<Scheme> {};

TEST_P(RotatingDisc, M) {
  const auto simulation = disc(GetParam());
  const double l0 = angular_momentum(simulation->particles(), false), la0 = angular_momentum(simulation->particles(), GetParam().affine());
  double e0 = energy(*simulation, "kinetic");
  try{
  for (int rev : {1, 2, 3}) {
    simulation->advance_to(rev * 2 * pi);
    fmt::print("{:30} rev {} L {:.6f} La-1 {:.2e} dev {:.3e} E {:.4f} el {:.4e} steps {}\n", GetParam().name(), rev, angular_momentum(simulation->particles(), false) / l0,
               angular_momentum(simulation->particles(), GetParam().affine()) / la0 - 1, deviatoric_error(simulation->particles()), energy(*simulation, "kinetic") / e0, energy(*simulation, "elastic")/e0, simulation->steps());
  }}catch(std::exception&e){puts(e.what());}
}
INSTANTIATE_TEST_SUITE_P(Schemes, RotatingDisc, ::testing::ValuesIn(all_schemes()), scheme_name);
TEST(RotatingDiscPic, M) {
  for (const char* sh : {"linear","quadratic_bspline"}) {
  const auto simulation = disc({sh, "flip", "usl", 0, {}});
  const double l0 = angular_momentum(simulation->particles(), false);
  for (double rev : {.1,.5,1.,2.}) {
    simulation->advance_to(rev * 2 * pi);
    fmt::print("PIC {:30} rev {} L {:.6f}  dev {:.3e}\n", sh, rev, angular_momentum(simulation->particles(), false) / l0, deviatoric_error(simulation->particles()));
  }}
}

}  // namespace
}  // namespace sluice
