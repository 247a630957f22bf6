#include <fmt/format.h>

#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <limits>

#include "physics/initial_stress/grid_unknowns.h"
#include "physics/initial_stress/initial_stress.h"
#include "solvers/sparse_cholesky.h"

namespace sluice {

namespace {

/// A little of the lumped mass matrix is added to the stiffness, so that nodes which too few particles reach do not
/// make it singular: 1e-8 of c^2 / h^2 for the slowest wave. A motion without strain costs no stress, however large it
/// is.
constexpr double regularization = 1e-8;

template <int Dim>
class Assembly {
 public:
  Assembly(const Scene<Dim>& scene, const Materials<Dim>& materials, const SkeletonLoads<Dim>& loads,
           Unknowns<Dim>& unknowns)
      : scene_(scene), materials_(materials), loads_(loads), unknowns_(unknowns) {
    const double slowest = slowest_wave_squared();
    mass_factor_ = regularization * slowest / (scene.grid.smallest_cell() * scene.grid.smallest_cell());
  }

  void add_cell(const std::vector<std::uint32_t>& order, std::size_t begin, std::size_t end) {
    const Particles& ps = scene_.particles;
    Eigen::MatrixXd stiffness;
    Eigen::VectorXd force;
    Stencil<Dim> s;
    for (std::size_t k = begin; k < end; ++k) {
      const std::uint32_t p = order[k];
      const Stencil<Dim> own = stencil_at(scene_, p);
      if (k == begin || !same_nodes(own, s)) {
        if (k != begin) add_dense(s, stiffness, force);
        stiffness.setZero(own.count * Dim, own.count * Dim);
        force.setZero(own.count * Dim);
      }
      s = own;
      const auto elasticity = materials_[static_cast<std::size_t>(ps.material[p])].elasticity();
      add_particle(s, elasticity, ps.columns.data(ps.volume)[p], ps.columns.data(ps.mass)[p], stiffness, force);
      add_loads(s, p, force);
    }
    add_dense(s, stiffness, force);
  }

  Eigen::SparseMatrix<double> matrix() const {
    Eigen::SparseMatrix<double> k(unknowns_.count(), unknowns_.count());
    k.setFromTriplets(entries_.begin(), entries_.end());
    return k;
  }
  Eigen::VectorXd force() const {
    Eigen::VectorXd f = Eigen::VectorXd::Zero(unknowns_.count());
    for (const auto& [row, value] : forces_) f[row] += value;
    return f;
  }

 private:
  /// Particles of a cell share their nodes, unless shape functions move with them.
  static bool same_nodes(const Stencil<Dim>& a, const Stencil<Dim>& b) {
    return a.count == b.count && std::equal(a.node.begin(), a.node.begin() + a.count, b.node.begin());
  }

  void add_dense(const Stencil<Dim>& s, const Eigen::MatrixXd& stiffness, const Eigen::VectorXd& force) {
    std::vector<int> number(static_cast<std::size_t>(s.count) * Dim);
    for (int i = 0; i < s.count; ++i) {
      const auto own = unknowns_.of(s.node[static_cast<std::size_t>(i)]);
      for (int a = 0; a < Dim; ++a) number[static_cast<std::size_t>(i * Dim + a)] = own[static_cast<std::size_t>(a)];
    }
    for (int r = 0; r < s.count * Dim; ++r) {
      const int row = number[static_cast<std::size_t>(r)];
      if (row < 0) continue;
      forces_.emplace_back(row, force[r]);
      for (int c = 0; c < s.count * Dim; ++c) {
        const int column = number[static_cast<std::size_t>(c)];
        if (column >= 0 && column <= row) entries_.emplace_back(row, column, stiffness(r, c));
      }
    }
  }

  /// K_ab += V (lambda g_a g_b^T + G g_b g_a^T + G (g_a . g_b) I),  f_a += m N_a g.
  void add_particle(const Stencil<Dim>& s, const IsotropicElasticity& e, double volume, double mass,
                    Eigen::MatrixXd& stiffness, Eigen::VectorXd& force) const {
    for (int i = 0; i < s.count; ++i) {
      const auto a = static_cast<std::size_t>(i);
      for (int d = 0; d < Dim; ++d) force[i * Dim + d] += mass * s.value[a] * scene_.gravity[d];
      for (int j = 0; j < s.count; ++j) {
        const auto b = static_cast<std::size_t>(j);
        double dot = 0;
        for (int d = 0; d < Dim; ++d) dot += s.gradient[a][d] * s.gradient[b][d];
        for (int r = 0; r < Dim; ++r)
          for (int c = 0; c < Dim; ++c)
            stiffness(i * Dim + r, j * Dim + c) += volume * (e.lambda * s.gradient[a][r] * s.gradient[b][c] +
                                                             e.shear * s.gradient[a][c] * s.gradient[b][r]);
        const double diagonal = volume * e.shear * dot + (i == j ? mass_factor_ * mass * s.value[a] : 0);
        for (int d = 0; d < Dim; ++d) stiffness(i * Dim + d, j * Dim + d) += diagonal;
      }
    }
  }

  /// f_a += V p grad N_a + N_a b: pressure and body force on the skeleton.
  void add_loads(const Stencil<Dim>& s, std::size_t p, Eigen::VectorXd& force) const {
    const double push =
        loads_.pressure == nullptr ? 0 : scene_.particles.columns.data(scene_.particles.volume)[p] * loads_.pressure[p];
    for (int i = 0; i < s.count; ++i)
      for (int d = 0; d < Dim; ++d) {
        const auto a = static_cast<std::size_t>(i);
        force[i * Dim + d] += push * s.gradient[a][d];
        if (loads_.body_force[d] != nullptr) force[i * Dim + d] += s.value[a] * loads_.body_force[d][p];
      }
  }

  /// Liquids do not count.
  double slowest_wave_squared() const {
    double slowest = std::numeric_limits<double>::infinity();
    for (std::size_t m = 0; m < materials_.size(); ++m)
      if (!materials_[m].liquid())
        slowest = std::min(slowest, materials_[m].elasticity().constrained_modulus() / materials_[m].density());
    return std::isfinite(slowest) ? slowest : 1;
  }

  const Scene<Dim>& scene_;
  const Materials<Dim>& materials_;
  const SkeletonLoads<Dim>& loads_;
  Unknowns<Dim>& unknowns_;
  double mass_factor_;
  std::vector<Eigen::Triplet<double>> entries_;
  std::vector<std::pair<int, double>> forces_;
};

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
void elastic_equilibrium(Scene<Dim>& scene, const Materials<Dim>& materials, const SkeletonLoads<Dim>& loads) {
  Unknowns<Dim> unknowns(scene);
  Assembly<Dim> assembly(scene, materials, loads, unknowns);
  std::vector<std::int64_t> cell;
  const std::vector<std::uint32_t> order = by_cell(scene, cell);
  for (std::size_t begin = 0; begin < order.size();) {
    std::size_t end = begin;
    while (end < order.size() && cell[order[end]] == cell[order[begin]]) ++end;
    assembly.add_cell(order, begin, end);
    begin = end;
  }

  SparseCholesky cholesky;
  cholesky.factorize(assembly.matrix());
  const Eigen::VectorXd solution = cholesky.solve(assembly.force());

  std::vector<double> displacement;
  double extent = 0;
  for (const std::uint32_t p : order) {
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
        fmt::format("initial_stress: elastic_equilibrium does not exist: nothing holds the bodies (they would move by "
                    "{:.3g} m); fix a face of the grid that they touch, normal to gravity at least",
                    *median));
}

template void elastic_equilibrium<2>(Scene<2>&, const Materials<2>&, const SkeletonLoads<2>&);
template void elastic_equilibrium<3>(Scene<3>&, const Materials<3>&, const SkeletonLoads<3>&);

}  // namespace sluice
