#include "physics/statics/elastic_operator.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace sluice {

namespace {

/// A little of the lumped mass matrix is added to the stiffness, so that nodes which too few particles reach do not
/// make it singular: 1e-8 of c^2 / h^2 for the slowest wave, with c^2 = 2 G / rho: how little the material can be
/// compressed says nothing of how stiff it is against bending. A motion without strain costs no stress, however large
/// it is.
constexpr double regularization = 1e-8;

/// Liquids do not count.
template <int Dim>
double slowest_wave_squared(const Materials<Dim>& materials) {
  double slowest = std::numeric_limits<double>::infinity();
  for (std::size_t m = 0; m < materials.size(); ++m)
    if (!materials[m].liquid())
      slowest = std::min(slowest, 2 * materials[m].elasticity().shear / materials[m].density());
  return std::isfinite(slowest) ? slowest : 1;
}

/// K_ab += V (lambda g_a g_b^T + G g_b g_a^T + G (g_a . g_b) I).
template <int Dim>
void add_stiffness(const Stencil<Dim>& s, const IsotropicElasticity& e, double volume, Eigen::MatrixXd& stiffness) {
  for (int i = 0; i < s.count; ++i) {
    const auto a = static_cast<std::size_t>(i);
    for (int j = 0; j < s.count; ++j) {
      const auto b = static_cast<std::size_t>(j);
      double dot = 0;
      for (int d = 0; d < Dim; ++d) dot += s.gradient[a][d] * s.gradient[b][d];
      for (int r = 0; r < Dim; ++r)
        for (int c = 0; c < Dim; ++c)
          stiffness(i * Dim + r, j * Dim + c) +=
              volume * (e.lambda * s.gradient[a][r] * s.gradient[b][c] + e.shear * s.gradient[a][c] * s.gradient[b][r]);
      for (int d = 0; d < Dim; ++d) stiffness(i * Dim + d, j * Dim + d) += volume * e.shear * dot;
    }
  }
}

/// Columns: m N_a g; V p grad N_a + N_a b, with pressure and body force on the skeleton, and around obstacles with
/// -V grad(N_a q) for the pressure q that stands at them; m N_a.
template <int Dim>
void add_nodal(const Scene<Dim>& scene, const SkeletonLoads<Dim>& loads, const Stencil<Dim>& s, std::size_t p,
               Eigen::MatrixXd& nodal) {
  const Columns& columns = scene.particles.columns;
  const double mass = columns.data(scene.particles.mass)[p];
  const double volume = columns.data(scene.particles.volume)[p];
  const double push = loads.pressure == nullptr ? 0 : volume * loads.pressure[p];
  for (int i = 0; i < s.count; ++i)
    for (int d = 0; d < Dim; ++d) {
      const auto a = static_cast<std::size_t>(i);
      nodal(i * Dim + d, 0) += mass * s.value[a] * scene.gravity[d];
      nodal(i * Dim + d, 1) += push * s.gradient[a][d];
      if (loads.body_force[d] != nullptr) nodal(i * Dim + d, 1) += s.value[a] * loads.body_force[d][p];
      if (loads.on_obstacles != nullptr && scene.obstacles.surround(s.node[a], d))
        nodal(i * Dim + d, 1) -= volume * (s.value[a] * loads.slope[d][p] + s.gradient[a][d] * loads.on_obstacles[p]);
      nodal(i * Dim + d, 2) += mass * s.value[a];
    }
}

/// Particles of a cell share their nodes, unless shape functions move with them.
template <int Dim>
bool same_nodes(const Stencil<Dim>& a, const Stencil<Dim>& b) {
  return a.count == b.count && std::equal(a.node.begin(), a.node.begin() + a.count, b.node.begin());
}

}  // namespace

template <int Dim>
ElasticOperator<Dim>::ElasticOperator(const Scene<Dim>& scene, const Materials<Dim>& materials,
                                      const SkeletonLoads<Dim>& loads, Unknowns<Dim>& unknowns, Dilation dilation)
    : ElasticOperator(
          scene, materials, loads, unknowns,
          [&](std::size_t p) { return materials[static_cast<std::size_t>(scene.particles.material[p])].elasticity(); },
          dilation) {}

template <int Dim>
ElasticOperator<Dim>::ElasticOperator(const Scene<Dim>& scene, const Materials<Dim>& materials,
                                      const SkeletonLoads<Dim>& loads, Unknowns<Dim>& unknowns,
                                      const Elasticity& elasticity, Dilation dilation)
    : scene_(scene), loads_(loads), unknowns_(unknowns), dilation_(dilation) {
  std::vector<std::int64_t> cell;
  const std::vector<std::uint32_t> order = by_cell(scene, cell);
  for (std::size_t begin = 0; begin < order.size();) {
    std::size_t end = begin;
    while (end < order.size() && cell[order[end]] == cell[order[begin]]) ++end;
    add_cell(order, begin, end, elasticity);
    begin = end;
  }
  if (dilation == Dilation::of_cells) average_dilation(elasticity);
  Eigen::MatrixXd nodal = Eigen::MatrixXd::Zero(unknowns.count(), 3);
  for (const auto& entry : nodal_entries_) nodal(entry.row(), entry.col()) += entry.value();
  weight_ = nodal.col(0);
  force_ = weight_ + nodal.col(1);
  mass_ = nodal.col(2);
  spring_ = regularization * slowest_wave_squared(materials) /
            (scene.grid.smallest_cell() * scene.grid.smallest_cell()) * mass_;
}

template <int Dim>
void ElasticOperator<Dim>::add_cell(const std::vector<std::uint32_t>& order, std::size_t begin, std::size_t end,
                                    const Elasticity& elasticity) {
  Eigen::MatrixXd stiffness, nodal;
  Stencil<Dim> s;
  for (std::size_t k = begin; k < end; ++k) {
    const std::uint32_t p = order[k];
    const Stencil<Dim> own = stencil_at(scene_, p);
    if (k == begin || !same_nodes(own, s)) {
      if (k != begin) add_dense(s, stiffness, nodal);
      stiffness.setZero(own.count * Dim, own.count * Dim);
      nodal.setZero(own.count * Dim, 3);
    }
    s = own;
    IsotropicElasticity own_elasticity = elasticity(p);
    if (dilation_ == Dilation::of_cells) own_elasticity.lambda = -2 * own_elasticity.shear / Dim;  // none by itself
    add_stiffness(s, own_elasticity, scene_.particles.columns.data(scene_.particles.volume)[p], stiffness);
    add_nodal(scene_, loads_, s, p, nodal);
  }
  add_dense(s, stiffness, nodal);
}

/// With sigma = k theta I + 2 G dev(eps), k = lambda + 2 G / Dim, and theta the mean over a cell, the stiffness of
/// volume changes is k b b^T / V, where b = sum V_p grad N over the cell, V its volume and k its mean.
template <int Dim>
void ElasticOperator<Dim>::average_dilation(const Elasticity& elasticity) {
  struct Cell {
    int number;
    double volume = 0, modulus = 0;  // V and V k
  };
  std::map<Index<Dim>, Cell> cells;
  std::vector<Eigen::Triplet<double>> entries;
  const double shift = scene_.shape->node_shift();
  const Particles& ps = scene_.particles;
  for (std::size_t p = 0; p < ps.size(); ++p) {
    Index<Dim> place;
    for (int a = 0; a < Dim; ++a) {
      const double x = ps.columns.data(ps.position, a)[p] - scene_.grid.min[a];
      place[a] = static_cast<int>(std::floor(x / scene_.grid.cell[a] - shift));
    }
    Cell& cell = cells.try_emplace(scene_.grid.wrapped(place), Cell{static_cast<int>(cells.size())}).first->second;
    const IsotropicElasticity e = elasticity(p);
    const double volume = ps.columns.data(ps.volume)[p];
    cell.volume += volume;
    cell.modulus += volume * (e.lambda + 2 * e.shear / Dim);
    const Stencil<Dim> s = stencil_at(scene_, p);
    for (std::size_t i = 0; i < static_cast<std::size_t>(s.count); ++i) {
      const auto own = unknowns_.of(s.node[i]);
      for (std::size_t a = 0; a < Dim; ++a)
        if (own[a] >= 0) entries.emplace_back(own[a], cell.number, volume * s.gradient[i][a]);
    }
  }
  Eigen::VectorXd root(static_cast<Eigen::Index>(cells.size()));
  for (const auto& [place, cell] : cells) root[cell.number] = std::sqrt(cell.modulus) / cell.volume;
  cell_dilation_.resize(unknowns_.count(), static_cast<Eigen::Index>(cells.size()));
  cell_dilation_.setFromTriplets(entries.begin(), entries.end());
  cell_dilation_ = cell_dilation_ * root.asDiagonal();
}

template <int Dim>
void ElasticOperator<Dim>::add_dense(const Stencil<Dim>& s, const Eigen::MatrixXd& stiffness,
                                     const Eigen::MatrixXd& nodal) {
  std::vector<int> number(static_cast<std::size_t>(s.count) * Dim);
  for (int i = 0; i < s.count; ++i) {
    const auto own = unknowns_.of(s.node[static_cast<std::size_t>(i)]);
    for (int a = 0; a < Dim; ++a) number[static_cast<std::size_t>(i * Dim + a)] = own[static_cast<std::size_t>(a)];
  }
  for (int r = 0; r < s.count * Dim; ++r) {
    const int row = number[static_cast<std::size_t>(r)];
    if (row < 0) continue;
    for (int c = 0; c < 3; ++c) nodal_entries_.emplace_back(row, c, nodal(r, c));
    for (int c = 0; c < s.count * Dim; ++c) {
      const int column = number[static_cast<std::size_t>(c)];
      if (column >= 0 && column <= row) entries_.emplace_back(row, column, stiffness(r, c));
    }
  }
}

template <int Dim>
Eigen::SparseMatrix<double> ElasticOperator<Dim>::matrix(double inertia) const {
  Eigen::SparseMatrix<double> k(unknowns_.count(), unknowns_.count());
  k.setFromTriplets(entries_.begin(), entries_.end());
  if (dilation_ == Dilation::of_cells)
    k += Eigen::SparseMatrix<double>(cell_dilation_ * cell_dilation_.transpose()).triangularView<Eigen::Lower>();
  for (int i = 0; i < unknowns_.count(); ++i) k.coeffRef(i, i) += spring_[i] + inertia * mass_[i];
  return k;
}

template class ElasticOperator<2>;
template class ElasticOperator<3>;

}  // namespace sluice
