#include "physics/statics/surface_laws.h"

#include <algorithm>
#include <cmath>

#include "core/simulation/stages.h"

namespace sluice {

namespace {

/// Stiffness of a law over that of its node. The derivative of what `impose` makes has the eigenvalues k / (S + k) to
/// that of the matrix where material sticks, and S / (S + k) where it slips, with S the stiffness of the body as its
/// surface feels it, at most that of the nodes and less for motions of many: the one should not be small, nor the
/// other.
constexpr double yielding = 0.5;
/// The same for a normal that is always held.
constexpr double holding = 100;

template <int Dim>
double dot(const Vector<Dim>& a, const Vector<Dim>& b) {
  double sum = 0;
  for (int c = 0; c < Dim; ++c) sum += a[c] * b[c];
  return sum;
}

/// The axis that a normal lies along, or -1.
template <int Dim>
int axis_of(const Vector<Dim>& normal) {
  for (int a = 0; a < Dim; ++a)
    if (std::abs(normal[a]) > 1 - 1e-12) return a;
  return -1;
}

}  // namespace

template <int Dim>
SurfaceLaws<Dim>::SurfaceLaws(Scene<Dim>& scene, const Unknowns<Dim>& unknowns, double dt, double scale)
    : scene_(scene),
      dt_(dt),
      scale_(scale),
      owner_(static_cast<std::size_t>(unknowns.count()), -1),
      displacement_(owner_.size(), 0.0),
      velocity_(owner_.size(), 0.0),
      force_(scene.obstacles.count() + 2 * Dim) {
  const std::vector<Vector<Dim>> area = areas(unknowns);
  for (std::size_t k = 0; k < unknowns.nodes().size(); ++k) find(unknowns.nodes()[k], k * Dim, area[k]);
  for (Law& law : laws_) reduce(law);
  std::erase_if(laws_, [](const Law& law) { return law.share == 0; });  // nothing is left for them to say
}

/// The area of the surface of the material that belongs to each node, with its normal, eq. (18b).
template <int Dim>
std::vector<Vector<Dim>> SurfaceLaws<Dim>::areas(const Unknowns<Dim>& unknowns) {
  std::vector<Vector<Dim>> area(unknowns.nodes().size(), Vector<Dim>{});
  if (!scene_.wants_area()) return area;
  scatter_surface(scene_);
  for (std::size_t b = 0; b < scene_.blocks.node_blocks().size(); ++b) {
    scene_.surface.collect_force(scene_.blocks, b);
    for (int n = 0; n < block_nodes<Dim>; ++n) {
      const Index<Dim> node = scene_.blocks.node_blocks()[b].node(n);
      const int first = unknowns.find(node)[0];
      if (first < 0) continue;
      for (int a = 0; a < Dim; ++a) area[static_cast<std::size_t>(first) / Dim][a] = -scene_.surface.force(b)[n][1 + a];
    }
  }
  return area;
}

/// The surfaces that a node is on, in the order in which explicit steps let them act: faces have the last word.
template <int Dim>
void SurfaceLaws<Dim>::find(const Index<Dim>& node, std::size_t first, const Vector<Dim>& area) {
  if (scene_.obstacles.any())
    for (const auto& hold : scene_.obstacles.holds_on(node))
      add(first, static_cast<int>(hold.obstacle), *hold.surface, hold.inside, hold.out, dot<Dim>(hold.out, area));
  for (int axis = 0; axis < Dim; ++axis)
    for (int side = 0; side < 2; ++side) {
      const FaceCase& face = scene_.faces.face(axis, side);
      if (face.normal == FaceCase::Normal::free || node[axis] != scene_.faces.wall_node(axis, side)) continue;
      Vector<Dim> out{};
      out[axis] = side == 0 ? -1 : 1;
      add(first, static_cast<int>(scene_.obstacles.count()) + 2 * axis + side, face, true, out, dot<Dim>(out, area));
    }
}

template <int Dim>
void SurfaceLaws<Dim>::give(std::size_t unknown, int owner, double displacement, double velocity) {
  owner_[unknown] = owner;
  displacement_[unknown] = displacement;
  velocity_[unknown] = velocity;
}

template <int Dim>
void SurfaceLaws<Dim>::add(std::size_t first, int owner, const FaceCase& rule, bool touches, const Vector<Dim>& out,
                           double area) {
  const double end = scene_.time + dt_;
  Law law{first, owner, &rule, touches, false, false, out, 1, {}, {}, scale_ * rule.adhesion * std::max(0.0, area)};
  for (std::size_t a = 0; a < rule.velocity.size(); ++a) {
    law.displacement[a] = rule.velocity[a].integral(end) - rule.velocity[a].integral(scene_.time);
    law.velocity[a] = rule.velocity[a].at(end);
  }
  const bool fixed = touches && rule.normal == FaceCase::Normal::fixed;
  const int axis = axis_of<Dim>(out);
  for (int a = 0; fixed && a < Dim; ++a)
    if (a == axis || rule.tangential == FaceCase::Tangential::fixed)
      give(first + static_cast<std::size_t>(a), owner, law.displacement[a], law.velocity[a]);
  law.normal_given = fixed && axis >= 0;
  const bool rough = rule.tangential == FaceCase::Tangential::friction;
  if (fixed && (rule.tangential == FaceCase::Tangential::fixed || (law.normal_given && !rough))) return;
  laws_.push_back(law);
}

/// What others give is no part of a law, but friction is a force all the same where they drag the node along.
template <int Dim>
void SurfaceLaws<Dim>::reduce(Law& law) {
  double free = 0;
  bool along = false, rubs = false;
  for (int a = 0; a < Dim; ++a) {
    const std::size_t i = law.first + static_cast<std::size_t>(a);
    const double normal = law.out[a] * law.out[a];
    if (!given(static_cast<int>(i))) {
      free += normal;
      along = along || normal < 1 - 1e-12;
    } else if (owner_[i] != law.owner && normal < 1e-12) {
      rubs = rubs || displacement_[i] != law.displacement[a];
    }
  }
  law.dragged = rubs && law.rule->tangential == FaceCase::Tangential::friction;
  if (!law.normal_given) law.share = std::sqrt(free) < 1e-9 ? 0 : std::sqrt(free);
  if (law.normal_given && !along && !law.dragged) law.share = 0;
}

/// Friction on a node that others drag along: against its slip, of which `slip` has what is free. What it takes from
/// components that are given, those supply who give them. Returns the force on the node.
template <int Dim>
Vector<Dim> SurfaceLaws<Dim>::rub(const Law& law, const Vector<Dim>& slip, double most) {
  Vector<Dim> all = slip;
  double size = 0;
  for (int a = 0; a < Dim; ++a) {
    const std::size_t i = law.first + static_cast<std::size_t>(a);
    const bool along = law.out[a] * law.out[a] < 1e-12;
    if (given(static_cast<int>(i)) && along) all[a] = displacement_[i] - law.displacement[a];
    size += all[a] * all[a];
  }
  for (int a = 0; a < Dim; ++a) {
    const std::size_t i = law.first + static_cast<std::size_t>(a);
    all[a] *= -most / std::sqrt(size);
    if (!given(static_cast<int>(i))) continue;
    force_[static_cast<std::size_t>(law.owner)][a] -= all[a] / scale_;
    force_[static_cast<std::size_t>(owner_[i])][a] += all[a] / scale_;
  }
  return all;
}

template <int Dim>
void SurfaceLaws<Dim>::stiffen(const Eigen::VectorXd& diagonal, std::vector<Eigen::Triplet<double>>& matrix) {
  for (Law& law : laws_) {
    double mean = 0;
    for (int a = 0; a < Dim; ++a) mean += diagonal[static_cast<Eigen::Index>(law.first) + a] / Dim;
    law.stiffness = yielding * mean;
    law.normal_stiffness = (law.rule->normal == FaceCase::Normal::fixed ? holding : yielding) * mean;
    const bool slides = law.rule->tangential == FaceCase::Tangential::free;
    for (int r = 0; r < Dim; ++r)
      for (int c = 0; c <= r; ++c) {
        const double normal = law.out[r] * law.out[c];
        double value = slides ? 0 : law.stiffness * ((r == c ? 1 : 0) - normal);
        if (law.touches && !law.normal_given) value += law.normal_stiffness * normal;
        const int first = static_cast<int>(law.first);
        if (value != 0) matrix.emplace_back(first + r, first + c, value);
      }
  }
}

template <int Dim>
void SurfaceLaws<Dim>::impose(std::span<const double> u, const Eigen::VectorXd& loads, std::span<double> f) {
  std::fill(force_.begin(), force_.end(), Vector<Dim>{});
  for (std::size_t i = 0; i < owner_.size(); ++i)
    if (owner_[i] >= 0) force_[static_cast<std::size_t>(owner_[i])][i % Dim] -= f[i] / scale_;
  for (Law& law : laws_) impose(law, u, loads, f);
}

template <int Dim>
void SurfaceLaws<Dim>::impose(Law& law, std::span<const double> u, const Eigen::VectorXd& loads, std::span<double> f) {
  Vector<Dim> needed{}, gap{}, out = law.out;  // of what is free
  double open = 0, loaded = 0, across = 0;
  for (int a = 0; a < Dim; ++a) {
    const std::size_t i = law.first + static_cast<std::size_t>(a);
    const bool held = given(static_cast<int>(i));
    open += (u[i] - law.displacement[a]) * law.out[a];
    loaded += loads[static_cast<Eigen::Index>(i)] * law.out[a];
    if (law.normal_given) across += f[i] * law.out[a];
    if (held)
      out[a] = 0;
    else
      needed[a] = f[i], gap[a] = u[i] - law.displacement[a];
  }
  if (!law.normal_given) {
    for (double& component : out) component /= law.share;
    open /= law.share;
    across = dot<Dim>(needed, out);
  }
  const bool fixed = law.touches && law.rule->normal == FaceCase::Normal::fixed;
  const double k = law.normal_stiffness;
  law.closed = fixed || (law.touches && across - k * open < 0);
  const double pressing = !law.touches ? 0 : std::max(0.0, (fixed ? 0 : k * open) - across);
  const double normal = law.normal_given || !law.closed ? dot<Dim>(needed, out) : k * open;

  Vector<Dim> along, slip, supplied;
  double size = 0;
  const double needed_normal = dot<Dim>(needed, out), gap_normal = dot<Dim>(gap, out);
  for (int a = 0; a < Dim; ++a) {
    along[a] = needed[a] - needed_normal * out[a];
    slip[a] = gap[a] - gap_normal * out[a];
    supplied[a] = along[a] - law.stiffness * slip[a];
    size += supplied[a] * supplied[a];
  }
  double most = 0;
  if (law.rule->tangential == FaceCase::Tangential::fixed) most = law.closed ? std::numeric_limits<double>::max() : 0;
  if (law.rule->tangential == FaceCase::Tangential::friction)
    most = (law.closed ? law.rule->friction * std::max(0.0, pressing - loaded) : 0) + law.adhesion;
  size = std::sqrt(size);
  law.sticks = !law.dragged && size <= most && most > 0;
  if (law.dragged)
    supplied = rub(law, slip, most);
  else if (size > most)
    for (double& component : supplied) component *= most / size;
  Vector<Dim>& force = force_[static_cast<std::size_t>(law.owner)];
  for (int a = 0; a < Dim; ++a) {
    const std::size_t i = law.first + static_cast<std::size_t>(a);
    if (given(static_cast<int>(i))) continue;
    const double left = along[a] - supplied[a] + normal * out[a];
    force[a] -= (needed[a] - left) / scale_;
    f[i] = left;
  }
}

template <int Dim>
void SurfaceLaws<Dim>::stop(std::span<double> velocity) const {
  for (std::size_t i = 0; i < owner_.size(); ++i)
    if (owner_[i] >= 0) velocity[i] = velocity_[i];
  for (const Law& law : laws_) {
    Vector<Dim> relative;
    for (int a = 0; a < Dim; ++a) relative[a] = velocity[law.first + static_cast<std::size_t>(a)] - law.velocity[a];
    const double normal = dot<Dim>(relative, law.out);
    for (int a = 0; a < Dim; ++a) {
      const std::size_t i = law.first + static_cast<std::size_t>(a);
      if (given(static_cast<int>(i))) continue;
      if (law.closed) velocity[i] -= normal * law.out[a];
      if (law.sticks) velocity[i] -= relative[a] - normal * law.out[a];
    }
  }
}

template class SurfaceLaws<2>;
template class SurfaceLaws<3>;

}  // namespace sluice
