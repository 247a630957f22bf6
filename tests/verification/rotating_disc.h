/// A free elastic disc that rotates, and its angular momentum.
#pragma once

#include <numbers>

#include "tests/verification/scene_fixture.h"

namespace sluice::disc {

inline constexpr double pi = std::numbers::pi, radius = 0.5, spin = 1, density = 1000, poisson = 0.3;

/// Stresses of the rotating disc: sigma_r = A (R^2 - r^2), sigma_theta = A R^2 - B r^2.
inline constexpr double A = (3 - 2 * poisson) / (8 * (1 - poisson)) * density * spin * spin;
inline constexpr double B = (1 + 2 * poisson) / (8 * (1 - poisson)) * density * spin * spin;

inline std::string circle() {
  std::string points;
  for (int i = 0; i < 72; ++i)
    points +=
        fmt::format("{}[{} m, {} m]", i ? ", " : "", radius * std::cos(pi * i / 36), radius * std::sin(pi * i / 36));
  return "[" + points + "]";
}

inline std::unique_ptr<Simulation> rotating_disc(const Scheme& scheme, double h = 0.1) {
  auto simulation =
      simulate({.grid = fmt::format("{{min: [-1 m, -1 m], max: [1 m, 1 m], cell: {} m}}", h),
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

/// sum m (x v_y - y v_x), and what the affine field holds: sum m D (C_yx - C_xy), with D = h^2 / 4 for quadratic and
/// h^2 / 3 for cubic B-splines.
inline double angular_momentum(const Particles& particles, const Scheme& scheme, double h = 0.1) {
  const auto m = by_id(particles, "mass");
  const auto x = by_id(particles, "position", 0), y = by_id(particles, "position", 1);
  const auto vx = by_id(particles, "velocity", 0), vy = by_id(particles, "velocity", 1);
  double l = 0;
  for (std::size_t p = 0; p < m.size(); ++p) l += m[p] * (x[p] * vy[p] - y[p] * vx[p]);
  if (!scheme.affine()) return l;
  const double moment = h * h / (scheme.shape == "cubic_bspline" ? 3 : 4);
  const auto cxy = by_id(particles, "affine_velocity", 1), cyx = by_id(particles, "affine_velocity", 2);
  for (std::size_t p = 0; p < m.size(); ++p) l += m[p] * moment * (cyx[p] - cxy[p]);
  return l;
}

}  // namespace sluice::disc
