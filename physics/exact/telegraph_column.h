/// Column of saturated soil under a step load, with inertia and incompressible water and grains (EX.7)-(EX.13).
/// z runs up from the fixed, impermeable base to the drained top z = H, which carries the effective traction -q from
/// t = 0 on. Displacement u is that of the grains, upwards positive; pressure is in excess of hydrostatic.
///
/// Nothing can be stored: n (v_w - v_s) = -v_s, so one unknown is left,
///     m_e u_tt + (gamma_w / k) u_t = M u_zz                                                               (EX.8)
///     p = q + M u_z + m_p int_z^H u_tt dz                                                                 (EX.9)
/// with masses that depend on which inertia of the water the model keeps (WaterInertia). Derived in
/// docs/exact_solutions.md from the balances of water and mixture; the semi-infinite form is that of de Boer, Ehlers &
/// Liu (1993), Archive of Applied Mechanics 63, 59-72.
///
/// The modes (2 m + 1) pi / (2 H) converge slowly at the fronts that run up and down the column. The part that carries
/// them, exp(-a t) times the undamped wave, is a square and a triangular wave in closed form; only the rest is summed.
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <numbers>

#include "physics/exact/saturated_soil.h"

namespace sluice::exact {

/// Acceleration of the water in the momentum of the mixture / in Darcy's law:
enum class WaterInertia {
  own,           ///< a_w / a_w: the v-w-p model. m_e = (1-n) rho_s + (1-n)^2 rho_w / n, m_p = (1-n) (rho_s - rho_w)
  of_grains,     ///< a_s / a_s: the u-p model, relative acceleration dropped. m_e = rho - rho_w, m_p = rho
  none_in_darcy  ///< a_s / 0: Darcy's law without inertia. m_e = m_p = rho
};

struct TelegraphMasses {
  double inertia;   ///< m_e of (EX.8), kg/m3
  double pressure;  ///< m_p of (EX.9), kg/m3
};

inline TelegraphMasses telegraph_masses(const SaturatedSoil& soil, WaterInertia inertia) {
  const double n = soil.porosity, s = soil.solid_density, w = soil.water_density, rho = soil.density();
  if (inertia == WaterInertia::own) return {(1 - n) * s + (1 - n) * (1 - n) * w / n, (1 - n) * (s - w)};
  if (inertia == WaterInertia::none_in_darcy) return {rho, rho};
  require(s > w, "u-p without water storage has no inertia left unless the grains are denser than water");
  return {rho - w, rho};
}

struct ColumnState {
  double displacement;      ///< u of the grains, m, upwards positive
  double velocity;          ///< u_t; the Darcy flux n (v_w - v_s) is -u_t
  double effective_stress;  ///< M u_z, Pa, negative in compression
  double pressure;          ///< p, Pa
};

class TelegraphColumn {
 public:
  TelegraphColumn(const SaturatedSoil& soil, double height, double load, WaterInertia inertia)
      : M(soil.modulus), H(height), q(load), masses(telegraph_masses(soil, inertia)) {
    b = soil.water_unit_weight() / soil.conductivity;
    a = b / (2 * masses.inertia);
    c = std::sqrt(M / masses.inertia);
  }

  /// Speed of the front, m/s, and the rate 1/s at which it fades.
  double wave_speed() const { return c; }
  double damping_rate() const { return a; }

  ColumnState at(double z, double t) const {
    if (t <= 0) return {0, 0, 0, 0};
    Sums sum = front(z, t);
    // The rest falls off as 1 / kappa^2 at least, once c kappa is well above a.
    const int terms = static_cast<int>(std::min(2e5, 1000 + 10 * a * H / c));
    double sign = 1;
    for (int m = 0; m < terms; ++m, sign = -sign) {
      const double kappa = (m + 0.5) * std::numbers::pi / H;
      const Mode mode = time_function(kappa, t);
      if (mode.negligible) break;
      const double amplitude = 2 * q / (M * H) * sign / (kappa * kappa);
      const double sine = amplitude * std::sin(kappa * z), cosine = amplitude * std::cos(kappa * z);
      sum.u += mode.value * sine;
      sum.u_z += mode.value * kappa * cosine;
      sum.u_t += mode.rate * sine;
      sum.flux += mode.rate / kappa * cosine;
    }
    const double stress = -q + M * sum.u_z;
    // (EX.9) with the acceleration taken from (EX.8): int u_tt = -(q + M u_z + b int u_t) / m_e.
    const double acceleration = -(q + stress + b * sum.flux) / masses.inertia;
    return {-q * z / M + sum.u, sum.u_t, stress, q + stress + masses.pressure * acceleration};
  }

 private:
  /// Sums over the modes: u and u_z less the static part, u_t, and the integral of u_t from z to H.
  struct Sums {
    double u, u_z, u_t, flux;
  };
  struct Mode {
    double value, rate;
    bool negligible;
  };

  /// Period 4 H: 1 for |x| < H, else -1; and its integral, x for |x| < H.
  double square(double x) const {
    const double value = std::cos(std::numbers::pi * x / (2 * H));
    return value > 0 ? 1 : value < 0 ? -1 : 0;
  }
  double triangle(double x) const {
    return 2 * H / std::numbers::pi * std::asin(std::sin(std::numbers::pi * x / (2 * H)));
  }

  Sums front(double z, double t) const {
    const double fade = q / (2 * M) * std::exp(-a * t), up = z + c * t, down = z - c * t;
    return {fade * (triangle(up) + triangle(down)), fade * (square(up) + square(down)),
            fade * c * (square(up) - square(down)), fade * c * (triangle(down) - triangle(up))};
  }

  /// T(t) / T(0) of T'' + 2 a T' + c^2 kappa^2 T = 0, T'(0) = 0, and its rate, both less their part in `front`.
  Mode time_function(double kappa, double t) const {
    using Complex = std::complex<double>;
    const double omega = c * kappa;
    const Complex d = std::sqrt(Complex(a * a - omega * omega));
    const Complex s1 = -omega * omega / (a + d), s2 = -(a + d);
    const Complex e1 = std::exp(s1 * t);
    const Complex difference = std::abs(d * t) < 1e-4 ? t * std::exp(-a * t) * (1.0 + d * d * t * t / 6.0)
                                                      : (e1 - std::exp(s2 * t)) / (2.0 * d);
    const double fade = std::exp(-a * t);
    const double value = (e1 - s1 * difference).real() - fade * std::cos(omega * t);
    const double rate = -omega * omega * difference.real() + fade * omega * std::sin(omega * t);
    return {value, rate, s1.real() * t < -45};
  }

  double M, H, q;
  TelegraphMasses masses;
  double a, b, c;
};

/// exp(-x) I0(x) for x >= 0.
inline double scaled_bessel_i0(double x) {
  if (x < 500) return std::exp(-x) * std::cyl_bessel_i(0, x);
  return (1 + 1 / (8 * x) + 9 / (128 * x * x)) / std::sqrt(2 * std::numbers::pi * x);
}

/// Settlement of the half-space at `depth` under the load f(t) at its drained surface, downwards positive (EX.13):
///     u = 1 / sqrt(M m_e) int_{z/c}^t f(t - s) exp(-a s) I0(a sqrt(s^2 - z^2 / c^2)) ds
/// The column follows it until the wave that its base reflects arrives, at t = (2 H - depth) / c.
inline double half_space_settlement(const SaturatedSoil& soil, WaterInertia inertia,
                                    const std::function<double(double)>& load, double depth, double t) {
  const double m_e = telegraph_masses(soil, inertia).inertia, c = std::sqrt(soil.modulus / m_e);
  const double a = soil.water_unit_weight() / soil.conductivity / (2 * m_e), arrival = depth / c;
  if (t <= arrival) return 0;
  // s = arrival + r^2 takes the steep start 1 / sqrt(s) out; Simpson's rule in r.
  const int intervals = 4000;
  const double h = std::sqrt(t - arrival) / intervals;
  double sum = 0;
  for (int i = 0; i <= intervals; ++i) {
    const double r = i * h, s = arrival + r * r, x = a * std::sqrt(std::max(0.0, s * s - arrival * arrival));
    const double weight = i == 0 || i == intervals ? 1 : i % 2 ? 4 : 2;
    sum += weight * 2 * r * load(t - s) * std::exp(x - a * s) * scaled_bessel_i0(x);
  }
  return sum * h / 3 / std::sqrt(soil.modulus * m_e);
}

}  // namespace sluice::exact
