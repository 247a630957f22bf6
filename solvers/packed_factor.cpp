#include "solvers/packed_factor.h"

#include <algorithm>
#include <cmath>

#include "core/parallel/multitarget.h"
#include "core/parallel/parallel.h"

namespace sluice {
namespace {

/// A factor is divided into parts if it has this many numbers: below, waiting for each other costs more.
constexpr std::size_t worth_dividing = 50'000;
/// More parts serve more threads, but what they have in common is done by one: it may grow to this share of the factor.
constexpr std::size_t enough_parts = 16;
constexpr double largest_trunk = 0.08;

/// Blocks of more columns are split: what is inverted stays small.
constexpr std::size_t widest = 32;

/// Eight numbers that are worked on together.
using Eight = float __attribute__((vector_size(32), aligned(4), may_alias));
constexpr std::size_t eight = 8;

SLUICE_ALWAYS_INLINE const Eight& eight_at(const float* x) { return *reinterpret_cast<const Eight*>(x); }
SLUICE_ALWAYS_INLINE Eight& eight_at(float* x) { return *reinterpret_cast<Eight*>(x); }

std::size_t in_eights(std::size_t count) { return (count + eight - 1) / eight * eight; }

/// N times eight rows of y = A x, for A by columns that are `height` apart.
template <std::size_t N>
SLUICE_ALWAYS_INLINE void rows_of_product(const float* a, std::size_t height, std::size_t width, const float* x,
                                          float* y) {
  Eight sum[N] = {};
  for (std::size_t j = 0; j < width; ++j, a += height)
    for (std::size_t n = 0; n < N; ++n) sum[n] += x[j] * eight_at(a + n * eight);
  for (std::size_t n = 0; n < N; ++n) eight_at(y + n * eight) = sum[n];
}

/// N columns from j on of x = A^T y, of which the rows before `from` are zero.
template <std::size_t N>
SLUICE_ALWAYS_INLINE void columns_of_product(const float* a, std::size_t height, std::size_t from, const float* y,
                                             float* x) {
  Eight sum[N] = {};
  for (std::size_t i = from; i < height; i += eight) {
    const Eight here = eight_at(y + i);
    for (std::size_t n = 0; n < N; ++n) sum[n] += here * eight_at(a + n * height + i);
  }
  for (std::size_t n = 0; n < N; ++n)
    x[n] = ((sum[n][0] + sum[n][4]) + (sum[n][2] + sum[n][6])) + ((sum[n][1] + sum[n][5]) + (sum[n][3] + sum[n][7]));
}

}  // namespace

namespace packed_factor {

/// y = A x for a block, whose first rows are a lower triangle. (Multi-target functions need external linkage: the
/// linker chooses among their clones.)
SLUICE_MULTITARGET void multiply(const float* a, std::size_t height, std::size_t width, const float* x, float* y) {
  constexpr std::size_t together = 4;
  std::size_t i = 0;
  for (; i + together * eight <= height; i += together * eight)
    rows_of_product<together>(a + i, height, std::min(width, i + together * eight), x, y + i);
  for (; i < height; i += eight) rows_of_product<1>(a + i, height, std::min(width, i + eight), x, y + i);
}

/// x = A^T y, likewise.
SLUICE_MULTITARGET void multiply_transposed(const float* a, std::size_t height, std::size_t width, const float* y,
                                            float* x) {
  constexpr std::size_t together = 4;
  std::size_t j = 0;
  for (; j + together <= width; j += together)
    columns_of_product<together>(a + j * height, height, j / eight * eight, y, x + j);
  for (; j < width; ++j) columns_of_product<1>(a + j * height, height, j / eight * eight, y, x + j);
}

/// From [L; B] by columns, `height` apart, L a triangle of `width` columns: [L^-1; -B L^-1].
SLUICE_MULTITARGET void eliminate(const double* block, std::size_t height, std::size_t width, double* eliminated) {
  std::fill_n(eliminated, height * width, 0.0);
  for (std::size_t j = width; j-- > 0;) {
    // A column of the inverse: its rows below the diagonal follow from the columns that are there.
    double* const column = eliminated + j * height;
    const double pivot = 1 / block[j * height + j];
    column[j] = pivot;
    for (std::size_t k = j + 1; k < width; ++k) {
      const double factor = -pivot * block[j * height + k];
      const double* const inverse = eliminated + k * height;
      for (std::size_t i = k; i < height; ++i) column[i] += factor * inverse[i];
    }
    for (std::size_t i = width; i < height; ++i) column[i] -= pivot * block[j * height + i];
  }
}

}  // namespace packed_factor

void PackedFactor::copy(const SparseCholesky& cholesky, std::span<const double> inverse_diagonal) {
  const SparseCholesky::DenseBlocks factor = cholesky.dense_blocks();
  const std::span<const int> order = cholesky.elimination_order();
  order_.assign(order.begin(), order.end());
  scale_.resize(order.size());
  for (std::size_t k = 0; k < order.size(); ++k)
    scale_[k] = std::sqrt(inverse_diagonal[static_cast<std::size_t>(order[k])]);
  blocks_.clear(), row_.clear(), value_.clear();
  std::size_t most_rows = 0;
  for (std::size_t b = 0; b + 1 < factor.first_column.size(); ++b) {
    const auto at = [b](std::span<const int> first, std::size_t next) {
      return static_cast<std::size_t>(first[b + next]);
    };
    const std::size_t first = at(factor.first_column, 0), width = at(factor.first_column, 1) - first;
    const std::span<const int> rows =
        factor.row.subspan(at(factor.first_row, 0), at(factor.first_row, 1) - at(factor.first_row, 0));
    const double* const value = factor.value.data() + at(factor.first_value, 0);
    const std::size_t pieces = (width + widest - 1) / widest;
    for (std::size_t piece = 0; piece < pieces; ++piece) {
      const std::size_t begin = width * piece / pieces, end = width * (piece + 1) / pieces;
      add_block(first + begin, end - begin, rows.subspan(begin), value + begin * rows.size() + begin, rows.size());
      most_rows = std::max(most_rows, blocks_.back().rows);
    }
  }
  x_.resize(order.size());
  work_.resize(in_eights(widest + most_rows));
  divide();
}

/// Of columns of the factor, `stride` apart; `rows` begins with the columns themselves.
void PackedFactor::add_block(std::size_t first, std::size_t width, std::span<const int> rows, const double* value,
                             std::size_t stride) {
  const std::size_t height = rows.size(), padded = in_eights(height);
  blocks_.push_back({first, width, row_.size(), height - width, value_.size(), padded, height - width});
  row_.insert(row_.end(), rows.begin() + static_cast<std::ptrdiff_t>(width), rows.end());
  block_.resize(height * width), eliminated_.resize(height * width);
  for (std::size_t j = 0; j < width; ++j)
    for (std::size_t i = j; i < height; ++i)
      block_[j * height + i] = value[j * stride + i] * scale_[static_cast<std::size_t>(rows[i])];
  packed_factor::eliminate(block_.data(), height, width, eliminated_.data());
  value_.resize(value_.size() + padded * width, 0.0f);
  for (std::size_t j = 0; j < width; ++j) {
    float* const column = value_.data() + blocks_.back().first_value + j * padded;
    for (std::size_t i = 0; i < height; ++i) column[i] = static_cast<float>(eliminated_[j * height + i]);
  }
}

/// From the roots of the elimination tree down, the branch with most numbers gives way to the branches above its root,
/// until there are enough.
void PackedFactor::divide() {
  parts_.clear(), trunk_.clear(), trunk_columns_.clear();
  place_in_trunk_.assign(x_.size(), 0);
  std::vector<std::size_t> block_of(x_.size()), first(blocks_.size()), size(blocks_.size(), 0);
  std::vector<std::vector<std::size_t>> children(blocks_.size());
  std::vector<std::size_t> branches;  // by their last block
  for (std::size_t b = 0; b < blocks_.size(); ++b)
    std::fill_n(block_of.begin() + static_cast<std::ptrdiff_t>(blocks_[b].first), blocks_[b].width, b);
  bool consecutive = true;
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    first[b] = b;
    std::size_t blocks = 1;
    size[b] += blocks_[b].width * (blocks_[b].width + blocks_[b].rows);
    for (const std::size_t child : children[b]) {
      first[b] = std::min(first[b], first[child]);
      size[b] += size[child];
      blocks += child - first[child] + 1;
    }
    consecutive = consecutive && blocks == b - first[b] + 1;
    if (blocks_[b].rows == 0)
      branches.push_back(b);
    else
      children[block_of[static_cast<std::size_t>(row_[blocks_[b].first_row])]].push_back(b);
  }
  if (!consecutive || value_.size() < worth_dividing) {
    branches.clear();
    for (std::size_t b = 0; b < blocks_.size(); ++b) trunk_.push_back(b);
  }
  double trunk = 0;
  while (!branches.empty() && branches.size() < enough_parts) {
    const auto largest =
        std::ranges::max_element(branches, [&](std::size_t a, std::size_t b) { return size[a] < size[b]; });
    const std::size_t root = *largest;
    trunk += static_cast<double>(blocks_[root].width * (blocks_[root].width + blocks_[root].rows));
    if (children[root].empty() || (branches.size() > 1 && trunk > largest_trunk * static_cast<double>(value_.size())))
      break;
    trunk_.push_back(root);
    branches.erase(largest);
    branches.insert(branches.end(), children[root].begin(), children[root].end());
  }
  // The largest first: threads that take one after the other then end together.
  std::ranges::sort(branches,
                    [&](std::size_t a, std::size_t b) { return size[a] > size[b] || (size[a] == size[b] && a < b); });
  std::ranges::sort(trunk_);
  for (const std::size_t b : trunk_)
    for (std::size_t k = blocks_[b].first; k < blocks_[b].first + blocks_[b].width; ++k) {
      place_in_trunk_[k] = trunk_columns_.size();
      trunk_columns_.push_back(k);
    }
  for (const std::size_t b : branches) {
    const std::size_t end = blocks_[b].first + blocks_[b].width;
    parts_.push_back({first[b], b + 1, blocks_[first[b]].first, end, std::vector<float>(work_.size()),
                      std::vector<float>(trunk_columns_.size())});
    for (std::size_t k = first[b]; k <= b; ++k) {
      const auto rows = row_.begin() + static_cast<std::ptrdiff_t>(blocks_[k].first_row);
      const auto inner =
          std::lower_bound(rows, rows + static_cast<std::ptrdiff_t>(blocks_[k].rows), static_cast<int>(end));
      blocks_[k].inner_rows = static_cast<std::size_t>(inner - rows);
    }
  }
}

void PackedFactor::load(std::size_t k, std::span<const double> r, double size) {
  x_[k] = static_cast<float>(r[static_cast<std::size_t>(order_[k])] * scale_[k] / size);
}

void PackedFactor::unload(std::size_t k, double size, std::span<double> z) const {
  z[static_cast<std::size_t>(order_[k])] = static_cast<double>(x_[k]) * scale_[k] * size;
}

void PackedFactor::solve(std::span<const double> r, double size, std::span<double> z) {
  parallel_for(parts_.size(), [&](std::size_t p) {
    Part& part = parts_[p];
    for (std::size_t k = part.first_column; k < part.last_column; ++k) load(k, r, size);
    std::ranges::fill(part.above, 0.0f);
    for (std::size_t b = part.first_block; b < part.last_block; ++b) forward(blocks_[b], part.work, part.above);
  });
  for (const std::size_t k : trunk_columns_) load(k, r, size);
  for (const Part& part : parts_)
    for (std::size_t i = 0; i < trunk_columns_.size(); ++i) x_[trunk_columns_[i]] += part.above[i];
  for (const std::size_t b : trunk_) forward(blocks_[b], work_, nothing_above_);
  for (auto b = trunk_.rbegin(); b != trunk_.rend(); ++b) backward(blocks_[*b], work_);
  for (const std::size_t k : trunk_columns_) unload(k, size, z);
  parallel_for(parts_.size(), [&](std::size_t p) {
    Part& part = parts_[p];
    for (std::size_t b = part.last_block; b-- > part.first_block;) backward(blocks_[b], part.work);
    for (std::size_t k = part.first_column; k < part.last_column; ++k) unload(k, size, z);
  });
}

void PackedFactor::forward(const Block& block, std::vector<float>& work, std::vector<float>& above) {
  float* const x = x_.data() + block.first;
  packed_factor::multiply(value_.data() + block.first_value, block.height, block.width, x, work.data());
  std::copy_n(work.begin(), block.width, x);
  const float* const below = work.data() + block.width;
  const int* const row = row_.data() + block.first_row;
  for (std::size_t i = 0; i < block.inner_rows; ++i) x_[static_cast<std::size_t>(row[i])] += below[i];
  for (std::size_t i = block.inner_rows; i < block.rows; ++i)
    above[place_in_trunk_[static_cast<std::size_t>(row[i])]] += below[i];
}

void PackedFactor::backward(const Block& block, std::vector<float>& work) {
  float* const x = x_.data() + block.first;
  std::copy_n(x, block.width, work.begin());
  const int* const row = row_.data() + block.first_row;
  for (std::size_t i = 0; i < block.rows; ++i) work[block.width + i] = x_[static_cast<std::size_t>(row[i])];
  std::fill(work.begin() + static_cast<std::ptrdiff_t>(block.width + block.rows),
            work.begin() + static_cast<std::ptrdiff_t>(block.height), 0.0f);
  packed_factor::multiply_transposed(value_.data() + block.first_value, block.height, block.width, work.data(), x);
}

}  // namespace sluice
