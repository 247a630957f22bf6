/// Dashpots: faces of the grid that let waves out (Lysmer & Kuhlemeyer 1969). docs/theory.md, eqs. (5a), (18c).
#pragma once

#include <array>
#include <vector>

#include "core/grid/faces.h"

namespace sluice {

template <int Dim>
class Dashpots {
 public:
  /// `bodies`: those that have nodes of their own.
  Dashpots(const Faces<Dim>& faces, const GridGeometry<Dim>& grid, int reach, int bodies);

  bool any() const { return any_; }

  /// Acts on the motion of a node block of a body after forces and other bodies have acted, and before anything else
  /// does. `area`, a lane a node, is that of Beside. In the first step the nodes note what holds them in place.
  void impose(const NodeBlock<Dim>& nodes, int body, Lane* motion, const Lane* area, double kick, bool first) {
    if (any_) impose_on_block(nodes, body, motion, area, kick, first);
  }

  /// For checkpoints.
  std::vector<double> record() const;
  void restore(const std::vector<double>& record);

 private:
  struct Face {
    int axis = 0, layer = 0;
    double outward = 0;
    AbsorbingCase beyond;
    std::size_t nodes = 1;
    std::vector<Vector<Dim>> held;  ///< acceleration that the face gives at rest, by body and node of the face [m/s2]
  };
  void impose_on_block(const NodeBlock<Dim>& nodes, int body, Lane* motion, const Lane* area, double kick, bool first);
  std::size_t number_on_face(const Index<Dim>& node, int axis) const;

  bool any_ = false;
  Index<Dim> nodes_{};  ///< of the grid
  std::vector<Face> faces_;
};

extern template class Dashpots<2>;
extern template class Dashpots<3>;

}  // namespace sluice
