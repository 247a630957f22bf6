/// Products with a symmetric matrix by slices of rows against the same products entry by entry.
#include <gtest/gtest.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "solvers/sliced_rows.h"

namespace sluice::test {

namespace {

/// Row i is coupled to i + d for every d of `bands`, and every seventh row to the first.
SymmetricPattern banded(int size, const std::vector<int>& bands) {
  SymmetricPattern pattern;
  pattern.column_begin.push_back(0);
  for (int column = 0; column < size; ++column) {
    for (int row = column; row < size; ++row) {
      const bool in_band = std::find(bands.begin(), bands.end(), row - column) != bands.end();
      if (row == column || in_band || (column == 0 && row % 7 == 0)) pattern.row.push_back(row);
    }
    pattern.column_begin.push_back(static_cast<int>(pattern.row.size()));
  }
  return pattern;
}

}  // namespace

// Whole numbers small enough that sums of them are exact in any order: equal, not nearly equal.
TEST(SlicedRows, multiply_as_entries_do) {
  for (const int size : {1, 5, 8, 24, 61}) {
    const SymmetricPattern pattern = banded(size, {1, 9, 10, 11});
    std::vector<double> values, x, expected(static_cast<std::size_t>(size), 0.0), y(expected);
    for (std::size_t k = 0; k < pattern.row.size(); ++k) values.push_back(static_cast<double>(k % 13) - 5);
    for (int i = 0; i < size; ++i) x.push_back(i % 11 - 4);
    for (std::size_t column = 0; column < x.size(); ++column)
      for (int k = pattern.column_begin[column]; k < pattern.column_begin[column + 1]; ++k) {
        const auto at = static_cast<std::size_t>(k), row = static_cast<std::size_t>(pattern.row[at]);
        expected[row] += values[at] * x[column];
        if (row != column) expected[column] += values[at] * x[row];
      }
    SlicedRows rows(pattern);
    const std::size_t n = x.size(), middle = n / 2 / SlicedRows::lanes * SlicedRows::lanes;
    rows.set(std::vector<double>(values.size(), 1.0), 0, n);  // of an earlier matrix
    for (const auto& [begin, end] : {std::pair(std::size_t{0}, middle), std::pair(middle, n)}) {
      rows.set(values, begin, end);
      rows.multiply(x, y, begin, end);
    }
    EXPECT_EQ(y, expected) << size;
  }
}

}  // namespace sluice::test
