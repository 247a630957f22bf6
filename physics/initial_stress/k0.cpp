#include <fmt/format.h>

#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "physics/initial_stress/initial_stress.h"
#include "physics/statics/grid_unknowns.h"
#include "solvers/sparse_cholesky.h"

namespace sluice {

namespace {

// ---- the weight of what lies above ----

/// What a particle stands for: a slab of its spacing.
struct Slab {
  double bottom, top;
  double weight;     ///< on the area of its base [Pa]
  double above = 0;  ///< weight of all slabs above it in the column [Pa]
};

/// The slabs of one lattice over one place, from the top down.
class Column {
 public:
  void add(const Slab& slab) { slabs_.push_back(slab); }

  void close() {
    std::ranges::stable_sort(slabs_, [](const Slab& a, const Slab& b) { return a.top > b.top; });
    double sum = 0;
    for (Slab& slab : slabs_) {
      slab.above = sum;
      sum += slab.weight;
    }
  }

  /// Weight above z [Pa].
  double above(double z) const {
    const auto first = std::ranges::partition_point(slabs_, [z](const Slab& slab) { return slab.bottom >= z; });
    if (first == slabs_.end()) return slabs_.back().above + slabs_.back().weight;
    return first->above + first->weight * std::clamp((first->top - z) / (first->top - first->bottom), 0.0, 1.0);
  }
  const Slab& uppermost() const { return slabs_.front(); }

 private:
  std::vector<Slab> slabs_;
};

/// The particles as columns of slabs. Bodies with other numbers of particles a cell have lattices of their own.
template <int Dim>
class Overburden {
 public:
  Overburden(const Scene<Dim>& scene, const SkeletonLoads<Dim>& loads) : grid_(scene.grid) {
    const Particles& ps = scene.particles;
    const double* const lift = loads.body_force[Dim - 1];
    for (std::size_t p = 0; p < ps.size(); ++p) {
      const double volume = ps.columns.data(ps.volume)[p], z = ps.columns.data(ps.position, Dim - 1)[p];
      const int per_axis =
          std::max(1, static_cast<int>(std::lround(std::pow(grid_.cell_volume() / volume, 1.0 / Dim))));
      const double thickness = grid_.cell[Dim - 1] / per_axis;
      const double force = -ps.columns.data(ps.mass)[p] * scene.gravity[Dim - 1] - (lift == nullptr ? 0 : lift[p]);
      Vector<Dim> x;
      for (int a = 0; a < Dim; ++a) x[a] = ps.columns.data(ps.position, a)[p];
      lattices_[per_axis][place(x, per_axis)].add(
          {z - 0.5 * thickness, z + 0.5 * thickness, force * thickness / volume});
    }
    for (auto& [per_axis, columns] : lattices_)
      for (auto& [number, column] : columns) column.close();
  }

  /// Weight above x, to the top of the bodies [Pa].
  double above(const Vector<Dim>& x, double z) const {
    double sum = 0;
    for_columns(x, [&](const Column& column) { sum += column.above(z); });
    return sum;
  }

  /// The same to a surface at this height: what is above it does not count, and a gap below it is filled with the
  /// uppermost material.
  double above(const Vector<Dim>& x, double z, double surface) const {
    Slab uppermost{0, -std::numeric_limits<double>::infinity(), 0};
    for_columns(x, [&](const Column& column) {
      if (column.uppermost().top > uppermost.top) uppermost = column.uppermost();
    });
    const double gap = std::max(0.0, surface - uppermost.top);
    const double filling = gap * uppermost.weight / (uppermost.top - uppermost.bottom);
    return std::max(0.0, above(x, z) - above(x, surface) + filling);
  }

 private:
  std::int64_t place(const Vector<Dim>& x, int per_axis) const {
    std::int64_t number = 0;
    for (int a = Dim - 2; a >= 0; --a) {
      const std::int64_t most = std::int64_t{grid_.cells[a]} * per_axis;
      const auto i = static_cast<std::int64_t>(std::floor((x[a] - grid_.min[a]) / grid_.cell[a] * per_axis));
      number = number * most + std::clamp<std::int64_t>(i, 0, most - 1);
    }
    return number;
  }

  template <class Visit>
  void for_columns(const Vector<Dim>& x, const Visit& visit) const {
    for (const auto& [per_axis, columns] : lattices_)
      if (const auto found = columns.find(place(x, per_axis)); found != columns.end()) visit(found->second);
  }

  const GridGeometry<Dim>& grid_;
  std::map<int, std::unordered_map<std::int64_t, Column>> lattices_;  // by particles per axis of a cell
};

double height_of(const std::vector<std::array<double, 2>>& surface, double x) {
  const auto after = std::ranges::find_if(surface, [x](const auto& point) { return point[0] > x; });
  if (after == surface.begin()) return surface.front()[1];
  if (after == surface.end()) return surface.back()[1];
  const auto& [x0, z0] = *(after - 1);
  const auto& [x1, z1] = *after;
  return z0 + (z1 - z0) * (x - x0) / (x1 - x0);
}

// ---- the balance on the grid ----

/// Vertical forces of the particles on the nodes, and the stress that brings them into balance: eqs. (32b) and (32c).
template <int Dim>
class VerticalBalance {
 public:
  explicit VerticalBalance(const Scene<Dim>& scene) : scene_(scene), unknowns_(scene, Dim - 1) {
    std::vector<std::int64_t> cell;
    order_ = by_cell(scene, cell);
    std::vector<Eigen::Triplet<double>> entries;
    const double h = scene.grid.cell[Dim - 1];
    for (const std::uint32_t p : order_) {
      const Stencil<Dim> s = stencil_at(scene, p);
      const double volume = volume_of(p);
      for (int i = 0; i < s.count; ++i) {
        const int row = number(s, i);
        if (row < 0) continue;
        entries.emplace_back(row, row, spring * volume * s.value[static_cast<std::size_t>(i)] / (h * h));
        for (int j = 0; j < s.count; ++j)
          if (const int column = number(s, j); column >= 0 && column <= row)
            entries.emplace_back(row, column, volume * slope(s, i) * slope(s, j));
      }
    }
    Eigen::SparseMatrix<double> matrix(unknowns_.count(), unknowns_.count());
    matrix.setFromTriplets(entries.begin(), entries.end());
    cholesky_.factorize(matrix);
  }

  /// What must be added to `stress`, by particle, for it to carry its weight. The spring makes one pass miss by a
  /// share of about 1e-8 of what it adds, and the next that share of the rest.
  std::vector<double> correction(const std::vector<double>& stress, const double* lift) {
    constexpr int passes = 3;
    std::vector<double> added(stress.size(), 0.0);
    for (int pass = 0; pass < passes; ++pass) {
      const Eigen::VectorXd w = cholesky_.solve(residual(stress, added, lift));
      largest_ = std::max(largest_, w.size() == 0 ? 0 : median_magnitude(w));
      for (const std::uint32_t p : order_) {
        const Stencil<Dim> s = stencil_at(scene_, p);
        for (int i = 0; i < s.count; ++i)
          if (const int row = number(s, i); row >= 0) added[p] += w[row] * slope(s, i);
      }
    }
    return added;
  }

  /// Of the potential whose slope the correction is [Pa m]: large if nothing holds the bodies.
  double median_potential() const { return largest_; }

 private:
  /// A weak spring at every particle, as in elastic_equilibrium, for nodes that too few particles reach.
  static constexpr double spring = 1e-8;

  Eigen::VectorXd residual(const std::vector<double>& stress, const std::vector<double>& added, const double* lift) {
    Eigen::VectorXd force = Eigen::VectorXd::Zero(unknowns_.count());
    for (const std::uint32_t p : order_) {
      const Stencil<Dim> s = stencil_at(scene_, p);
      const double mass = scene_.particles.columns.data(scene_.particles.mass)[p];
      const double weight = mass * scene_.gravity[Dim - 1] + (lift == nullptr ? 0 : lift[p]);
      const double push = volume_of(p) * (stress[p] + added[p]);
      for (int i = 0; i < s.count; ++i)
        if (const int row = number(s, i); row >= 0)
          force[row] += weight * s.value[static_cast<std::size_t>(i)] - push * slope(s, i);
    }
    return force;
  }

  static double median_magnitude(const Eigen::VectorXd& w) {
    std::vector<double> sorted(w.data(), w.data() + w.size());
    for (double& value : sorted) value = std::abs(value);
    const auto median = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), median, sorted.end());
    return *median;
  }

  int number(const Stencil<Dim>& s, int i) { return unknowns_.of(s.node[static_cast<std::size_t>(i)])[Dim - 1]; }
  static double slope(const Stencil<Dim>& s, int i) { return s.gradient[static_cast<std::size_t>(i)][Dim - 1]; }
  double volume_of(std::size_t p) const { return scene_.particles.columns.data(scene_.particles.volume)[p]; }

  const Scene<Dim>& scene_;
  Unknowns<Dim> unknowns_;
  std::vector<std::uint32_t> order_;
  SparseCholesky cholesky_;
  double largest_ = 0;
};

// ---- K0 ----

/// By number of the material; nothing for liquids.
template <int Dim>
std::vector<double> k0_of_materials(const InitialStress& initial, const Scene<Dim>& scene,
                                    const Materials<Dim>& materials) {
  const Node sections = materials.resolved();
  std::vector<std::string> names;
  for (const auto& [name, place] : sections.keys) names.push_back(name);
  for (const auto& [name, place] : initial.k0_places)
    if (std::ranges::find(names, name) == names.end())
      throw CaseError(place, fmt::format("k0: unknown material '{}'; {}", name, allowed_words(name, names)));

  std::vector<bool> used(names.size(), false);
  for (const std::int32_t m : scene.particles.material) used[static_cast<std::size_t>(m)] = true;
  std::vector<double> k0(names.size(), 0.0);
  for (std::size_t m = 0; m < names.size(); ++m) {
    if (materials[m].liquid() || !used[m]) continue;
    const auto given = initial.k0_of.find(names[m]);
    const Node* const friction = sections.items[m].find("friction_angle");
    if (initial.k0 || given != initial.k0_of.end()) {
      k0[m] = initial.k0 ? *initial.k0 : given->second;
    } else if (friction != nullptr) {
      Problems problems;
      k0[m] = 1 - std::sin(value::quantity(*friction, "friction_angle", unit::angle, any_number, problems).value_or(0));
    } else {
      throw CaseError(initial.place,
                      fmt::format("initial_stress: there is no k0 for '{0}', which has no friction_angle "
                                  "to take 1 - sin(friction_angle) from; give k0: {{{0}: 0.5}}",
                                  names[m]));
    }
  }
  return k0;
}

template <int Dim>
void require_vertical_gravity(const InitialStress& initial, const Scene<Dim>& scene) {
  if (scene.grid.periodic[Dim - 1])
    throw CaseError(initial.place,
                    "initial_stress: `method: k0` needs a top and a bottom, but these faces are periodic");
  bool vertical = scene.gravity[Dim - 1] < 0;
  for (int a = 0; a < Dim - 1; ++a) vertical = vertical && scene.gravity[a] == 0;
  if (!vertical)
    throw CaseError(initial.place,
                    "initial_stress: `method: k0` needs gravity that points down the last axis, for "
                    "example gravity: [0, -9.81 m/s2]");
}

}  // namespace

template <int Dim>
void k0_stress(const InitialStress& initial, Scene<Dim>& scene, const Materials<Dim>& materials,
               const SkeletonLoads<Dim>& loads) {
  require_vertical_gravity(initial, scene);
  const std::vector<double> k0 = k0_of_materials(initial, scene, materials);
  Particles& ps = scene.particles;
  const Overburden<Dim> overburden(scene, loads);
  std::vector<double> own(ps.size()), vertical(ps.size());
  double largest = 0;
  for (std::size_t p = 0; p < ps.size(); ++p) {
    Vector<Dim> x;
    for (int a = 0; a < Dim; ++a) x[a] = ps.columns.data(ps.position, a)[p];
    own[p] = -overburden.above(x, x[Dim - 1]);
    vertical[p] = initial.surface.empty() ? own[p] : -overburden.above(x, x[Dim - 1], height_of(initial.surface, x[0]));
    largest = std::max(largest, std::abs(own[p]));
  }

  VerticalBalance<Dim> balance(scene);
  const std::vector<double> correction = balance.correction(own, loads.body_force[Dim - 1]);
  const double extent = scene.grid.max[Dim - 1] - scene.grid.min[Dim - 1];
  if (!(balance.median_potential() <= 10 * largest * extent))
    throw CaseError(initial.place,
                    "initial_stress: nothing holds the bodies against gravity; fix the face of the grid "
                    "that they stand on, normal to gravity at least");

  for (std::size_t p = 0; p < ps.size(); ++p) {
    const auto m = static_cast<std::size_t>(ps.material[p]);
    if (materials[m].liquid()) continue;
    const double push = loads.pressure == nullptr ? 0 : loads.pressure[p];
    const double effective = vertical[p] + correction[p] + push;
    for (int c = 0; c < symmetric_components<Dim>; ++c)
      ps.columns.data(ps.stress, c)[p] = c == Dim - 1 ? effective : c < 3 ? k0[m] * effective : 0;
  }
}

template void k0_stress<2>(const InitialStress&, Scene<2>&, const Materials<2>&, const SkeletonLoads<2>&);
template void k0_stress<3>(const InitialStress&, Scene<3>&, const Materials<3>&, const SkeletonLoads<3>&);

}  // namespace sluice
