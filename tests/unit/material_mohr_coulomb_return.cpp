/// The Mohr-Coulomb return map in principal space. Stresses are in kPa-sized numbers of Pa; `scale` in the tolerances
/// is the size of the trial stress, for the map is linear in it and its errors are round-off.
#include <gtest/gtest.h>

#include <map>
#include <random>
#include <string>

#include "tests/unit/material_mohr_coulomb_planes.h"

namespace sluice {
namespace {

using reference::Polyhedron;
using reference::Vector3d;

constexpr double degree = 3.14159265358979323846 / 180;
constexpr double none = std::numeric_limits<double>::infinity();

PrincipalStress sorted(Vector3d s) {
  std::sort(s.begin(), s.end());
  return {s[2], s[1], s[0]};
}

Vector3d vector(PrincipalStress s) { return {s.s1, s.s2, s.s3}; }

PrincipalStress admissible(const MohrCoulombReturn& map, PrincipalStress trial) {
  const PrincipalStress sheared = map.yield(trial) > 0 ? map.to_shear_surface(trial) : trial;
  return map.has_cutoff() ? map.to_cutoff(trial, sheared) : sheared;
}

MohrCoulombParameters parameters(double friction, double dilation, double cohesion, double cutoff = none,
                                 double poisson_ratio = 0.3) {
  return {.elasticity = IsotropicElasticity::from_young(2e6, poisson_ratio),
          .friction_angle = friction * degree,
          .cohesion = cohesion,
          .dilation_angle = dilation * degree,
          .tension_cutoff = cutoff};
}

double apex(const MohrCoulombParameters& p) {
  return p.friction_angle > 0 ? p.cohesion / std::tan(p.friction_angle) : none;
}

/// Friction 0 to 45 degrees, dilation none, half and full, with and without cohesion and cut-off, nu from -0.2 to 0.49.
std::vector<MohrCoulombParameters> sweep() {
  std::vector<MohrCoulombParameters> all;
  for (const double nu : {-0.2, 0.0, 0.3, 0.49}) {
    for (const double phi : {0.0, 20.0, 35.0, 45.0}) {
      for (const double part : {0.0, 0.5, 1.0}) {
        if (phi == 0 && part > 0) continue;
        for (const double c : {0.0, 10e3}) {
          if (phi == 0 && c == 0) continue;
          for (const double cutoff : {none, 0.0, 4e3}) {
            const MohrCoulombParameters p = parameters(phi, part * phi, c, cutoff, nu);
            if (cutoff == none || cutoff < apex(p)) all.push_back(p);
          }
        }
      }
    }
  }
  return all;
}

std::string text(const MohrCoulombParameters& p) {
  return "phi " + std::to_string(p.friction_angle / degree) + " psi " + std::to_string(p.dilation_angle / degree) +
         " c " + std::to_string(p.cohesion) + " cutoff " + std::to_string(p.tension_cutoff) + " lambda " +
         std::to_string(p.elasticity.lambda);
}

/// Trial stresses of many sizes and signs; one in five has two equal principal values.
class Trials {
 public:
  Vector3d next() {
    const double size = std::pow(10.0, 3 + 3 * uniform_(random_));
    Vector3d s = size * Vector3d(normal_(random_), normal_(random_), normal_(random_));
    s.array() += size * normal_(random_);
    if (uniform_(random_) < 0.2) s[1] = s[0];
    return s;
  }

 private:
  std::mt19937 random_{7};
  std::normal_distribution<double> normal_;
  std::uniform_real_distribution<double> uniform_{0, 1};
};

// On the surface, in order, and unchanged by a second return: 1e-12 of the trial, a few thousand round-offs.
TEST(MohrCoulombReturn, IsOnTheSurfaceAndIdempotent) {
  for (const MohrCoulombParameters& p : sweep()) {
    SCOPED_TRACE(text(p));
    const MohrCoulombReturn map(p);
    const Polyhedron polyhedron(p);
    Trials trials;
    for (int n = 0; n < 1000; ++n) {
      const Vector3d trial = trials.next();
      const double scale = trial.norm() + p.cohesion;
      const PrincipalStress once = admissible(map, sorted(trial));
      if (polyhedron.worst(trial) <= 0) {
        ASSERT_EQ(vector(once), vector(sorted(trial)));
        continue;
      }
      ASSERT_NEAR(polyhedron.worst(vector(once)), 0, 1e-12 * scale) << trial.transpose();
      ASSERT_GE(once.s1, once.s2);
      ASSERT_GE(once.s2, once.s3);
      const PrincipalStress twice = admissible(map, once);
      ASSERT_LT((vector(twice) - vector(once)).norm(), 1e-12 * vector(once).norm() + 1e-300);
    }
  }
}

// The solution of Koiter's conditions, found among all sets of planes, exists, is single and is what the map returns.
// Multipliers are hence >= 0. Without dilation nothing leads to the apex: there the map projects (MC.11).
// 1e-9 of the trial: the reference inverts matrices of condition up to 1e4.
TEST(MohrCoulombReturn, SolvesKoitersConditions) {
  for (const MohrCoulombParameters& p : sweep()) {
    SCOPED_TRACE(text(p));
    const MohrCoulombReturn map(p);
    const Polyhedron polyhedron(p);
    Trials trials;
    for (int n = 0; n < 200; ++n) {
      const Vector3d trial = trials.next();
      const double scale = trial.norm() + p.cohesion;
      const Vector3d once = vector(admissible(map, sorted(trial)));
      const std::vector<Vector3d> solutions = polyhedron.solutions(trial, 1e-11 * scale);
      if (solutions.empty()) {
        ASSERT_EQ(p.dilation_angle, 0) << trial.transpose();
        ASSERT_EQ(once, Vector3d::Constant(map.apex)) << trial.transpose();
        ASSERT_GE(trial.mean(), map.apex);
      }
      for (const Vector3d& s : solutions) {
        ASSERT_LT((vector(sorted(s)) - once).norm(), 1e-9 * scale) << trial.transpose();
      }
    }
  }
}

/// Which planes a stress lies on, as a word.
std::string region(const MohrCoulombReturn& map, PrincipalStress s) {
  const double tolerance = 1e-9 * (std::abs(s.s1) + std::abs(s.s3) + map.strength);
  const bool upper = s.s1 - s.s2 <= tolerance, lower = s.s2 - s.s3 <= tolerance;
  const bool shear = std::abs(map.yield(s)) <= tolerance;
  const std::string shape = upper && lower ? "point" : upper ? "s1=s2" : lower ? "s2=s3" : "free";
  if (!(s.s1 >= map.cutoff - tolerance)) return shear ? "shear " + shape : "elastic";
  return (shear ? "tension shear " : "tension ") + shape;
}

// One trial a region, made by adding plastic strain times stiffness, with multipliers of our choice, to a stress in the
// region: the map must take it back there. 1e-12 of the stress: round-off.
TEST(MohrCoulombReturn, HitsEveryRegion) {
  for (const double phi : {0.0, 20.0, 35.0, 45.0}) {
    for (const double part : {0.5, 1.0}) {
      const MohrCoulombParameters p = parameters(phi, part * phi, 10e3);
      SCOPED_TRACE(text(p));
      const MohrCoulombReturn map(p);
      const double n = std::sin(p.friction_angle), m = std::sin(p.dilation_angle), k = map.strength;
      const Polyhedron polyhedron(p);
      const Vector3d d13 = polyhedron.stiffness * Vector3d(1 + m, 0, -(1 - m));
      const Vector3d d12 = polyhedron.stiffness * Vector3d(1 + m, -(1 - m), 0);
      const Vector3d d23 = polyhedron.stiffness * Vector3d(0, 1 + m, -(1 - m));
      const double s3 = -50e3, s1 = ((1 - n) * s3 + k) / (1 + n);
      std::vector<std::pair<std::string, std::array<Vector3d, 2>>> cases = {
          {"shear free", {Vector3d(s1, 0.5 * (s1 + s3), s3), 0.001 * d13}},
          {"shear s2=s3", {Vector3d(s1, s3, s3), 0.02 * d13 + 0.01 * d12}},
          {"shear s1=s2", {Vector3d(s1, s1, s3), 0.02 * d13 + 0.01 * d23}}};
      if (phi > 0) {
        cases.push_back({"shear point", {Vector3d::Constant(map.apex), 0.02 * d13 + 0.015 * d12 + 0.012 * d23}});
      }
      for (const auto& [name, where] : cases) {
        SCOPED_TRACE(name);
        const PrincipalStress once = admissible(map, sorted(where[0] + where[1]));
        EXPECT_EQ(region(map, once), name);
        EXPECT_LT((vector(once) - where[0]).norm(), 1e-12 * (where[0] + where[1]).norm());
      }
    }
  }
}

// The same with a cut-off below the apex.
TEST(MohrCoulombReturn, HitsEveryRegionOfTheCutoff) {
  for (const double phi : {0.0, 20.0, 35.0, 45.0}) {
    for (const double part : {0.0, 0.5, 1.0}) {
      const MohrCoulombParameters p = parameters(phi, part * phi, 10e3, 4e3);
      SCOPED_TRACE(text(p));
      const MohrCoulombReturn map(p);
      const double m = std::sin(p.dilation_angle), t = 4e3, s3 = map.cutoff_s3;
      const Eigen::Matrix3d d = Polyhedron(p).stiffness;
      const Vector3d d13 = d * Vector3d(1 + m, 0, -(1 - m)), d12 = d * Vector3d(1 + m, -(1 - m), 0);
      const Vector3d d23 = d * Vector3d(0, 1 + m, -(1 - m));
      const Vector3d t1 = d.col(0), t2 = d.col(1), t3 = d.col(2);
      const std::vector<std::pair<std::string, std::array<Vector3d, 2>>> cases = {
          {"tension free", {Vector3d(t, 0.7 * t + 0.3 * s3, 0.2 * t + 0.8 * s3), 0.01 * t1}},
          {"tension s1=s2", {Vector3d(t, t, 0.2 * t + 0.8 * s3), 0.01 * t1 + 0.02 * t2}},
          {"tension point", {Vector3d(t, t, t), 0.01 * t1 + 0.02 * t2 + 0.03 * t3}},
          {"tension shear free", {Vector3d(t, 0.5 * (t + s3), s3), 0.001 * t1 + 0.001 * d13}},
          {"tension shear s2=s3", {Vector3d(t, s3, s3), 0.01 * t1 + 0.02 * d13 + 0.01 * d12}},
          {"tension shear s1=s2", {Vector3d(t, t, s3), 0.01 * t1 + 0.02 * t2 + 0.02 * d13}},
          {"tension shear s1=s2", {Vector3d(t, t, s3), 0.01 * t1 + 0.02 * d13 + 0.015 * d23}}};
      for (const auto& [name, where] : cases) {
        SCOPED_TRACE(name);
        const PrincipalStress once = admissible(map, sorted(where[0] + where[1]));
        EXPECT_EQ(region(map, once), name);
        EXPECT_LT((vector(once) - where[0]).norm(), 1e-12 * (where[0] + where[1]).norm());
      }
    }
  }
}

// 1e5 random trials, and no region without its share.
TEST(MohrCoulombReturn, RandomTrialsReachEveryRegion) {
  for (const double cutoff : {none, 4e3}) {
    const MohrCoulombReturn map(parameters(35, 10, 10e3, cutoff));
    std::map<std::string, int> count;
    Trials trials;
    for (int n = 0; n < 100'000; ++n) ++count[region(map, admissible(map, sorted(trials.next())))];
    for (const std::string name : {"elastic", "shear free", "shear s2=s3", "shear s1=s2"}) EXPECT_GT(count[name], 100);
    if (cutoff == none) {
      EXPECT_GT(count["shear point"], 100);
      continue;
    }
    EXPECT_EQ(count["shear point"], 0);
    for (const std::string name : {"free", "s1=s2"}) {
      EXPECT_GT(count["tension " + name], 100);
      EXPECT_GT(count["tension shear " + name], 100);
    }
    EXPECT_GT(count["tension point"], 100);
    EXPECT_GT(count["tension shear s2=s3"], 100);
  }
}

// Plastic strain on the face: volumetric over s1 part is 2 sin(psi) / (1 + sin(psi)) (MC.6). Round-off only.
TEST(MohrCoulombReturn, DilatesByTheFlowRule) {
  for (const double psi : {0.0, 10.0, 30.0}) {
    const MohrCoulombParameters p = parameters(30, psi, 10e3);
    const MohrCoulombReturn map(p);
    const Vector3d trial(10e3, -40e3, -120e3);
    const Vector3d once = vector(admissible(map, sorted(trial)));
    ASSERT_EQ(region(map, sorted(once)), "shear free");
    const Vector3d strain = Polyhedron(p).stiffness.inverse() * (trial - once);
    const double m = std::sin(p.dilation_angle);
    EXPECT_GT(strain[0], 0);
    EXPECT_NEAR(strain.sum() / strain[0], 2 * m / (1 + m), 1e-12);
    EXPECT_NEAR(strain[1] / strain[0], 0, 1e-12);
  }
}

/// The rate equations, stepped explicitly: s' = D (e' - sum of multipliers . flow), the multipliers from consistency of
/// the planes in action; a plane acts while it would be left otherwise and its multiplier is positive.
Vector3d integrate_rates(const Polyhedron& polyhedron, Vector3d s, const Vector3d& elastic_increment, int steps) {
  const Vector3d step = elastic_increment / steps;
  std::vector<int> active;
  for (int n = 0; n < steps; ++n) {
    const Vector3d trial = s + step;
    for (int tries = 0; tries < 20; ++tries) {
      Eigen::VectorXd multipliers;
      s = trial;
      if (!active.empty()) {
        if (!polyhedron.solve(active, trial, multipliers)) active.pop_back();
        if (static_cast<int>(active.size()) != multipliers.size()) continue;
        int least = 0;
        if (multipliers.minCoeff(&least) < 0) {
          active.erase(active.begin() + least);
          continue;
        }
        s = polyhedron.returned(active, trial, multipliers);
      }
      int worst = -1;
      double excess = 1e-9;
      for (int i = 0; i < static_cast<int>(polyhedron.planes.size()); ++i) {
        const double f = polyhedron.planes[i].normal.dot(s) - polyhedron.planes[i].limit;
        if (f > excess) worst = i, excess = f;
      }
      if (worst < 0) break;
      active.push_back(worst);
    }
  }
  return s;
}

// One step against 1e5 small ones from a hydrostatic stress, along strain paths that load one face, then an edge, then
// the cut-off: 1e-6 of the stress. Exact up to round-off where the planes in action only grow in number, as here.
TEST(MohrCoulombReturn, AgreesWithTheIntegratedRates) {
  for (const MohrCoulombParameters& p : {parameters(0, 0, 10e3), parameters(35, 10, 10e3), parameters(35, 35, 0),
                                         parameters(45, 0, 5e3), parameters(35, 10, 10e3, 4e3)}) {
    SCOPED_TRACE(text(p));
    const MohrCoulombReturn map(p);
    const Polyhedron polyhedron(p);
    for (const Vector3d& increment :
         {Vector3d(30e3, -5e3, -80e3), Vector3d(30e3, -60e3, -80e3), Vector3d(30e3, 25e3, -80e3),
          Vector3d(20e3, -100e3, -100e3), Vector3d(60e3, 10e3, -10e3), Vector3d(-10e3, -10e3, -120e3)}) {
      const Vector3d start = Vector3d::Constant(-20e3);
      const Vector3d rates = integrate_rates(polyhedron, start, increment, 100'000);
      const Vector3d once = vector(admissible(map, sorted(start + increment)));
      EXPECT_LT((vector(sorted(rates)) - once).norm(), 1e-6 * once.norm()) << increment.transpose();
    }
  }
}

// Whatever the size of the trial stress, the result lies on the surface to round-off of itself, with no NaN.
TEST(MohrCoulombReturn, HugeTrialsStayFinite) {
  for (const MohrCoulombParameters& p : sweep()) {
    SCOPED_TRACE(text(p));
    const MohrCoulombReturn map(p);
    for (const double size : {1e9, 1e15, 1e30, 1e100}) {
      for (const Vector3d& direction : {Vector3d(1, 0, -1), Vector3d(1, 1, 1), Vector3d(-1, -1, -1), Vector3d(1, 1, -1),
                                        Vector3d(0, -1, -1), Vector3d(1, 0, 0)}) {
        const PrincipalStress s = admissible(map, sorted(size * direction));
        ASSERT_TRUE(std::isfinite(s.s1) && std::isfinite(s.s2) && std::isfinite(s.s3)) << size;
        const double own = std::abs(s.s1) + std::abs(s.s3) + map.strength;
        ASSERT_LE(Polyhedron(p).worst(vector(s)), 1e-14 * own) << size << " " << direction.transpose();
      }
    }
  }
}

}  // namespace
}  // namespace sluice
