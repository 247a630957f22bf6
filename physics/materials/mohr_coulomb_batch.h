/// Mohr-Coulomb over chunks of points: the parts of MohrCoulomb::update that are compiled for several vector units.
/// Equations MC.x: docs/materials/mohr_coulomb.md.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "physics/materials/elastic_trial.h"
#include "physics/materials/mohr_coulomb_return.h"
#include "physics/materials/softening.h"

namespace sluice::mohr_coulomb {

// ---- where the strength of a point comes from: one of the following is a template argument of the update ----

/// The same at all points. Its constants are worked out beforehand.
struct Perfect {
  static constexpr int states = 1;  ///< columns of the material; the first is the equivalent plastic strain
  MohrCoulombReturn map;

  double tension_cutoff() const { return map.cutoff; }
  template <int Dim>
  SLUICE_ALWAYS_INLINE MohrCoulombStrength strength(const Chunk<Dim, states>&, int) const {
    return {map.sin_friction, map.strength, 0};
  }
  template <int Dim>
  SLUICE_ALWAYS_INLINE MohrCoulombReturn at(const Chunk<Dim, states>&, int) const {
    return map;
  }
};

/// Falls from peak to residual with the plastic strain that the point has at the beginning of the step (SO.1).
struct Softened {
  static constexpr int states = 1;
  IsotropicElasticity elasticity;
  MohrCoulombStrength residual, drop;  ///< drop = peak - residual
  double cutoff;
  Softening softening;
  double left_by_time;  ///< share of the drop

  double tension_cutoff() const { return cutoff; }
  template <int Dim>
  SLUICE_ALWAYS_INLINE MohrCoulombStrength strength(const Chunk<Dim, states>& chunk, int lane) const {
    const double left = softening.left(chunk.state[0][lane], left_by_time);
    return {residual.sin_friction + left * drop.sin_friction, residual.strength + left * drop.strength,
            residual.sin_dilation + left * drop.sin_dilation};
  }
  template <int Dim>
  SLUICE_ALWAYS_INLINE MohrCoulombReturn at(const Chunk<Dim, states>& chunk, int lane) const {
    return MohrCoulombReturn(elasticity, strength<Dim>(chunk, lane), cutoff);
  }
};

// ---- the return ----

/// (9/2)^(1/2) times the stress that twice the shear modulus makes of the equivalent plastic strain, squared (MC.17).
SLUICE_ALWAYS_INLINE double squared_differences(PrincipalStress trial, PrincipalStress returned) {
  const double d1 = trial.s1 - returned.s1, d2 = trial.s2 - returned.s2, d3 = trial.s3 - returned.s3;
  const double a = d1 - d2, b = d2 - d3, c = d1 - d3;
  return a * a + b * b + c * c;
}

template <bool Cutoff>
SLUICE_ALWAYS_INLINE PrincipalStress admissible(const MohrCoulombReturn& map, PrincipalStress trial) {
  PrincipalStress sheared = map.to_shear_surface(trial);
  if constexpr (!Cutoff) return sheared;
  const bool shears = map.yield(trial) > 0;
  sheared = {shears ? sheared.s1 : trial.s1, shears ? sheared.s2 : trial.s2, shears ? sheared.s3 : trial.s3};
  return map.to_cutoff(trial, sheared);
}

using Plane = double[symmetric_components<2>][chunk_lanes];

/// Marks the lanes whose trial stress is not admissible; true if there is one. Plane strain, without square roots: with
/// in-plane centre m and radius R, each ordered pair of principal stresses yields where R exceeds a threshold (MC.4).
template <class Strengths>
SLUICE_ALWAYS_INLINE bool find_yielding(const Strengths& strengths, const Chunk<2, Strengths::states>& chunk,
                                        const Plane& trial, std::int64_t (&yields)[chunk_lanes]) {
  const double cutoff = strengths.tension_cutoff();
  std::int64_t any = 0;
#pragma GCC ivdep
  for (int i = 0; i < chunk_lanes; ++i) {
    const MohrCoulombStrength own = strengths.template strength<2>(chunk, i);
    const double up = 1 + own.sin_friction, down = 1 - own.sin_friction;
    const double centre = 0.5 * (trial[0][i] + trial[1][i]);
    const double half_difference = 0.5 * (trial[0][i] - trial[1][i]);
    const double radius2 = half_difference * half_difference + trial[3][i] * trial[3][i];
    const double zz = trial[2][i];
    // Multiplied by 1 - sin(phi) and 1 + sin(phi), for divisions are slow.
    const double in_plane = 0.5 * own.strength - own.sin_friction * centre;
    const double zz_first = own.strength - up * zz + down * centre;
    const double zz_last = own.strength + down * zz - up * centre;
    const double tension = cutoff - centre;
    const double alike = in_plane < tension ? in_plane : tension;
    const double least = zz_first < zz_last ? zz_first : zz_last;
    const bool beyond = (radius2 > alike * alike) | (down * down * radius2 > zz_first * zz_first) |
                        (up * up * radius2 > zz_last * zz_last);
    const bool yield = (alike < 0) | (least < 0) | beyond | (zz > cutoff);
    yields[i] = yield ? 1 : 0;
    any |= yields[i];
  }
  return any != 0;
}

/// The returned stress of all lanes, as if all yielded, and their increments of plastic strain. The in-plane directions
/// are those of the trial stress: cos 2 theta = (sxx - syy) / 2R, sin 2 theta = sxy / R.
template <bool Cutoff, class Strengths>
SLUICE_ALWAYS_INLINE void return_plane(const Strengths& strengths, const Chunk<2, Strengths::states>& chunk,
                                       double strain_factor, const Plane& trial_stress, Plane& stress,
                                       double (&strain_increment)[chunk_lanes]) {
#pragma GCC ivdep
  for (int i = 0; i < chunk_lanes; ++i) {
    const MohrCoulombReturn map = strengths.template at<2>(chunk, i);
    const double xx = trial_stress[0][i], yy = trial_stress[1][i], zz = trial_stress[2][i], xy = trial_stress[3][i];
    const double centre = 0.5 * (xx + yy), half_difference = 0.5 * (xx - yy);
    const double radius = std::sqrt(half_difference * half_difference + xy * xy);
    const double major = centre + radius, minor = centre - radius;
    const bool zz_first = zz > major, zz_last = zz < minor;
    const double at_least_major = zz_first ? major : zz;
    const PrincipalStress trial = {zz_first ? zz : major, zz_last ? minor : at_least_major, zz_last ? zz : minor};

    const PrincipalStress returned = admissible<Cutoff>(map, trial);

    const double new_major = zz_first ? returned.s2 : returned.s1;
    const double new_minor = zz_last ? returned.s2 : returned.s3;
    const double zz_below = zz_last ? returned.s3 : returned.s2;
    const double scale = 0.5 * (new_major - new_minor) / (radius > 0 ? radius : 1);
    const double new_centre = 0.5 * (new_major + new_minor);
    stress[0][i] = new_centre + scale * half_difference;
    stress[1][i] = new_centre - scale * half_difference;
    stress[2][i] = zz_first ? returned.s1 : zz_below;
    stress[3][i] = scale * xy;
    strain_increment[i] = strain_factor * std::sqrt(squared_differences(trial, returned));
  }
}

/// Takes over the returned stress, and the increment of plastic strain, of the marked lanes. Apart from the return,
/// because GCC makes branches of a long computation whose result is selected at its end.
SLUICE_ALWAYS_INLINE void accept_plane(const std::int64_t (&yields)[chunk_lanes], const Plane& returned,
                                       const double (&strain_increment)[chunk_lanes], Plane& stress, double* strain) {
#pragma GCC ivdep
  for (int i = 0; i < chunk_lanes; ++i) {
    const bool yield = yields[i] != 0;
    for (int k = 0; k < 4; ++k) stress[k][i] = yield ? returned[k][i] : stress[k][i];
    strain[i] += yield ? strain_increment[i] : 0;
  }
}

using Solid = double[symmetric_components<3>][chunk_lanes];

/// Marks the lanes that may yield in 3-D by a bound that needs no principal values: over all Lode angles,
/// f <= 2 sin(phi) p + 2 (1 + sin^2(phi) / 3)^(1/2) J2^(1/2) - 2 c cos(phi) and s1 <= p + (4/3 J2)^(1/2) (MC.5).
template <class Strengths>
SLUICE_ALWAYS_INLINE bool find_candidates(const Strengths& strengths, const Chunk<3, Strengths::states>& chunk,
                                          const Solid& trial, std::int64_t (&candidate)[chunk_lanes]) {
  constexpr double half_sqrt3 = 0.5 * std::numbers::sqrt3;
  const double cutoff = strengths.tension_cutoff();
  std::int64_t any = 0;
#pragma GCC ivdep
  for (int i = 0; i < chunk_lanes; ++i) {
    const MohrCoulombStrength own = strengths.template strength<3>(chunk, i);
    const double inverse_amplitude = 1 / std::sqrt(1 + own.sin_friction * own.sin_friction / 3);
    const double mean = (trial[0][i] + trial[1][i] + trial[2][i]) * (1.0 / 3);
    const double xx = trial[0][i] - mean, yy = trial[1][i] - mean, zz = trial[2][i] - mean;
    const double j2 = 0.5 * (xx * xx + yy * yy + zz * zz) + trial[3][i] * trial[3][i] + trial[4][i] * trial[4][i] +
                      trial[5][i] * trial[5][i];
    const double shear = inverse_amplitude * (0.5 * own.strength - own.sin_friction * mean);
    const double tension = half_sqrt3 * (cutoff - mean);
    const double threshold = shear < tension ? shear : tension;
    const bool may_yield = (threshold < 0) | (j2 > threshold * threshold);
    candidate[i] = may_yield ? 1 : 0;
    any |= candidate[i];
  }
  return any != 0;
}

/// The update of a plane-strain batch; `Cutoff` says whether tension is cut off anywhere, `strain_factor` is
/// 2^(1/2) / 6G (MC.17).
template <bool Cutoff, class Strengths>
SLUICE_ALWAYS_INLINE void update_plane(const MaterialBatch<2>& batch, IsotropicElasticity elasticity,
                                       Strengths strengths, double strain_factor) {
  constexpr int states = Strengths::states;
  const auto update = [&](const Chunk<2, states>& chunk) SLUICE_INLINE_LAMBDA {
    alignas(64) Plane stress, returned;
    alignas(64) std::int64_t yields[chunk_lanes];
    alignas(64) double strain_increment[chunk_lanes];
    elastic_trial<2>(chunk, elasticity, stress);
    if (find_yielding(strengths, chunk, stress, yields)) {
      return_plane<Cutoff>(strengths, chunk, strain_factor, stress, returned, strain_increment);
      accept_plane(yields, returned, strain_increment, stress, chunk.state[0]);
    }
    store_stress<2>(stress, chunk);
  };
  for_each_chunk<2, states>(batch, update);
}

/// The admissible stress of the point in `lane`, in place, with its addition to `strain`. Not inlined: 3-D points that
/// may yield are few, and are returned one at a time.
void return_point(const MohrCoulombReturn& map, bool cutoff, double strain_factor, Solid& stress, int lane,
                  double& strain);

/// The update of a batch in 3-D.
template <bool Cutoff, class Strengths>
SLUICE_ALWAYS_INLINE void update_solid(const MaterialBatch<3>& batch, IsotropicElasticity elasticity,
                                       Strengths strengths, double strain_factor) {
  constexpr int states = Strengths::states;
  const auto update = [&](const Chunk<3, states>& chunk) SLUICE_INLINE_LAMBDA {
    alignas(64) Solid stress;
    alignas(64) std::int64_t candidate[chunk_lanes];
    elastic_trial<3>(chunk, elasticity, stress);
    if (find_candidates(strengths, chunk, stress, candidate)) {
      for (int lane = 0; lane < chunk_lanes; ++lane) {
        if (candidate[lane] == 0) continue;
        return_point(strengths.template at<3>(chunk, lane), Cutoff, strain_factor, stress, lane, chunk.state[0][lane]);
      }
    }
    store_stress<3>(stress, chunk);
  };
  for_each_chunk<3, states>(batch, update);
}

/// The same for either dimension.
template <bool Cutoff, int Dim, class Strengths>
SLUICE_ALWAYS_INLINE void update(const MaterialBatch<Dim>& batch, IsotropicElasticity elasticity, Strengths strengths,
                                 double strain_factor) {
  if constexpr (Dim == 2)
    update_plane<Cutoff>(batch, elasticity, strengths, strain_factor);
  else
    update_solid<Cutoff>(batch, elasticity, strengths, strain_factor);
}

}  // namespace sluice::mohr_coulomb
