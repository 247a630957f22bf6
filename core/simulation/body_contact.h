/// BodyContact: bodies that do not stick to each other (Bardenhagen, Brackbill & Sulsky 2000). docs/theory.md,
/// section 3.
///
/// Materials are grouped into bodies. Each body has fields of nodes of its own; particles scatter to and gather from
/// those of their body. Where two bodies share a node and come towards each other, they exchange momentum: what a
/// surface does to a node (core/grid/contact.h) is done to their relative velocity.
#pragma once

#include <cstdint>
#include <vector>

#include "core/case/case.h"
#include "core/case/problems.h"
#include "core/grid/blocks.h"
#include "core/grid/nodes.h"

namespace sluice {

/// Fields of nodes, one for each body that has nodes of its own.
template <int Dim>
using FieldsByBody = std::vector<NodeFields<Dim>>;

/// What in a case does not go with bodies that do not stick together: what no physics can do, and what a module adds.
class ContactProblems {
 public:
  explicit ContactProblems(const Case& definition);
  void refuse(const std::string& what, const std::string& instead);
  /// Nothing is thrown where the case has no such bodies.
  void throw_if_any() const { problems_.throw_if_any(); }

 private:
  const Case& case_;
  Problems problems_;
};

template <int Dim>
class BodyContact {
 public:
  /// `materials`: names in the order of their numbers.
  BodyContact(const ContactCase& contact, const std::vector<std::string>& materials);

  int bodies() const { return static_cast<int>(nodes_.size()); }
  bool has_friction() const { return law_.friction > 0; }
  NodeFields<Dim>& nodes(int body) { return nodes_[static_cast<std::size_t>(body)]; }
  /// In its force tiles: the area of the surface of a body by node, with its normal, as Scene::surface has it.
  NodeFields<Dim>& surface(int body) { return surface_[static_cast<std::size_t>(body)]; }

  /// Makes room for the active blocks, and finds which bodies are where.
  void resize(const Blocks<Dim>& blocks, int reach);
  bool has(std::size_t node_block, int body) const { return (bodies_of_nodes_[node_block] >> body & 1) != 0; }
  /// Whether several bodies reach a block of nodes, or a block of particles reaches such a one.
  bool shared(std::size_t node_block) const { return several(bodies_of_nodes_[node_block]); }
  bool at_others(std::size_t particle_block) const { return at_others_[particle_block] != 0; }

  /// Calls body(number of the body, first particle, behind the last) for the runs of particles of one body in a block.
  template <class Body>
  void for_runs(const Blocks<Dim>& blocks, const ParticleBlock<Dim>& block, const Body& body) const {
    for (std::uint32_t b = block.first_batch; b < block.last_batch;) {
      const Batch& first = blocks.batches()[b];
      const int own = body_of(first.material);
      std::uint32_t end = first.end;
      while (++b < block.last_batch && body_of(blocks.batches()[b].material) == own) end = blocks.batches()[b].end;
      body(own, first.begin, end);
    }
  }

  /// The exchange on a block of nodes, after forces have acted over `kick` [s]. Nodes lighter than `lightest` [kg] are
  /// left alone. `without_friction`, or null, has in its force tiles a part of the forces on each body, which presses
  /// the bodies together without friction.
  void exchange(const Blocks<Dim>& blocks, std::size_t node_block, double kick, double lightest,
                FieldsByBody<Dim>* without_friction);

 private:
  using Bodies = std::uint64_t;  // a bit for each
  static bool several(Bodies bodies) { return (bodies & (bodies - 1)) != 0; }
  int body_of(std::int32_t material) const { return body_of_[static_cast<std::size_t>(material)]; }
  Vector<Dim> common_surface(const Lane& pull_a, const Lane& pull_b) const;
  void exchange_at_node(std::size_t node_block, int node, int a, int b, double kick,
                        FieldsByBody<Dim>* without_friction);

  FaceCase law_;
  bool given_normal_ = false;
  Vector<Dim> normal_{};      // where it is given
  std::vector<int> body_of_;  // by material
  FieldsByBody<Dim> nodes_, surface_;
  std::vector<Bodies> bodies_of_nodes_;  // by block of nodes
  std::vector<char> at_others_;          // by block of particles
};

extern template class BodyContact<2>;
extern template class BodyContact<3>;

}  // namespace sluice
