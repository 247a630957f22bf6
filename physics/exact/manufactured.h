/// Manufactured solutions of large elastic deformation, with the body forces that make them exact. Compressible
/// neo-Hookean material: P = mu (F - F^-T) + lambda ln J F^-T, nominal stress, in plane strain (2-D) or space. X is the
/// place before deformation.
///
/// Axis-aligned displacement: Wallstedt & Guilkey (2008), An evaluation of explicit time integration schemes for use
/// with the generalized interpolation material point method, J. Comput. Phys. 227, 9628-9642. Generalized vortex:
/// Kamojjala, Brannon, Sadeghirad & Guilkey (2015), Verification tests in solid mechanics, Engineering with Computers
/// 31, 193-213. Both as in the open code Uintah; the second is derived anew below.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace sluice::exact {

struct NeoHookean {
  double lambda, shear, density;  ///< [Pa], [Pa], [kg/m3]
};

inline NeoHookean neo_hookean(double youngs_modulus, double poisson_ratio, double density) {
  const double shear = youngs_modulus / (2 * (1 + poisson_ratio));
  return {2 * shear * poisson_ratio / (1 - 2 * poisson_ratio), shear, density};
}

/// Standing waves along the axes of the unit square or cube, out of phase:
///   u_a = A sin(pi X_a) sin(pi c t + phase_a),  c = sqrt(E / rho).
/// The walls hold the normal displacement, and there is no shear: frictionless faces.
template <int Dim>
struct AxisAligned {
  using Vector = std::array<double, Dim>;
  static constexpr double pi = std::numbers::pi;
  double amplitude = 0.05, youngs_modulus = 1e4, poisson_ratio = 0.3, density = 1;

  NeoHookean material() const { return neo_hookean(youngs_modulus, poisson_ratio, density); }
  double speed() const { return std::sqrt(youngs_modulus / density); }
  /// 0, 2/3, 4/3 of pi in space; 0 and 1 in the plane.
  static double phase(std::size_t axis) { return static_cast<double>(axis) * (Dim == 2 ? pi : 2 * pi / 3); }

  Vector displacement(const Vector& X, double t) const {
    Vector u;
    for (std::size_t a = 0; a < Dim; ++a)
      u[a] = amplitude * std::sin(pi * X[a]) * std::sin(pi * speed() * t + phase(a));
    return u;
  }
  Vector velocity(const Vector& X, double t) const {
    Vector v;
    for (std::size_t a = 0; a < Dim; ++a)
      v[a] = amplitude * std::sin(pi * X[a]) * pi * speed() * std::cos(pi * speed() * t + phase(a));
    return v;
  }
  /// b_a = pi^2 u_a [ mu / rho - c^2 + (lambda (1 - ln J) + mu) / (rho F_aa^2) ]
  Vector body_force(const Vector& X, double t) const {
    const NeoHookean m = material();
    const Vector u = displacement(X, t);
    Vector stretch, b;
    double log_j = 0;
    for (std::size_t a = 0; a < Dim; ++a) {
      stretch[a] = 1 + amplitude * pi * std::cos(pi * X[a]) * std::sin(pi * speed() * t + phase(a));
      log_j += std::log(stretch[a]);
    }
    for (std::size_t a = 0; a < Dim; ++a)
      b[a] = pi * pi * u[a] *
             (m.shear / density - speed() * speed() +
              (m.lambda * (1 - log_j) + m.shear) / (density * stretch[a] * stretch[a]));
    return b;
  }
};

/// Rings of the annulus 0.75 < R < 1.25 turn about the origin by alpha(R, t) = A sin(pi c t) g(R), c = sqrt(E / rho),
///   g = 1 - 32 (R - 1)^2 + 256 (R - 1)^4 = (4R - 3)^2 (4R - 5)^2.
/// g and its slope vanish at both rims: these neither move nor carry stress. The motion is a simple shear
/// gamma = R alpha' of each ring on the next, J = 1, and the nominal stress is mu (F - F^-T): in the axes turned by
/// alpha, P_{theta R} = mu gamma, P_{R theta} = mu gamma, P_RR = -mu gamma^2 ... , whence the forces below.
struct Vortex {
  using Vector = std::array<double, 2>;
  static constexpr double pi = std::numbers::pi;
  double amplitude = 1, youngs_modulus = 1000, poisson_ratio = 0.3, density = 1000;

  NeoHookean material() const { return neo_hookean(youngs_modulus, poisson_ratio, density); }
  double speed() const { return std::sqrt(youngs_modulus / density); }
  static double shape(double R) { return std::abs(R - 1) < 0.25 ? std::pow((4 * R - 3) * (4 * R - 5), 2) : 0; }
  double angle(double R, double t) const { return amplitude * std::sin(pi * speed() * t) * shape(R); }

  Vector displacement(const Vector& X, double t) const {
    const double R = std::hypot(X[0], X[1]), a = angle(R, t), c = std::cos(a), s = std::sin(a);
    return {c * X[0] - s * X[1] - X[0], s * X[0] + c * X[1] - X[1]};
  }
  Vector velocity(const Vector& X, double t) const {
    const double R = std::hypot(X[0], X[1]), a = angle(R, t), c = std::cos(a), s = std::sin(a);
    const double rate = amplitude * pi * speed() * std::cos(pi * speed() * t) * shape(R);
    return {rate * (-s * X[0] - c * X[1]), rate * (c * X[0] - s * X[1])};
  }
  /// Along the radius and along the circle, at the place where the point is now:
  ///   b_r     = -R alpha_t^2 + (mu / rho) R alpha_R^2
  ///   b_theta =  R alpha_tt - (mu / rho) (3 alpha_R + R alpha_RR)
  Vector body_force(const Vector& X, double t) const {
    const double R = std::hypot(X[0], X[1]), q = R - 1, c = speed(), mu = material().shear / density;
    if (std::abs(q) >= 0.25) return {0, 0};
    const double g = shape(R), g_R = -64 * q + 1024 * q * q * q, g_RR = -64 + 3072 * q * q;
    const double s = amplitude * std::sin(pi * c * t), s_t = amplitude * pi * c * std::cos(pi * c * t);
    const double radial = -R * s_t * g * s_t * g + mu * R * s * g_R * s * g_R;
    const double circular = -pi * pi * c * c * R * s * g - mu * s * (3 * g_R + R * g_RR);
    const double turned = std::atan2(X[1], X[0]) + angle(R, t), cos = std::cos(turned), sin = std::sin(turned);
    return {radial * cos - circular * sin, radial * sin + circular * cos};
  }
};

}  // namespace sluice::exact
