#include "core/grid/obstacles.h"

#include <algorithm>

namespace sluice {

template <int Dim>
Obstacles<Dim>::Obstacles(const std::vector<ObstacleCase>& obstacles, std::array<std::vector<double>, Dim> places,
                          double support, const Vector<Dim>& low, const Vector<Dim>& period)
    : places_(std::move(places)), low_(low), period_(period) {
  for (const ObstacleCase& definition : obstacles)
    obstacles_.push_back({definition, {}, {}, definition.region.bounds(Dim)});
  // Cells are uniform, nodes are not quite: some shape functions have their outermost nodes on the walls.
  for (std::size_t a = 0; a < Dim; ++a) {
    const std::size_t last = places_[a].size() - 1;
    double cell = 0;
    for (std::size_t i = 0; i < last; ++i) cell = std::max(cell, places_[a][i + 1] - places_[a][i]);
    support_[a] = support * cell;
    hair_ = a == 0 ? 1e-9 * cell : std::min(hair_, 1e-9 * cell);
  }
  begin_step(0, 0, 0);
}

template <int Dim>
bool Obstacles<Dim>::any_friction() const {
  return std::any_of(obstacles_.begin(), obstacles_.end(), [](const Obstacle& obstacle) {
    return obstacle.definition.surface.tangential == FaceCase::Tangential::friction;
  });
}

template <int Dim>
bool Obstacles<Dim>::any_adhesion() const {
  return std::any_of(obstacles_.begin(), obstacles_.end(),
                     [](const Obstacle& obstacle) { return obstacle.definition.surface.adhesion > 0; });
}

template <int Dim>
void Obstacles<Dim>::begin_step(double time, double time_before, double time_now) {
  for (Obstacle& obstacle : obstacles_) {
    const FaceCase& surface = obstacle.definition.surface;
    obstacle.velocity.evaluate(surface, time_before, time_now);
    const Vector<Dim> before = obstacle.travel;
    for (std::size_t a = 0; a < surface.velocity.size(); ++a) obstacle.travel[a] = surface.velocity[a].integral(time);
    if (obstacle.travel != before) ++version_;
  }
}

template <int Dim>
void Obstacles<Dim>::resize(std::size_t node_blocks) {
  if (!any()) return;
  ++version_;
  blocks_.resize(node_blocks);
  force_.assign(node_blocks * obstacles_.size(), {});
}

// ---- where nodes lie ----

template <int Dim>
Vector<Dim> Obstacles<Dim>::place(const Index<Dim>& node) const {
  Vector<Dim> x;
  for (int a = 0; a < Dim; ++a) x[a] = places_[a][static_cast<std::size_t>(node[a])];
  return x;
}

/// Along periodic axes the obstacle is repeated: the nearest of its images counts.
template <int Dim>
SignedDistance Obstacles<Dim>::where(const Obstacle& obstacle, Vector<Dim> x) const {
  int images = 1;
  for (int a = 0; a < Dim; ++a) {
    x[a] -= obstacle.travel[a];
    if (period_[a] <= 0) continue;
    x[a] -= std::floor((x[a] - low_[a]) / period_[a]) * period_[a];
    images *= 3;
  }
  SignedDistance nearest;
  for (int n = 0; n < images; ++n) {
    Vector<Dim> image = x;
    for (int a = 0, rest = n; a < Dim; ++a)
      if (period_[a] > 0) image[a] += (rest % 3 - 1) * period_[a], rest /= 3;
    const SignedDistance here = obstacle.definition.region.signed_distance(image);
    if (n == 0 || here.distance < nearest.distance) nearest = here;
  }
  return nearest;
}

/// The nodes [first, second) of the grid that a block has, and that particles reach. The margins of tiles go beyond it.
template <int Dim>
std::array<Index<Dim>, 2> Obstacles<Dim>::range(const NodeBlock<Dim>& nodes) const {
  std::array<Index<Dim>, 2> range;
  for (int a = 0; a < Dim; ++a) {
    range[0][a] = std::max(0, nodes.first_node[a] + nodes.low[a]);
    range[1][a] = std::min(static_cast<int>(places_[a].size()), nodes.first_node[a] + nodes.high[a]);
  }
  return range;
}

/// Whether the box around an obstacle, wider by `margin`, reaches the nodes of a block.
template <int Dim>
bool Obstacles<Dim>::near(const Obstacle& obstacle, const NodeBlock<Dim>& nodes, const Vector<Dim>& margin) const {
  const auto [low, high] = range(nodes);
  for (int a = 0; a < Dim; ++a) {
    if (low[a] >= high[a]) return false;
    if (period_[a] > 0) continue;
    const auto axis = static_cast<std::size_t>(a);
    const double first = places_[a][static_cast<std::size_t>(low[a])] - obstacle.travel[a];
    const double last = places_[a][static_cast<std::size_t>(high[a] - 1)] - obstacle.travel[a];
    if (last < obstacle.bounds[0][axis] - margin[a] || first > obstacle.bounds[1][axis] + margin[a]) return false;
  }
  return true;
}

template <int Dim>
const std::vector<typename Obstacles<Dim>::Contact>& Obstacles<Dim>::contacts(const NodeBlock<Dim>& nodes,
                                                                              std::size_t block) {
  Block& known = blocks_[block];
  if (known.version == version_) return known.contacts;
  known.contacts.clear();
  for (std::size_t o = 0; o < obstacles_.size(); ++o) find(nodes, o, known.contacts);
  known.version = version_;
  return known.contacts;
}

namespace {

/// Calls visit(number in the block, node) for the nodes of a block within [low, high) of the grid.
template <int Dim, class Visit>
void for_nodes(const NodeBlock<Dim>& nodes, const std::array<Index<Dim>, 2>& range, const Visit& visit) {
  for (int n = 0; n < block_nodes<Dim>; ++n) {
    const Index<Dim> node = nodes.node(n);
    bool reached = true;
    for (int a = 0; a < Dim; ++a) reached = reached && node[a] >= range[0][a] && node[a] < range[1][a];
    if (reached) visit(n, node);
  }
}

}  // namespace

/// How far a shape function goes towards a surface with this normal [m].
template <int Dim>
double Obstacles<Dim>::support_along(const Vector<Dim>& normal) const {
  double support = 0;
  for (int a = 0; a < Dim; ++a) support += std::abs(normal[a]) * support_[a];
  return support;
}

/// Adds the nodes of the block that the obstacle with this number acts on.
template <int Dim>
void Obstacles<Dim>::find(const NodeBlock<Dim>& nodes, std::size_t number, std::vector<Contact>& contacts) const {
  const Obstacle& obstacle = obstacles_[number];
  const bool adheres = obstacle.definition.surface.adhesion > 0;
  Vector<Dim> margin = support_;
  if (!adheres) margin.fill(hair_);
  if (!near(obstacle, nodes, margin)) return;
  for_nodes<Dim>(nodes, range(nodes), [&](int n, const Index<Dim>& node) {
    Contact contact{n, static_cast<std::int32_t>(number), false, {}};
    if (acts(obstacle, place(node), &contact.inside, &contact.out)) contacts.push_back(contact);
  });
}

// ---- around them ----

/// -1: none reaches the node. `normal` is that of its surface.
template <int Dim>
int Obstacles<Dim>::nearest_within_support(const Index<Dim>& node, Vector<Dim>& normal) const {
  int nearest = -1;
  double least = 0;
  for (std::size_t o = 0; o < obstacles_.size(); ++o) {
    const SignedDistance found = where(obstacles_[o], place(node));
    Vector<Dim> out;
    for (int a = 0; a < Dim; ++a) out[a] = found.normal[static_cast<std::size_t>(a)];
    if (found.distance >= support_along(out) - hair_ || (nearest >= 0 && found.distance >= least)) continue;
    normal = out;
    nearest = static_cast<int>(o);
    least = found.distance;
  }
  return nearest;
}

template <int Dim>
void Obstacles<Dim>::note_faces(const Faces<Dim>& faces) {
  grid_faces_.clear();
  for (int axis = 0; axis < Dim; ++axis)
    for (int side = 0; side < 2; ++side) {
      const FaceCase& rule = faces.face(axis, side);
      const bool held = rule.normal == FaceCase::Normal::fixed && rule.velocity.empty();
      if (!rule.periodic) grid_faces_.push_back({axis, faces.wall_node(axis, side), held});
    }
}

template <int Dim>
typename Obstacles<Dim>::Near Obstacles<Dim>::near_of(const Index<Dim>& node) const {
  Near near{};
  near.obstacle = nearest_within_support(node, near.normal);
  near.bound.fill(near.obstacle >= 0);
  for (const GridFace& face : grid_faces_)
    if (node[face.axis] == face.layer) {
      const auto axis = static_cast<std::size_t>(face.axis);
      near.held[axis] = face.held;
      if (!face.held) near.bound[axis] = false;
    }
  return near;
}

template <int Dim>
bool Obstacles<Dim>::surround(const Index<Dim>& node, int axis) const {
  return any() && near_of(node).bound[static_cast<std::size_t>(axis)];
}

template <int Dim>
const std::vector<typename Obstacles<Dim>::Near>& Obstacles<Dim>::surroundings(const NodeBlock<Dim>& nodes,
                                                                               std::size_t block) {
  Block& known = blocks_[block];
  if (known.near_version == version_) return known.near;
  known.near.clear();
  known.near_version = version_;
  if (std::any_of(obstacles_.begin(), obstacles_.end(),
                  [&](const Obstacle& obstacle) { return near(obstacle, nodes, support_); }))
    for_nodes<Dim>(nodes, range(nodes), [&](int n, const Index<Dim>& node) {
      Near near = near_of(node);
      near.node = n;
      if (near.obstacle >= 0) known.near.push_back(near);
    });
  return known.near;
}

template <int Dim>
void Obstacles<Dim>::press(const NodeBlock<Dim>& nodes, std::size_t block, const Lane* slopes, const Lane* spread,
                           Lane* force, bool again) {
  surroundings(nodes, block);
  for (Near& near : blocks_[block].near)
    for (int a = 0; a < Dim; ++a) {
      const bool bound = near.bound[static_cast<std::size_t>(a)];
      const double now = bound ? spread[near.node][1 + a] - slopes[near.node][1 + a] : 0;
      force[near.node][1 + a] += now - (again ? near.traction[a] : 0);
      near.traction[a] = now;
    }
}

template <int Dim>
void Obstacles<Dim>::add_relief(std::size_t block, const Lane* momentum, double kick, Lane* relief) const {
  if (!any() || blocks_[block].near_version != version_) return;  // nothing has pressed on them
  for (const Near& near : blocks_[block].near) {
    const double mass = momentum[near.node][0];
    for (int a = 0; a < Dim && mass > 0; ++a) relief[near.node][a] += kick / mass * near.traction[a];
  }
}

/// Whether an obstacle acts on a node that stands at x, from within or by its adhesion, and with which normal.
template <int Dim>
bool Obstacles<Dim>::acts(const Obstacle& obstacle, const Vector<Dim>& x, bool* inside, Vector<Dim>* out) const {
  const SignedDistance found = where(obstacle, x);
  for (int a = 0; a < Dim; ++a) (*out)[a] = -found.normal[static_cast<std::size_t>(a)];
  *inside = found.distance <= hair_;
  return *inside || (obstacle.definition.surface.adhesion > 0 && found.distance < support_along(*out));
}

template <int Dim>
std::vector<typename Obstacles<Dim>::Hold> Obstacles<Dim>::holds_on(const Index<Dim>& node) const {
  std::vector<Hold> all;
  for (std::size_t o = 0; o < obstacles_.size(); ++o) {
    Hold hold{o, &obstacles_[o].definition.surface, false, {}};
    if (acts(obstacles_[o], place(node), &hold.inside, &hold.out)) all.push_back(hold);
  }
  return all;
}

// ---- what they do ----

template <int Dim>
void Obstacles<Dim>::impose(const NodeBlock<Dim>& nodes, std::size_t block, const Lane* momentum, Lane* motion,
                            Moment moment, const Beside& beside, double kick) {
  const double per_kick = kick > 0 ? 1 / kick : 0;
  for (const Contact& contact : contacts(nodes, block)) {
    const double mass = momentum[contact.node][0];
    if (!(mass > 0) || (!contact.inside && beside.area == nullptr)) continue;
    const Obstacle& obstacle = obstacles_[static_cast<std::size_t>(contact.obstacle)];
    const FaceCase& surface = obstacle.definition.surface;
    Touch<Dim> touch;
    touch.out = contact.out;
    touch.velocity = moment == Moment::before ? obstacle.velocity.before : obstacle.velocity.now;
    touch.friction = moment == Moment::kicked;
    double area = 0;
    for (int a = 0; a < Dim; ++a) {
      if (beside.relief != nullptr) touch.relief[a] = beside.relief[contact.node][a];
      if (beside.area != nullptr) area += touch.out[a] * beside.area[contact.node][a];
    }
    touch.adhesion = surface.adhesion * std::max(0.0, area);
    const NodeMotion<Dim> own{motion + contact.node * motion_lanes<Dim>};
    const Vector<Dim> before = own.velocity();
    if (contact.inside)
      impose_on_node<Dim>(surface, touch, own);
    else
      adhere_on_node<Dim>(touch, own);
    if (moment != Moment::kicked) continue;
    Vector<Dim>& force = force_[block * obstacles_.size() + static_cast<std::size_t>(contact.obstacle)];
    for (int a = 0; a < Dim; ++a) force[a] += per_kick * mass * (before[a] - own.v(a));
  }
}

template <int Dim>
void Obstacles<Dim>::start_force(std::size_t block) {
  if (!any()) return;
  Vector<Dim>* const force = force_.data() + block * obstacles_.size();
  std::fill_n(force, obstacles_.size(), Vector<Dim>{});
  for (const Near& near : blocks_[block].near)
    for (int a = 0; a < Dim; ++a)  // what presses on a face of the grid is the face's
      if (!near.held[static_cast<std::size_t>(a)]) force[near.obstacle][a] -= near.traction[a];
}

template <int Dim>
void Obstacles<Dim>::close(const NodeBlock<Dim>& nodes, std::size_t block, Lane* motion) {
  if (!any()) return;
  FaceCase closed;
  closed.normal = FaceCase::Normal::fixed;
  for (const Contact& contact : contacts(nodes, block))
    if (contact.inside) impose_on_node<Dim>(closed, {.out = contact.out}, {motion + contact.node * motion_lanes<Dim>});
}

// ---- what others ask ----

template <int Dim>
std::vector<std::pair<std::string, double>> Obstacles<Dim>::forces() const {
  static const char* const axes[] = {"x", "y", "z"};
  std::vector<std::pair<std::string, double>> all;
  for (std::size_t o = 0; o < obstacles_.size(); ++o)
    for (int a = 0; a < Dim; ++a) {
      double sum = 0;
      for (std::size_t b = 0; b * obstacles_.size() < force_.size(); ++b) sum += force_[b * obstacles_.size() + o][a];
      all.emplace_back(obstacles_[o].definition.name + "_force_" + axes[a] + "_N", sum);
    }
  return all;
}

template <int Dim>
void Obstacles<Dim>::set_forces(const std::vector<Vector<Dim>>& forces) {
  std::fill(force_.begin(), force_.end(), Vector<Dim>{});
  if (!force_.empty()) std::copy(forces.begin(), forces.end(), force_.begin());
}

template <int Dim>
const ObstacleCase* Obstacles<Dim>::at(const Vector<Dim>& x, SignedDistance* found) const {
  for (const Obstacle& obstacle : obstacles_) {
    *found = where(obstacle, x);
    if (found->distance <= hair_) return &obstacle.definition;
  }
  return nullptr;
}

template <int Dim>
SignedDistance Obstacles<Dim>::nearest(const Vector<Dim>& x, const ObstacleCase** whose) const {
  SignedDistance nearest;
  for (std::size_t o = 0; o < obstacles_.size(); ++o) {
    const SignedDistance here = where(obstacles_[o], x);
    if (o > 0 && here.distance >= nearest.distance) continue;
    nearest = here;
    if (whose != nullptr) *whose = &obstacles_[o].definition;
  }
  return nearest;
}

template <int Dim>
bool Obstacles<Dim>::reach(const Vector<Dim>& low, const Vector<Dim>& high) const {
  return std::any_of(obstacles_.begin(), obstacles_.end(), [&](const Obstacle& obstacle) {
    for (int a = 0; a < Dim; ++a) {
      const auto axis = static_cast<std::size_t>(a);
      const double travel = obstacle.travel[a];
      if (period_[a] <= 0 &&
          (high[a] < obstacle.bounds[0][axis] + travel || low[a] > obstacle.bounds[1][axis] + travel))
        return false;
    }
    return true;
  });
}

template <int Dim>
bool Obstacles<Dim>::holds(const Index<Dim>& node, int component) const {
  SignedDistance found;
  const ObstacleCase* const obstacle = at(place(node), &found);
  if (obstacle == nullptr) return false;
  return obstacle->surface.tangential != FaceCase::Tangential::free ||
         found.normal[static_cast<std::size_t>(component)] != 0;
}

template class Obstacles<2>;
template class Obstacles<3>;

}  // namespace sluice
