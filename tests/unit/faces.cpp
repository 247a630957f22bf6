/// Faces of the grid on single nodes: fixed, roller, Coulomb friction that sticks or slips, corners.
#include "core/grid/faces.h"

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

namespace sluice {
namespace {

using Normal = FaceCase::Normal;
using Tangential = FaceCase::Tangential;

/// A grid of one block of cells, and the motion of its first block of nodes.
template <int Dim>
class Nodes {
 public:
  explicit Nodes(const std::map<std::string, FaceCase>& faces, int degree = 2)
      : faces_(faces, grid(), degree), motion_(static_cast<std::size_t>(block_nodes<Dim> * motion_lanes<Dim>)) {
    block_.first_node.fill(0);
    block_.low.fill(0);
    block_.high.fill(block_width<Dim>);
  }

  static GridGeometry<Dim> grid() {
    GridGeometry<Dim> g;
    g.cell.fill(1);
    g.cells.fill(2);
    g.max.fill(2);
    return g;
  }

  void set(const Index<Dim>& node, const Vector<Dim>& velocity, const Vector<Dim>& change) {
    for (int a = 0; a < Dim; ++a) {
      motion_[place(node)][a] = velocity[a];
      if (Dim == 2)
        motion_[place(node)][2 + a] = change[a];
      else
        motion_[place(node) + motion_lanes<Dim> - 1][a] = change[a];
    }
  }
  Vector<Dim> velocity(const Index<Dim>& node) const {
    Vector<Dim> v;
    for (int a = 0; a < Dim; ++a) v[a] = motion_[place(node)][a];
    return v;
  }
  Vector<Dim> change(const Index<Dim>& node) const {
    Vector<Dim> v;
    for (int a = 0; a < Dim; ++a)
      v[a] = Dim == 2 ? motion_[place(node)][2 + a] : motion_[place(node) + motion_lanes<Dim> - 1][a];
    return v;
  }
  void impose() { faces_.fix_with_friction(block_, motion_.data()); }
  void fix() { faces_.fix(block_, motion_.data()); }

 private:
  static std::size_t place(const Index<Dim>& node) {
    int n = 0;
    for (int a = Dim - 1; a >= 0; --a) n = n * block_width<Dim> + node[a];
    return static_cast<std::size_t>(n * motion_lanes<Dim>);
  }

  Faces<Dim> faces_;
  NodeBlock<Dim> block_{};
  std::vector<Lane> motion_;
};

const FaceCase roller{Normal::fixed, Tangential::free, 0}, fixed{Normal::fixed, Tangential::fixed, 0},
    rough{Normal::fixed, Tangential::friction, 0.5};

template <int Dim>
void expect_vector(const Vector<Dim>& found, const Vector<Dim>& expected) {
  for (int a = 0; a < Dim; ++a) EXPECT_NEAR(found[a], expected[a], 1e-15) << "component " << a;
}

TEST(Faces, RollerStopsNormalMotionInBothDirections) {
  Nodes<2> nodes({{"bottom", roller}});
  nodes.set({1, 0}, {3, -2}, {1, -1});
  nodes.set({2, 0}, {3, 2}, {1, 1});
  nodes.set({1, 1}, {3, -2}, {1, -1});
  nodes.impose();
  expect_vector<2>(nodes.velocity({1, 0}), {3, 0});
  expect_vector<2>(nodes.change({1, 0}), {1, 1});  // the change of velocity includes what the wall did: 0 - (-1)
  expect_vector<2>(nodes.velocity({2, 0}), {3, 0});
  expect_vector<2>(nodes.velocity({1, 1}), {3, -2});
  expect_vector<2>(nodes.change({1, 1}), {1, -1});
}

// Quadratic functions on 2 cells have nodes 0 … 3, linear ones 0 … 2: the last is on the wall.
TEST(Faces, UpperFaceActsOnTheLastNode) {
  for (const int degree : {1, 2}) {
    Nodes<2> nodes({{"right", roller}, {"top", fixed}}, degree);
    const int last = 1 + degree;
    nodes.set({last, 1}, {3, 2}, {0, 0});
    nodes.set({last - 1, 1}, {3, 2}, {0, 0});
    nodes.set({1, last}, {3, 2}, {0, 0});
    nodes.impose();
    expect_vector<2>(nodes.velocity({last, 1}), {0, 2});
    expect_vector<2>(nodes.velocity({last - 1, 1}), {3, 2});
    expect_vector<2>(nodes.velocity({1, last}), {0, 0});
  }
}

TEST(Faces, FrictionSlips) {
  Nodes<2> nodes({{"bottom", rough}});
  nodes.set({1, 0}, {3, -2}, {0, 0});
  nodes.set({2, 0}, {-3, -2}, {0, 0});
  nodes.impose();
  expect_vector<2>(nodes.velocity({1, 0}), {3 - 0.5 * 2, 0});
  expect_vector<2>(nodes.velocity({2, 0}), {-2, 0});
  expect_vector<2>(nodes.change({1, 0}), {-1, 2});
}

TEST(Faces, FrictionSticks) {
  Nodes<2> nodes({{"bottom", rough}});
  nodes.set({1, 0}, {0.9, -2}, {0, 0});
  nodes.set({2, 0}, {0, -2}, {0, 0});
  nodes.impose();
  expect_vector<2>(nodes.velocity({1, 0}), {0, 0});
  expect_vector<2>(nodes.velocity({2, 0}), {0, 0});
}

TEST(Faces, AWallThatIsPulledGivesNoFriction) {
  Nodes<2> nodes({{"bottom", rough}, {"top", rough}}, 1);
  nodes.set({1, 0}, {3, 2}, {0, 0});
  nodes.set({1, 2}, {3, -2}, {0, 0});
  nodes.impose();
  expect_vector<2>(nodes.velocity({1, 0}), {3, 0});
  expect_vector<2>(nodes.velocity({1, 2}), {3, 0});
}

// Before forces act there is no normal impulse: only what is fixed is fixed.
TEST(Faces, FixWithoutFriction) {
  Nodes<2> nodes({{"bottom", rough}, {"left", fixed}});
  nodes.set({1, 0}, {3, -2}, {0, 0});
  nodes.set({0, 2}, {3, -2}, {0, 0});
  nodes.fix();
  expect_vector<2>(nodes.velocity({1, 0}), {3, 0});
  expect_vector<2>(nodes.velocity({0, 2}), {0, 0});
}

TEST(Faces, CornersObeyBothFaces) {
  Nodes<2> nodes({{"bottom", roller}, {"left", roller}});
  nodes.set({0, 0}, {3, -2}, {0, 0});
  nodes.impose();
  expect_vector<2>(nodes.velocity({0, 0}), {0, 0});
}

// In 3-D friction acts along the slip, (3, 4) / 5 here, and takes 0.5 * 2 of its speed of 5.
TEST(Faces, FrictionInThreeDimensionsFollowsTheSlip) {
  Nodes<3> nodes({{"bottom", rough}});
  nodes.set({1, 1, 0}, {3, 4, -2}, {0, 0, 0});
  nodes.impose();
  expect_vector<3>(nodes.velocity({1, 1, 0}), {3 * 0.8, 4 * 0.8, 0});
  expect_vector<3>(nodes.change({1, 1, 0}), {-0.6, -0.8, 2});
}

TEST(Faces, FreeFacesDoNothing) {
  Nodes<2> nodes({{"bottom", FaceCase{}}});
  nodes.set({0, 0}, {3, -2}, {1, 1});
  nodes.impose();
  expect_vector<2>(nodes.velocity({0, 0}), {3, -2});
}

TEST(Faces, AFaceThatTheDimensionDoesNotHave) {
  EXPECT_THROW(Nodes<2>({{"front", roller}}), CaseError);
  EXPECT_NO_THROW(Nodes<3>({{"front", roller}}));
}

}  // namespace
}  // namespace sluice
