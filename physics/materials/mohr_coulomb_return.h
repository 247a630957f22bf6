/// The Mohr-Coulomb return map in principal space, with a tension cut-off. Equations MC.x:
/// docs/materials/mohr_coulomb.md.
///
/// Everything is closed form and free of branches, so that loops over lanes vectorize.
/// Sources: de Souza Neto, Peric & Owen (2008), Computational Methods for Plasticity, ch. 8; Clausen, Damkilde &
/// Andersen (2007), Computers & Structures 85, 1795-1807.
#pragma once

#include <limits>

#include "core/parallel/multitarget.h"
#include "physics/materials/material.h"

namespace sluice {

/// Angles in radians, stresses in Pa.
struct MohrCoulombParameters {
  IsotropicElasticity elasticity;
  double friction_angle = 0;                                        ///< [0, pi/2)
  double cohesion = 0;                                              ///< >= 0, and > 0 where the friction angle is zero
  double dilation_angle = 0;                                        ///< [0, friction_angle]
  double tension_cutoff = std::numeric_limits<double>::infinity();  ///< >= 0; infinite: none
};

/// Principal stresses, s1 >= s2 >= s3, tension positive [Pa].
struct PrincipalStress {
  double s1, s2, s3;
};

/// Strength and flow in the form that the return asks for, which softening interpolates (SO.1).
struct MohrCoulombStrength {
  explicit MohrCoulombStrength(const MohrCoulombParameters& parameters);
  SLUICE_ALWAYS_INLINE MohrCoulombStrength(double sin_friction_, double strength_, double sin_dilation_)
      : sin_friction(sin_friction_), strength(strength_), sin_dilation(sin_dilation_) {}

  double sin_friction;
  double strength;  ///< 2 c cos(phi)
  double sin_dilation;
};

/// The constants of the return: worked out once a material, or once a point where strengths differ from point to point.
struct MohrCoulombReturn {
  explicit MohrCoulombReturn(const MohrCoulombParameters& parameters);
  SLUICE_ALWAYS_INLINE MohrCoulombReturn(IsotropicElasticity elasticity, MohrCoulombStrength strengths,
                                         double tension_cutoff);

  double sin_friction;
  double strength;   ///< 2 c cos(phi)
  double apex;       ///< c cot(phi), infinite where phi = 0
  double cutoff;     ///< limit of the largest principal stress; infinite unless it lies below the apex
  double cutoff_s3;  ///< s3 where the cut-off meets the face (MC.15)

  double yield_slope, yield_intercept;  ///< on the surface s1 = yield_slope * s3 + yield_intercept (MC.3)
  double face_multiplier;               ///< multiplier of the face over f (MC.7)
  double face_s2, face_s3;              ///< drop of s2 and s3 over f on the way to the face (MC.7)
  double lower_edge_s3;                 ///< drop of s2 = s3 over f on the way to the edge s2 = s3 (MC.9)
  double upper_edge_s3;                 ///< drop of s3 over f on the way to the edge s1 = s2 (MC.10)
  double lower_gap;                     ///< least (s2 - s3) / multiplier that the face keeps in order (MC.8)
  double upper_gap;                     ///< least (s1 - s2) / multiplier that the face keeps in order (MC.8)

  double cutoff_plane;  ///< lambda / (lambda + 2 G) (MC.12)
  double cutoff_edge;   ///< lambda / (2 lambda + 2 G), Poisson's ratio (MC.13, MC.16)

  bool has_cutoff() const { return cutoff < std::numeric_limits<double>::infinity(); }

  /// The yield function without cut-off (MC.2) [Pa].
  SLUICE_ALWAYS_INLINE double yield(PrincipalStress s) const {
    return (1 + sin_friction) * s.s1 - (1 - sin_friction) * s.s3 - strength;
  }

  /// The admissible stress that belongs to a trial stress with yield(trial) > 0. Cut-off not regarded.
  SLUICE_ALWAYS_INLINE PrincipalStress to_shear_surface(PrincipalStress trial) const;

  /// The same for any trial, with the cut-off; `sheared` is the trial itself or, if it yields, its to_shear_surface.
  SLUICE_ALWAYS_INLINE PrincipalStress to_cutoff(PrincipalStress trial, PrincipalStress sheared) const;
};

SLUICE_ALWAYS_INLINE MohrCoulombReturn::MohrCoulombReturn(IsotropicElasticity elasticity, MohrCoulombStrength strengths,
                                                          double tension_cutoff) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const double lambda = elasticity.lambda, shear = elasticity.shear, sin_dilation = strengths.sin_dilation;
  sin_friction = strengths.sin_friction;
  strength = strengths.strength;
  const double up = 1 + sin_friction, down = 1 - sin_friction;

  // What a unit multiplier takes from the principal stresses: D times the flow direction (MC.6).
  const double drop2 = 2 * lambda * sin_dilation;
  const double drop1 = drop2 + 2 * shear * (1 + sin_dilation);
  const double drop3 = drop2 - 2 * shear * (1 - sin_dilation);
  const double lower_drop3 = 0.5 * (drop2 + drop3), upper_drop1 = 0.5 * (drop1 + drop2);
  const double face = up * drop1 - down * drop3;
  const double lower = up * drop1 - down * lower_drop3, upper = up * upper_drop1 - down * drop3;

  // Few divisions, for they are slow.
  const double inverse_cosine = 1 / (up * down), edges = lower * upper, inverse = 1 / (face * edges);
  const bool has_apex = sin_friction > 0;
  const double where_apex = strength / (has_apex ? 2 * sin_friction : 1);
  apex = has_apex ? where_apex : infinity;
  cutoff = tension_cutoff < apex ? tension_cutoff : infinity;
  cutoff_s3 = (up * cutoff - strength) * (up * inverse_cosine);
  yield_slope = down * (down * inverse_cosine);
  yield_intercept = strength * (down * inverse_cosine);
  face_multiplier = inverse * edges;
  face_s2 = drop2 * face_multiplier;
  face_s3 = drop3 * face_multiplier;
  lower_edge_s3 = lower_drop3 * (inverse * face * upper);
  upper_edge_s3 = drop3 * (inverse * face * lower);
  lower_gap = 2 * shear * (1 - sin_dilation);
  upper_gap = 2 * shear * (1 + sin_dilation);

  cutoff_plane = lambda / (lambda + 2 * shear);
  cutoff_edge = lambda / (2 * lambda + 2 * shear);
}

SLUICE_ALWAYS_INLINE PrincipalStress MohrCoulombReturn::to_shear_surface(PrincipalStress trial) const {
  // The face leaves its sector of s1 >= s2 >= s3 where a gap closes; then the edge of the narrower gap (MC.8).
  const double face_yield = yield(trial);
  const double multiplier = face_multiplier * face_yield;
  const double upper = trial.s1 - trial.s2, lower = trial.s2 - trial.s3;
  const bool outside = (upper < multiplier * upper_gap) | (lower < multiplier * lower_gap);
  const bool to_lower_edge = lower * upper_gap < upper * lower_gap;

  // On the edge s2 = s3 the two planes act together as one plane on s1 and the mean of s2 and s3 (MC.9); on the edge
  // s1 = s2 likewise (MC.10).
  const double mean_lower = 0.5 * (trial.s2 + trial.s3);
  const double mean_upper = 0.5 * (trial.s1 + trial.s2);
  const double lower_edge = mean_lower - lower_edge_s3 * yield({trial.s1, mean_lower, mean_lower});
  const double upper_edge = trial.s3 - upper_edge_s3 * yield({mean_upper, mean_upper, trial.s3});
  const double edge = to_lower_edge ? lower_edge : upper_edge;
  const double face = trial.s3 - face_s3 * face_yield;
  const double unlimited = outside ? edge : face;

  // Beyond the apex the order turns round: s1 < s3 exactly where s3 > apex (MC.11).
  const bool at_apex = unlimited > apex;
  const double s3 = at_apex ? apex : unlimited;
  const double on_surface = yield_slope * s3 + yield_intercept;
  const double s1 = at_apex ? apex : on_surface;
  const double face_middle = trial.s2 - face_s2 * face_yield;
  const double edge_middle = to_lower_edge ? s3 : s1;
  const double middle = outside ? edge_middle : face_middle;
  const double below = middle > s1 ? s1 : middle;
  return {s1, below < s3 ? s3 : below, s3};
}

SLUICE_ALWAYS_INLINE PrincipalStress MohrCoulombReturn::to_cutoff(PrincipalStress trial,
                                                                  PrincipalStress sheared) const {
  // Cut-off alone: one, two or three principal stresses at the limit (MC.12 to MC.14).
  const double over1 = trial.s1 - cutoff, over2 = trial.s2 - cutoff;
  const double plane_drop = cutoff_plane * over1, edge_drop = cutoff_edge * (over1 + over2);
  const bool on_edge = trial.s2 - plane_drop > cutoff;
  const double plane2 = trial.s2 - plane_drop;
  const double s2 = on_edge ? cutoff : plane2;
  const double unlimited3 = trial.s3 - (on_edge ? edge_drop : plane_drop);
  const double s3 = unlimited3 > cutoff ? cutoff : unlimited3;

  // With the shear planes: s1 and s3 are known, and s2, in whose direction nothing flows, ends at a corner (MC.16).
  const bool meets_shear = s3 < cutoff_s3;
  const double free2 = trial.s2 - cutoff_edge * (over1 + (trial.s3 - cutoff_s3));
  const double below2 = free2 > cutoff ? cutoff : free2;
  const double corner2 = below2 < cutoff_s3 ? cutoff_s3 : below2;

  const bool acts = sheared.s1 > cutoff;
  const double cut2 = meets_shear ? corner2 : s2;
  const double cut3 = meets_shear ? cutoff_s3 : s3;
  return {acts ? cutoff : sheared.s1, acts ? cut2 : sheared.s2, acts ? cut3 : sheared.s3};
}

}  // namespace sluice
