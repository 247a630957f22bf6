/// Regions of the case file.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/case/geometry.h"

namespace sluice {
namespace {

bool in(const Region& region, std::vector<double> x) { return region.contains(x); }

TEST(Geometry, BoxIsHalfOpen) {
  const Region box{{Box{{0, 0}, {2, 1}}}};
  EXPECT_TRUE(in(box, {0, 0}));
  EXPECT_FALSE(in(box, {2, 0.5}));
  EXPECT_FALSE(in(box, {1, 1}));
  EXPECT_DOUBLE_EQ(box.distance_to_surface(std::vector{1.0, 0.4}), 0.4);
  EXPECT_DOUBLE_EQ(box.distance_to_surface(std::vector{5.0, 5.0}), 5);
}

TEST(Geometry, HalfSpaceHoldsWhatItsNormalPointsAwayFrom) {
  const Region below{{HalfSpace{{0, 2}, {0, 3}}}};
  EXPECT_TRUE(in(below, {7, 1}));
  EXPECT_TRUE(in(below, {7, 2}));
  EXPECT_FALSE(in(below, {7, 2.1}));
  EXPECT_DOUBLE_EQ(below.distance_to_surface(std::vector{9.0, 5.0}), 3);
}

TEST(Geometry, PolygonOfEitherOrientationAndNotConvex) {
  const Polygon l_shape{{{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 3}, {0, 3}}};
  EXPECT_DOUBLE_EQ(l_shape.area(), 5);
  Polygon reversed = l_shape;
  std::reverse(reversed.vertices.begin(), reversed.vertices.end());
  EXPECT_DOUBLE_EQ(reversed.area(), 5);
  for (const Polygon& polygon : {l_shape, reversed}) {
    const Region region{{polygon}};
    EXPECT_TRUE(in(region, {0.5, 2}));
    EXPECT_TRUE(in(region, {2, 0.5}));
    EXPECT_FALSE(in(region, {2, 2}));
    EXPECT_TRUE(in(region, {0.5, 77, 2}));  // a prism in 3-D
    EXPECT_DOUBLE_EQ(region.distance_to_surface(std::vector{2.0, 2.0}), 1);
  }
}

// Tolerance: none. Random points, and all points that stand on the edges, belong to exactly one of the triangles into
// which a square is cut by random inner points: sums of memberships are whole numbers.
TEST(Geometry, PointsOnSharedEdgesBelongToExactlyOnePolygon) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int trial = 0; trial < 50; ++trial) {
    const std::array<double, 2> inner{0.1 + 0.8 * uniform(random), trial % 2 ? 0.5 : 0.1 + 0.8 * uniform(random)};
    const std::vector<std::array<double, 2>> corners = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    std::vector<Region> triangles;
    for (std::size_t i = 0; i < 4; ++i) {
      Polygon triangle{{corners[i], corners[(i + 1) % 4], inner}};
      if (i % 2) std::reverse(triangle.vertices.begin(), triangle.vertices.end());
      triangles.push_back({{triangle}});
    }
    const auto memberships = [&](const std::vector<double>& x) {
      int sum = 0;
      for (const Region& triangle : triangles) sum += in(triangle, x) ? 1 : 0;
      return sum;
    };
    EXPECT_EQ(memberships({inner[0], inner[1]}), 1);
    for (int i = 0; i < 500; ++i) {
      EXPECT_EQ(memberships({uniform(random), uniform(random)}), 1);
      const auto& corner = corners[static_cast<std::size_t>(i) % 4];
      const double t = 0.001 + 0.998 * uniform(random);
      EXPECT_EQ(memberships({inner[0] + t * (corner[0] - inner[0]), inner[1] + t * (corner[1] - inner[1])}), 1);
    }
  }
}

TEST(Geometry, LatticeOnTheEdgesOfATilingIsCountedOnce) {
  const Region left{{Polygon{{{0, 0}, {2, 0}, {4, 4}, {0, 4}}}}}, right{{Polygon{{{2, 0}, {6, 0}, {6, 4}, {4, 4}}}}};
  int count = 0;
  for (int i = 0; i < 12; ++i)
    for (int k = 0; k < 8; ++k) {
      const std::vector x{i * 0.5, k * 0.5};
      EXPECT_EQ(in(left, x) + in(right, x), 1);
      count += in(left, x) + in(right, x);
    }
  EXPECT_EQ(count, 96);
}

TEST(Geometry, SphereIsADiscInThePlane) {
  const Region disc{{Sphere{{1, 2}, 2}}}, ball{{Sphere{{1, 2, 3}, 2}}};
  EXPECT_TRUE(in(disc, {3, 2}));
  EXPECT_FALSE(in(disc, {2.5, 3.5}));
  EXPECT_TRUE(in(ball, {2, 3, 4}));
  EXPECT_FALSE(in(ball, {2.2, 3.2, 4.2}));
  EXPECT_DOUBLE_EQ(ball.distance_to_surface(std::vector{1.0, 2.0, 3.5}), 1.5);
  EXPECT_DOUBLE_EQ(disc.distance_outside(std::vector{4.0, 6.0}), 3);
  EXPECT_EQ(ball.bounds(3)[0], (std::vector<double>{-1, 0, 1}));
  EXPECT_EQ(ball.bounds(3)[1], (std::vector<double>{3, 4, 5}));
}

TEST(Geometry, RegionIsTheIntersectionOfItsParts) {
  const Region region{{Box{{0, 0}, {4, 4}}, HalfSpace{{0, 3}, {0, 1}}, HalfSpace{{0, 0}, {1, 1}}}};
  EXPECT_FALSE(in(region, {1, 3.5}));
  EXPECT_FALSE(in(region, {1, 1}));
  EXPECT_TRUE(in(region, {0, 0}));
  EXPECT_EQ(region.distance_outside(std::vector{-1.0, 0.5}), 1);  // the diagonal plane holds it
  EXPECT_DOUBLE_EQ(region.distance_outside(std::vector{-1.0, 5.0}), std::sqrt(8));
  EXPECT_EQ(region.distance_outside(std::vector{0.0, 0.0}), 0);
  const auto bounds = region.bounds(2);
  EXPECT_EQ(bounds[0], (std::vector<double>{0, 0}));
  EXPECT_EQ(bounds[1], (std::vector<double>{4, 3}));
}

TEST(Geometry, BoundsAreInfiniteWhereNothingEndsTheRegion) {
  const Region region{{Polygon{{{1, 2}, {3, 2}, {2, 5}}}}};
  const auto bounds = region.bounds(3);
  EXPECT_EQ(bounds[0][0], 1);
  EXPECT_EQ(bounds[1][2], 5);
  EXPECT_TRUE(std::isinf(bounds[0][1]) && bounds[0][1] < 0);
  EXPECT_TRUE(std::isinf(bounds[1][1]));
  const auto below = Region{{HalfSpace{{0, 340}, {0, 2}}}}.bounds(2);
  EXPECT_EQ(below[1][1], 340);
  EXPECT_TRUE(std::isinf(below[0][1]));
}

}  // namespace
}  // namespace sluice
