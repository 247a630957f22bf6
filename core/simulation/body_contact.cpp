#include "core/simulation/body_contact.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/grid/contact.h"

namespace sluice {

namespace {

/// A node where the bodies have less of a surface in common than this, of what one of them has, is inside that one.
constexpr double least_agreement = 0.02;

}  // namespace

ContactProblems::ContactProblems(const Case& definition) : case_(definition) {
  const SchemeCase& scheme = definition.scheme;
  if (scheme.integration != "explicit")
    refuse("`integration: " + scheme.integration + "`", "take `integration: explicit`");
  if (scheme.stress_update != "usl")
    refuse("`stress_update: " + scheme.stress_update + "`", "it gains energy where bodies meet; take usl");
  if (definition.surface_loads) refuse("`surface_loads`", "load the bodies by weight or by faces that move");
}

void ContactProblems::refuse(const std::string& what, const std::string& instead) {
  if (case_.contact)
    problems_.add(case_.contact->place, fmt::format("contact: it does not go with {}; {}", what, instead));
}

template <int Dim>
BodyContact<Dim>::BodyContact(const ContactCase& contact, const std::vector<std::string>& materials) {
  law_.normal = FaceCase::Normal::contact;
  law_.tangential = FaceCase::Tangential::friction;
  law_.friction = contact.friction;
  law_.adhesion = contact.adhesion;
  double length = 0;
  for (const double component : contact.normal) length = std::hypot(length, component);
  given_normal_ = length > 0;
  for (int k = 0; given_normal_ && k < Dim; ++k) normal_[k] = contact.normal[static_cast<std::size_t>(k)] / length;
  // The materials of the list are bodies of their own, numbered as in it; all others are one more.
  for (const std::string& name : materials)
    body_of_.push_back(static_cast<int>(std::ranges::find(contact.materials, name) - contact.materials.begin()));
  nodes_.resize(static_cast<std::size_t>(contact.bodies()));
  surface_.resize(nodes_.size());
}

template <int Dim>
void BodyContact<Dim>::resize(const Blocks<Dim>& blocks, int reach) {
  std::vector<Bodies> own;
  for (const ParticleBlock<Dim>& block : blocks.particle_blocks()) {
    own.push_back(0);
    for_runs(blocks, block, [&](int body, std::uint32_t, std::uint32_t) { own.back() |= Bodies{1} << body; });
  }
  bodies_of_nodes_.clear();
  for (const NodeBlock<Dim>& nodes : blocks.node_blocks()) {
    bodies_of_nodes_.push_back(0);
    for (const std::int32_t block : nodes.particles)
      if (block >= 0) bodies_of_nodes_.back() |= own[static_cast<std::size_t>(block)];
  }
  at_others_.clear();
  for (const ParticleBlock<Dim>& block : blocks.particle_blocks())
    at_others_.push_back(
        std::ranges::any_of(block.nodes, [&](std::int32_t nodes) { return shared(static_cast<std::size_t>(nodes)); }));
  // The tiles of bodies that have no particles in a block stay as they are until the next sort.
  for (auto* fields : {&nodes_, &surface_})
    for (std::size_t g = 0; g < fields->size(); ++g) {
      NodeFields<Dim>& f = (*fields)[g];
      f.resize(blocks, reach);
      for (std::size_t b = 0; b < own.size(); ++b) {
        if ((own[b] >> g & 1) != 0) continue;
        std::fill_n(f.momentum_tile(b), f.tile_size(), Lane{});
        std::fill_n(f.force_tile(b), f.tile_size(), Lane{});
      }
    }
}

/// Pair by pair, in fixed order: momentum is kept whatever the number of bodies is.
template <int Dim>
void BodyContact<Dim>::exchange(const Blocks<Dim>& blocks, std::size_t node_block, double kick, double lightest,
                                FieldsByBody<Dim>* without_friction) {
  if (!shared(node_block)) return;
  for (int g = 0; g < bodies(); ++g) {
    if (!has(node_block, g)) continue;
    surface(g).collect_force(blocks, node_block);
    if (without_friction != nullptr) (*without_friction)[static_cast<std::size_t>(g)].collect_force(blocks, node_block);
  }
  for (int a = 0; a < bodies(); ++a)
    for (int b = a + 1; b < bodies(); ++b) {
      if (!has(node_block, a) || !has(node_block, b)) continue;
      const Lane *const of_a = nodes(a).momentum(node_block), *const of_b = nodes(b).momentum(node_block);
      for (int n = 0; n < block_nodes<Dim>; ++n)
        if (of_a[n][0] > lightest && of_b[n][0] > lightest)
          exchange_at_node(node_block, n, a, b, kick, without_friction);
    }
}

/// The surface that both bodies have at a node, as a vector out of body a: of each component, what the two agree on. A
/// mean of both (Nairn 2013), or the larger one, would tilt where one body ends on the flat side of the other, and
/// plough. With a normal that is given, what they have along it. A unit tension pulls a surface inwards.
template <int Dim>
Vector<Dim> BodyContact<Dim>::common_surface(const Lane& pull_a, const Lane& pull_b) const {
  Vector<Dim> common{};
  double along_a = 0, along_b = 0, most = 0, area = 0;
  for (int k = 0; k < Dim; ++k) {
    const double of_a = -pull_a[1 + k], of_b = pull_b[1 + k];
    common[k] = of_a * of_b <= 0 ? 0 : std::abs(of_a) < std::abs(of_b) ? of_a : of_b;
    area += common[k] * common[k];
    most += std::max(of_a * of_a, of_b * of_b);
    along_a += of_a * normal_[k];
    along_b += of_b * normal_[k];
  }
  if (given_normal_) {
    const double along = along_a * along_b <= 0 ? 0 : std::abs(along_a) < std::abs(along_b) ? along_a : along_b;
    for (int k = 0; k < Dim; ++k) common[k] = along * normal_[k];
    area = along * along;
  }
  return area > least_agreement * least_agreement * most ? common : Vector<Dim>{};
}

template <int Dim>
void BodyContact<Dim>::exchange_at_node(std::size_t node_block, int node, int a, int b, double kick,
                                        FieldsByBody<Dim>* without_friction) {
  const Vector<Dim> common = common_surface(surface(a).force(node_block)[node], surface(b).force(node_block)[node]);
  double area = 0;
  for (const double component : common) area += component * component;
  area = std::sqrt(area);
  if (!(area > 0)) return;
  Touch<Dim> touch;
  for (int k = 0; k < Dim; ++k) touch.out[k] = common[k] / area;
  const double mass_a = nodes(a).momentum(node_block)[node][0], mass_b = nodes(b).momentum(node_block)[node][0];
  const double share_a = mass_b / (mass_a + mass_b), share_b = mass_a / (mass_a + mass_b);
  touch.friction = true;
  touch.adhesion = law_.adhesion * area * kick / (share_a * mass_a);  // over the reduced mass
  if (without_friction != nullptr) {
    const Lane force_a = (*without_friction)[static_cast<std::size_t>(a)].force(node_block)[node],
               force_b = (*without_friction)[static_cast<std::size_t>(b)].force(node_block)[node];
    for (int k = 0; k < Dim; ++k) touch.relief[k] = kick * (force_a[1 + k] / mass_a - force_b[1 + k] / mass_b);
  }
  const NodeMotion<Dim> of_a{nodes(a).motion(node_block) + node * motion_lanes<Dim>};
  const NodeMotion<Dim> of_b{nodes(b).motion(node_block) + node * motion_lanes<Dim>};
  Lane lanes[motion_lanes<Dim>] = {};
  const NodeMotion<Dim> relative{lanes};
  for (int k = 0; k < Dim; ++k) lanes[0][k] = of_a.v(k) - of_b.v(k);
  impose_on_node<Dim>(law_, touch, relative);
  for (int k = 0; k < Dim; ++k) {
    of_a.set(k, of_a.v(k) + share_a * relative.change(k));
    of_b.set(k, of_b.v(k) - share_b * relative.change(k));
  }
}

template class BodyContact<2>;
template class BodyContact<3>;

}  // namespace sluice
