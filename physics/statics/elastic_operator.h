/// ElasticOperator: the linear-elastic stiffness of the particles on the grid, and the forces from outside on its
/// unknowns. docs/theory.md, eq. (30).
#pragma once

#include <Eigen/SparseCore>
#include <functional>
#include <vector>

#include "physics/materials/materials.h"
#include "physics/statics/grid_unknowns.h"
#include "physics/statics/skeleton_loads.h"

namespace sluice {

/// What volume changes stress comes from: those at the particles, or with F-bar their means over cells, eq. (26).
enum class Dilation { at_points, of_cells };

template <int Dim>
class ElasticOperator {
 public:
  /// Of a particle.
  using Elasticity = std::function<IsotropicElasticity(std::size_t)>;

  /// Assembles all, and gives numbers to the unknowns. `loads` act beside gravity.
  ElasticOperator(const Scene<Dim>& scene, const Materials<Dim>& materials, const SkeletonLoads<Dim>& loads,
                  Unknowns<Dim>& unknowns, const Elasticity& elasticity, Dilation dilation = Dilation::at_points);
  /// With the elasticity of the materials.
  ElasticOperator(const Scene<Dim>& scene, const Materials<Dim>& materials, const SkeletonLoads<Dim>& loads,
                  Unknowns<Dim>& unknowns, Dilation dilation = Dilation::at_points);

  /// The lower triangle, weak springs included [N/m]; `inertia` is a multiple of the lumped mass that is added [1/s2].
  Eigen::SparseMatrix<double> matrix(double inertia = 0) const;
  /// Of gravity and loads [N], and of gravity alone.
  const Eigen::VectorXd& force() const { return force_; }
  const Eigen::VectorXd& weight() const { return weight_; }
  /// The weak springs of the unknowns, which are in the diagonal [N/m].
  const Eigen::VectorXd& spring() const { return spring_; }
  /// The lumped mass of the unknowns [kg].
  const Eigen::VectorXd& mass() const { return mass_; }

 private:
  void add_cell(const std::vector<std::uint32_t>& order, std::size_t begin, std::size_t end,
                const Elasticity& elasticity);
  void average_dilation(const Elasticity& elasticity);
  void add_dense(const Stencil<Dim>& s, const Eigen::MatrixXd& stiffness, const Eigen::MatrixXd& nodal);

  const Scene<Dim>& scene_;
  const SkeletonLoads<Dim>& loads_;
  Unknowns<Dim>& unknowns_;
  Dilation dilation_;
  std::vector<Eigen::Triplet<double>> entries_;
  Eigen::SparseMatrix<double> cell_dilation_;  // of F-bar: its product with its transpose is stiffness [sqrt(N/m)]
  std::vector<Eigen::Triplet<double>> nodal_entries_;  // (unknown, 0: weight, 1: loads, 2: mass)
  Eigen::VectorXd force_, weight_, spring_, mass_;
};

extern template class ElasticOperator<2>;
extern template class ElasticOperator<3>;

}  // namespace sluice
