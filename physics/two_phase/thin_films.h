/// ThinFilms: material on a face of the grid that is thinner than about 0.4 of a cell moves as one. docs/theory.md,
/// eq. (49e).
///
/// The second node inside from a face has a weight that goes to zero with the distance of the particles from the face,
/// and a slope that does not: in a film it has hardly any mass, and the pressure moves it without bound.
#pragma once

#include <vector>

#include "core/simulation/scene.h"

namespace sluice {

template <int Dim>
class ThinFilms {
 public:
  /// Finds the nodes at faces; to be called when the blocks have changed.
  void find(const Scene<Dim>& scene);
  /// One velocity for a node on a face and the next one inside, where that is light; the face acts on what this
  /// changes. To be called when forces and faces have acted.
  void join(Scene<Dim>& scene) const;

 private:
  struct Node {
    std::size_t block;
    int number;
  };
  struct Pair {
    int axis, side;
    Node wall, inner;
  };
  void join(const Scene<Dim>& scene, const Pair& pair, NodeFields<Dim>& nodes) const;
  std::vector<Pair> pairs_;
};

extern template class ThinFilms<2>;
extern template class ThinFilms<3>;

}  // namespace sluice
