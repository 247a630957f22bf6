/// VelocityFilter: the further mappings between nodes and particles by which XPIC keeps what PIC would smooth away.
/// docs/theory.md, eq. (20b). Costs nothing with other transfers.
#pragma once

#include <array>
#include <vector>

#include "core/simulation/stages.h"
#include "core/simulation/sweep.h"

namespace sluice {

/// With u_1 the velocity of the nodes before forces, and u_k = S+ S u_{k-1} what is left of it after k - 1 mappings to
/// the particles and back, the change of velocity of the nodes gives way to
///   sum_{k = 1..m} (-1)^(k+1) binomial(m, k) u_k - u_1,
/// which particles add to the velocity of the nodes.
template <int Dim>
class VelocityFilter {
 public:
  static bool wanted(const Scene<Dim>& scene) { return scene.transfer.filtered && scene.scheme.xpic_order > 1; }

  /// For the velocity of the scene, when the nodes have their new velocity and momentum is still that before forces.
  /// Nobody may need the change of velocity any more.
  void add(Sweep<Dim>& sweep, Scene<Dim>& scene);

  /// What gets the sum: the nodes of each body.
  using Targets = std::vector<NodeFields<Dim>*>;

  // The same in parts, for another velocity of the nodes. `momentum` is {m, m u_1}.
  void take(Scene<Dim>& scene, std::size_t node_block, int body, const Lane* momentum, const Faces<Dim>& faces);
  void resize(const Scene<Dim>& scene);
  /// `mass` is the column of masses that `momentum` was made with.
  void add_maps(Sweep<Dim>& sweep, Scene<Dim>& scene, ColumnId mass, const Faces<Dim>& faces, const Targets& targets);

 private:
  void map(Scene<Dim>& scene, int k, ColumnId mass, Items some);
  void collect(Scene<Dim>& scene, int k, const Faces<Dim>& faces, const Targets& targets, Items some);
  void collect_body(Scene<Dim>& scene, int k, const Faces<Dim>& faces, int body, NodeFields<Dim>& target,
                    std::size_t node_block);

  /// u_k of each body: those of odd and even k in turn, so that a stage does not write what another may still read.
  std::vector<std::array<NodeFields<Dim>, 2>> nodes_;
  std::vector<Workspace<Dim>> workspaces_;
};

extern template class VelocityFilter<2>;
extern template class VelocityFilter<3>;

}  // namespace sluice
