#include "solvers/sliced_rows.h"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <numeric>

#include "core/parallel/multitarget.h"

namespace sluice {

namespace {

/// Both triangles, row by row; in a row by column, as the lower triangle is read.
struct FullRows {
  struct Entry {
    int column, slot;
  };
  std::vector<std::size_t> begin;
  std::vector<Entry> entry;

  explicit FullRows(const SymmetricPattern& pattern) : begin(static_cast<std::size_t>(pattern.size()) + 1, 0) {
    const auto for_entries = [&](const auto& visit) {
      for (std::size_t column = 0; column + 1 < begin.size(); ++column)
        for (int k = pattern.column_begin[column]; k < pattern.column_begin[column + 1]; ++k) {
          const auto row = static_cast<std::size_t>(pattern.row[static_cast<std::size_t>(k)]);
          visit(row, column, k);
          if (row != column) visit(column, row, k);
        }
    };
    for_entries([&](std::size_t row, std::size_t, int) { ++begin[row + 1]; });
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    entry.resize(begin.back());
    std::vector<std::size_t> next(begin.begin(), begin.end() - 1);
    for_entries([&](std::size_t row, std::size_t column, int slot) {
      entry[next[row]++] = {static_cast<int>(column), slot};
    });
  }
  std::span<const Entry> operator[](std::size_t row) const {
    return std::span(entry).subspan(begin[row], begin[row + 1] - begin[row]);
  }
};

using Eight = double __attribute__((vector_size(SlicedRows::lanes * sizeof(double))));

SLUICE_ALWAYS_INLINE Eight eight_at(const double* from) {
  Eight eight;
  std::memcpy(&eight, from, sizeof(eight));
  return eight;
}

struct Slices {
  const int *begin, *first, *column;
  const double* value;
};

SLUICE_MULTITARGET void multiply_slices(const Slices& a, const double* x, double* y, std::size_t slice,
                                        std::size_t end) {
  constexpr int lanes = SlicedRows::lanes;
  for (; slice < end; ++slice, y += lanes) {
    Eight sum{};
    for (int k = a.begin[slice]; k < a.begin[slice + 1]; ++k) {
      const Eight value = eight_at(a.value + static_cast<std::ptrdiff_t>(k) * lanes);
      if (a.first[k] >= 0) {
        sum += value * eight_at(x + a.first[k]);
        continue;
      }
      const int* const c = a.column + static_cast<std::ptrdiff_t>(k) * lanes;
      sum += value * Eight{x[c[0]], x[c[1]], x[c[2]], x[c[3]], x[c[4]], x[c[5]], x[c[6]], x[c[7]]};
    }
    std::memcpy(y, &sum, sizeof(sum));
  }
}

SLUICE_MULTITARGET void take(const int* __restrict slot, const double* __restrict values, double* __restrict into,
                             std::size_t begin, std::size_t end) {
#pragma omp simd
  for (std::size_t i = begin; i < end; ++i) {
    const double value = values[std::max(slot[i], 0)];
    into[i] = slot[i] < 0 ? 0 : value;
  }
}

}  // namespace

SlicedRows::SlicedRows(const SymmetricPattern& pattern) {
  const FullRows rows(pattern);
  const auto n = static_cast<std::size_t>(pattern.size());
  begin_.push_back(0);
  for (std::size_t from = 0; from < n; from += lanes) {
    const std::size_t to = std::min(from + lanes, n);
    std::size_t steps = 0;
    for (std::size_t r = from; r < to; ++r) steps = std::max(steps, rows[r].size());
    for (std::size_t k = 0; k < steps; ++k) {
      bool in_order = true;
      for (std::size_t r = from; r < from + lanes; ++r) {
        const bool is_there = r < to && k < rows[r].size();
        column_.push_back(is_there ? rows[r][k].column : 0);
        slot_.push_back(is_there ? rows[r][k].slot : -1);
        in_order = in_order && is_there &&
                   rows[r][k].column == column_[column_.size() - 1 - (r - from)] + static_cast<int>(r - from);
      }
      first_.push_back(in_order ? column_[column_.size() - lanes] : -1);
    }
    begin_.push_back(static_cast<int>(first_.size()));
  }
  value_.resize(column_.size());
}

void SlicedRows::set(std::span<const double> values, std::size_t begin, std::size_t end) {
  assert(begin % lanes == 0);
  const auto first = static_cast<std::size_t>(begin_[begin / lanes]) * lanes,
             last = static_cast<std::size_t>(begin_[(end + lanes - 1) / lanes]) * lanes;
  take(slot_.data(), values.data(), value_.data(), first, last);
}

void SlicedRows::multiply(std::span<const double> x, std::span<double> y, std::size_t begin, std::size_t end) const {
  assert(begin % lanes == 0 && (end % lanes == 0 || end == y.size()));
  const Slices slices{begin_.data(), first_.data(), column_.data(), value_.data()};
  const std::size_t whole = end / lanes * lanes;
  multiply_slices(slices, x.data(), y.data() + begin, begin / lanes, whole / lanes);
  if (whole == end) return;
  double rest[lanes];
  multiply_slices(slices, x.data(), rest, whole / lanes, whole / lanes + 1);
  std::copy_n(rest, end - whole, y.data() + whole);
}

}  // namespace sluice
