/// The yardstick of tests/performance: an explicit MPM step as a textbook would write it.
///
/// Structure of arrays, scalar loops over particles, one thread; 2-D plane strain, linear shape functions, USF, FLIP,
/// Jaumann rate, Mohr-Coulomb with the closed-form return of de Souza Neto et al. (2008). A dense grid, no blocks, no
/// chunks, no sorting.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace plain {

struct Material {
  double lambda, shear, sin_phi, cos_phi, cohesion, sin_psi;
};

struct Body {
  std::vector<double> x, y, vx, vy, m, V, sxx, syy, szz, sxy, ep;
  std::vector<int> material;
};

struct Grid {
  double x0, y0, h;
  int nx, ny;  // nodes
  std::vector<double> m, px, py, fx, fy, vx, vy, ax, ay;
  double friction;
};

/// Returns the principal stresses s[0] >= s[1] >= s[2] to the Mohr-Coulomb surface; the equivalent plastic deviatoric
/// strain.
inline double return_map(const Material& k, std::array<double, 3>& s) {
  const auto f = [&](double a, double b) { return (a - b) + (a + b) * k.sin_phi - 2 * k.cohesion * k.cos_phi; };
  if (f(s[0], s[2]) <= 0) return 0;
  const std::array<double, 3> trial = s;
  const double G = k.shear, L = k.lambda, c4 = 4 * L * k.sin_phi * k.sin_psi;
  const double a = c4 + 4 * G * (1 + k.sin_phi * k.sin_psi);
  const double up = 2 * G * (1 + k.sin_psi), down = 2 * G * (1 - k.sin_psi), vol = 2 * L * k.sin_psi;
  const double dg = f(s[0], s[2]) / a;
  s = {trial[0] - dg * (up + vol), trial[1] - dg * vol, trial[2] + dg * (down - vol)};
  if (s[0] < s[1] || s[1] < s[2]) {
    const bool right = (1 - k.sin_psi) * trial[0] - 2 * trial[1] + (1 + k.sin_psi) * trial[2] > 0;
    const double b = c4 + 2 * G *
                              (right ? 1 + k.sin_phi + k.sin_psi + k.sin_phi * k.sin_psi
                                     : 1 - k.sin_phi - k.sin_psi + k.sin_phi * k.sin_psi);
    const double fa = f(trial[0], trial[2]), fb = right ? f(trial[0], trial[1]) : f(trial[1], trial[2]);
    const double ga = (a * fa - b * fb) / (a * a - b * b), gb = (a * fb - b * fa) / (a * a - b * b);
    if (right)
      s = {trial[0] - (ga + gb) * (up + vol), trial[1] - ga * vol + gb * (down - vol),
           trial[2] + ga * (down - vol) - gb * vol};
    else
      s = {trial[0] - ga * (up + vol) - gb * vol, trial[1] - ga * vol - gb * (up + vol),
           trial[2] + (ga + gb) * (down - vol)};
    if (s[0] < s[2] && k.sin_phi > 0) s.fill(k.cohesion * k.cos_phi / k.sin_phi);
  }
  const std::array<double, 3> d = {trial[0] - s[0], trial[1] - s[1], trial[2] - s[2]};
  const double mean = (d[0] + d[1] + d[2]) / 3;
  return std::sqrt(2.0 / 3 *
                   ((d[0] - mean) * (d[0] - mean) + (d[1] - mean) * (d[1] - mean) + (d[2] - mean) * (d[2] - mean))) /
         (2 * G);
}

inline void update_stress(const Material& k, Body& b, std::size_t p, double exx, double eyy, double exy, double w) {
  const double vol = k.lambda * (exx + eyy), old_xx = b.sxx[p], old_yy = b.syy[p], old_xy = b.sxy[p];
  const double xx = old_xx - 2 * w * old_xy + vol + 2 * k.shear * exx;
  const double yy = old_yy + 2 * w * old_xy + vol + 2 * k.shear * eyy;
  const double xy = old_xy + w * (old_xx - old_yy) + 2 * k.shear * exy, zz = b.szz[p] + vol;
  const double centre = 0.5 * (xx + yy), difference = 0.5 * (xx - yy),
               radius = std::sqrt(difference * difference + xy * xy);
  std::array<double, 3> s = {centre + radius, centre - radius, zz};
  std::array<int, 3> place = {0, 1, 2};
  std::sort(place.begin(), place.end(),
            [&](int i, int j) { return s[static_cast<std::size_t>(i)] > s[static_cast<std::size_t>(j)]; });
  std::array<double, 3> sorted;
  for (std::size_t i = 0; i < 3; ++i) sorted[i] = s[static_cast<std::size_t>(place[i])];
  b.ep[p] += return_map(k, sorted);
  for (std::size_t i = 0; i < 3; ++i) s[static_cast<std::size_t>(place[i])] = sorted[i];
  const double c2 = radius > 0 ? difference / radius : 1, s2 = radius > 0 ? xy / radius : 0;
  const double new_centre = 0.5 * (s[0] + s[1]), new_radius = 0.5 * (s[0] - s[1]);
  b.sxx[p] = new_centre + new_radius * c2;
  b.syy[p] = new_centre - new_radius * c2;
  b.sxy[p] = new_radius * s2;
  b.szz[p] = s[2];
}

struct Stencil {
  std::array<int, 4> node;
  std::array<double, 4> n, dx, dy;
};

inline Stencil stencil(const Grid& g, double x, double y) {
  const double s = (x - g.x0) / g.h, t = (y - g.y0) / g.h;
  const int i = static_cast<int>(s), j = static_cast<int>(t), k = j * g.nx + i;
  const double a = s - i, b = t - j, q = 1 / g.h;
  return {{k, k + 1, k + g.nx, k + g.nx + 1},
          {(1 - a) * (1 - b), a * (1 - b), (1 - a) * b, a * b},
          {-(1 - b) * q, (1 - b) * q, -b * q, b * q},
          {-(1 - a) * q, -a * q, (1 - a) * q, a * q}};
}

inline void step(Body& b, Grid& g, const std::vector<Material>& materials, double gravity, double dt) {
  const std::size_t count = b.x.size(), nodes = g.m.size();
  for (auto* field : {&g.m, &g.px, &g.py, &g.fx, &g.fy}) std::fill(field->begin(), field->end(), 0.0);
  for (std::size_t p = 0; p < count; ++p) {  // particles to nodes
    const Stencil s = stencil(g, b.x[p], b.y[p]);
    for (std::size_t k = 0; k < 4; ++k) {
      const auto i = static_cast<std::size_t>(s.node[k]);
      g.m[i] += s.n[k] * b.m[p];
      g.px[i] += s.n[k] * b.m[p] * b.vx[p];
      g.py[i] += s.n[k] * b.m[p] * b.vy[p];
    }
  }
  for (std::size_t i = 0; i < nodes; ++i) {  // nodal velocities
    g.vx[i] = g.m[i] > 0 ? g.px[i] / g.m[i] : 0;
    g.vy[i] = g.m[i] > 0 && i >= static_cast<std::size_t>(g.nx) ? g.py[i] / g.m[i] : 0;
  }
  for (std::size_t p = 0; p < count; ++p) {  // stress, then internal forces
    const Stencil s = stencil(g, b.x[p], b.y[p]);
    double lxx = 0, lxy = 0, lyx = 0, lyy = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const auto i = static_cast<std::size_t>(s.node[k]);
      lxx += s.dx[k] * g.vx[i];
      lxy += s.dy[k] * g.vx[i];
      lyx += s.dx[k] * g.vy[i];
      lyy += s.dy[k] * g.vy[i];
    }
    update_stress(materials[static_cast<std::size_t>(b.material[p])], b, p, dt * lxx, dt * lyy, 0.5 * dt * (lxy + lyx),
                  0.5 * dt * (lyx - lxy));
    b.V[p] *= 1 + dt * (lxx + lyy);
    for (std::size_t k = 0; k < 4; ++k) {
      const auto i = static_cast<std::size_t>(s.node[k]);
      g.fx[i] -= b.V[p] * (b.sxx[p] * s.dx[k] + b.sxy[p] * s.dy[k]);
      g.fy[i] -= b.V[p] * (b.sxy[p] * s.dx[k] + b.syy[p] * s.dy[k]);
    }
  }
  for (std::size_t i = 0; i < nodes; ++i) {  // momentum balance, rough floor
    if (g.m[i] <= 0) continue;
    double vx = (g.px[i] + dt * g.fx[i]) / g.m[i], vy = (g.py[i] + dt * g.fy[i]) / g.m[i] + dt * gravity;
    if (i < static_cast<std::size_t>(g.nx)) {
      const double pressing = std::max(0.0, -vy), slip = std::abs(vx);
      vx = slip > g.friction * pressing ? vx * (1 - g.friction * pressing / slip) : 0;
      vy = 0;
    }
    g.ax[i] = vx - g.px[i] / g.m[i];
    g.ay[i] = vy - g.py[i] / g.m[i];
    g.vx[i] = vx;
    g.vy[i] = vy;
  }
  for (std::size_t p = 0; p < count; ++p) {  // nodes to particles
    const Stencil s = stencil(g, b.x[p], b.y[p]);
    double ux = 0, uy = 0, cx = 0, cy = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const auto i = static_cast<std::size_t>(s.node[k]);
      ux += s.n[k] * g.vx[i];
      uy += s.n[k] * g.vy[i];
      cx += s.n[k] * g.ax[i];
      cy += s.n[k] * g.ay[i];
    }
    b.vx[p] += cx;
    b.vy[p] += cy;
    b.x[p] += dt * ux;
    b.y[p] += dt * uy;
  }
}

}  // namespace plain
