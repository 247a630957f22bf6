#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "physics/initial_stress/elastic_equilibrium.h"
#include "physics/initial_stress/initial_stress.h"
#include "physics/statics/elastic_operator.h"
#include "solvers/sparse_cholesky.h"

namespace sluice {

namespace {

/// sigma = lambda tr(eps) 1 + 2 G eps at one particle; returns its displacement.
template <int Dim>
double set_stress(Scene<Dim>& scene, const IsotropicElasticity& e, const Eigen::VectorXd& solution,
                  Unknowns<Dim>& unknowns, std::size_t p) {
  const Stencil<Dim> s = stencil_at(scene, p);
  Eigen::Matrix<double, Dim, Dim> gradient = Eigen::Matrix<double, Dim, Dim>::Zero();
  Eigen::Matrix<double, Dim, 1> displacement = Eigen::Matrix<double, Dim, 1>::Zero();
  for (int i = 0; i < s.count; ++i) {
    const auto n = static_cast<std::size_t>(i);
    const auto own = unknowns.of(s.node[n]);
    for (int a = 0; a < Dim; ++a) {
      if (own[static_cast<std::size_t>(a)] < 0) continue;
      const double u = solution[own[static_cast<std::size_t>(a)]];
      displacement[a] += s.value[n] * u;
      for (int b = 0; b < Dim; ++b) gradient(a, b) += u * s.gradient[n][b];
    }
  }
  Columns& columns = scene.particles.columns;
  const double pressure = e.lambda * gradient.trace();
  const auto set = [&](int c, double value) { columns.data(scene.particles.stress, c)[p] = value; };
  for (int a = 0; a < 3; ++a) set(a, pressure + (a < Dim ? 2 * e.shear * gradient(a, a) : 0));
  set(3, e.shear * (gradient(0, 1) + gradient(1, 0)));
  if constexpr (Dim == 3) {
    set(4, e.shear * (gradient(1, 2) + gradient(2, 1)));
    set(5, e.shear * (gradient(0, 2) + gradient(2, 0)));
  }
  return displacement.norm();
}

}  // namespace

template <int Dim>
void set_elastic_stress(Scene<Dim>& scene, const Materials<Dim>& materials, Unknowns<Dim>& unknowns,
                        const Eigen::VectorXd& solution) {
  std::vector<double> displacement;
  double extent = 0;
  for (std::size_t p = 0; p < scene.particles.size(); ++p) {
    // Liquids press with their weight on what lies below; they hold no stress.
    const Material& material = materials[static_cast<std::size_t>(scene.particles.material[p])];
    if (!material.liquid()) displacement.push_back(set_stress(scene, material.elasticity(), solution, unknowns, p));
  }
  if (displacement.empty()) return;
  for (int a = 0; a < Dim; ++a) extent = std::max(extent, scene.grid.max[a] - scene.grid.min[a]);
  // The median: a few particles at a thin toe may hang on nodes that nothing else holds.
  const auto median = displacement.begin() + static_cast<std::ptrdiff_t>(displacement.size() / 2);
  std::nth_element(displacement.begin(), median, displacement.end());
  if (!(*median < 10 * extent))
    throw CaseError(
        fmt::format("initial_stress: there is no equilibrium: nothing holds the bodies (they would move by "
                    "{:.3g} m); fix a face of the grid that they touch, normal to gravity at least",
                    *median));
}

template <int Dim>
void elastic_equilibrium(Scene<Dim>& scene, const Materials<Dim>& materials, const SkeletonLoads<Dim>& loads) {
  Unknowns<Dim> unknowns(scene);
  const ElasticOperator<Dim> elastic(scene, materials, loads, unknowns);
  SparseCholesky cholesky;
  cholesky.factorize(elastic.matrix());
  set_elastic_stress(scene, materials, unknowns, cholesky.solve(elastic.force()));
}

template void set_elastic_stress<2>(Scene<2>&, const Materials<2>&, Unknowns<2>&, const Eigen::VectorXd&);
template void set_elastic_stress<3>(Scene<3>&, const Materials<3>&, Unknowns<3>&, const Eigen::VectorXd&);

template void elastic_equilibrium<2>(Scene<2>&, const Materials<2>&, const SkeletonLoads<2>&);
template void elastic_equilibrium<3>(Scene<3>&, const Materials<3>&, const SkeletonLoads<3>&);

}  // namespace sluice
