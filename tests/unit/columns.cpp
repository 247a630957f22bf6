/// Columns: declaration, growth, permutation.
#include "core/particles/columns.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <stdexcept>
#include <vector>

#include "core/particles/particles.h"

namespace sluice {
namespace {

Columns three_columns() {
  Columns columns;
  columns.declare({"position", "m", 2, Role::state, "Where it is."});
  columns.declare({"work", "J", 1, Role::derived, "Scratch."});
  columns.declare({"damage", "1", 1, Role::state, "How broken."});
  columns.resize(5);
  for (std::size_t p = 0; p < 5; ++p) {
    columns.data({0}, 0)[p] = static_cast<double>(p);
    columns.data({0}, 1)[p] = 10.0 + static_cast<double>(p);
    columns.data({1})[p] = 100;
    columns.data({2})[p] = 20.0 + static_cast<double>(p);
  }
  return columns;
}

TEST(Columns, DeclaringTwiceFindsTheSame) {
  Columns columns;
  const auto first = columns.declare({"damage", "1", 1, Role::state, "How broken."});
  EXPECT_EQ(columns.declare({"damage", "1", 1, Role::state, "In other words."}).index, first.index);
  EXPECT_EQ(columns.find("damage").index, first.index);
  EXPECT_TRUE(columns.contains("damage"));
  EXPECT_FALSE(columns.contains("damages"));
}

TEST(Columns, DeclaringDifferentlyIsAnError) {
  Columns columns;
  columns.declare({"damage", "1", 1, Role::state, "How broken."});
  EXPECT_THROW(columns.declare({"damage", "1", 2, Role::state, "How broken."}), std::logic_error);
  EXPECT_THROW(columns.declare({"damage", "Pa", 1, Role::state, "How broken."}), std::logic_error);
  EXPECT_THROW(columns.declare({"damage", "1", 1, Role::derived, "How broken."}), std::logic_error);
}

TEST(Columns, UnknownNameIsAnError) { EXPECT_THROW(three_columns().find("demage"), std::out_of_range); }

TEST(Columns, StorageIsAlignedAndBeginsAtZero) {
  Columns columns;
  const auto id = columns.declare({"damage", "1", 3, Role::state, "How broken."});
  columns.resize(7);
  for (int c = 0; c < 3; ++c) {
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(columns.data(id, c)) % column_alignment, 0u);
    for (const double v : columns.values(id, c)) EXPECT_EQ(v, 0);
  }
}

TEST(Columns, GrowingKeepsValuesAndZerosNewOnes) {
  Columns columns = three_columns();
  columns.resize(3);
  columns.resize(1000);
  EXPECT_EQ(columns.data({0}, 1)[2], 12);
  EXPECT_EQ(columns.data({0}, 1)[3], 0);
  EXPECT_EQ(columns.data({2})[999], 0);
  EXPECT_GE(columns.memory(), 4 * 1000 * sizeof(double));
}

TEST(Columns, PermuteReordersEveryStateColumn) {
  Columns columns = three_columns();
  columns.permute(std::vector<std::uint32_t>{4, 2, 0, 1, 3});
  const double order[] = {4, 2, 0, 1, 3};
  for (std::size_t p = 0; p < 5; ++p) {
    EXPECT_EQ(columns.data({0}, 0)[p], order[p]);
    EXPECT_EQ(columns.data({0}, 1)[p], 10 + order[p]);
    EXPECT_EQ(columns.data({2})[p], 20 + order[p]);
  }
}

TEST(Columns, PermuteDropsWhatItDoesNotName) {
  Columns columns = three_columns();
  columns.permute(std::vector<std::uint32_t>{3, 1});
  ASSERT_EQ(columns.size(), 2u);
  EXPECT_EQ(columns.data({2})[0], 23);
  EXPECT_EQ(columns.data({2})[1], 21);
  columns.permute(std::vector<std::uint32_t>{1, 0});
  EXPECT_EQ(columns.data({2})[0], 21);
}

TEST(Particles, PermuteTakesIdentityAndMaterialAlong) {
  Particles particles(3);
  particles.resize(3);
  particles.id = {0, 1, 2};
  particles.material = {5, 6, 7};
  for (std::size_t p = 0; p < 3; ++p) particles.columns.data(particles.stress, 5)[p] = static_cast<double>(p);
  particles.permute(std::vector<std::uint32_t>{2, 0});
  EXPECT_EQ(particles.id, (std::vector<std::int32_t>{2, 0}));
  EXPECT_EQ(particles.material, (std::vector<std::int32_t>{7, 5}));
  EXPECT_EQ(particles.columns.data(particles.stress, 5)[0], 2);
}

}  // namespace
}  // namespace sluice
