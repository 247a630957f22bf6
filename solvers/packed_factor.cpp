#include "solvers/packed_factor.h"

#include <algorithm>
#include <cmath>

#include "core/parallel/parallel.h"

namespace sluice {
namespace {

/// A factor is divided into parts if it has this many numbers: below, waiting for each other costs more.
constexpr std::size_t worth_dividing = 50'000;
/// More parts serve more threads, but what they have in common is done by one: it may grow to this share of the factor.
constexpr std::size_t enough_parts = 16;
constexpr double largest_trunk = 0.08;

/// y -= A x for `rows` x `width` A by columns. Four columns at a time, so that y is read and written less often.
void subtract_product(const float* a, std::size_t rows, std::size_t width, const float* x, float* y) {
  std::size_t j = 0;
  for (; j + 4 <= width; j += 4, a += 4 * rows) {
    const float *a0 = a, *a1 = a + rows, *a2 = a + 2 * rows, *a3 = a + 3 * rows;
    const float x0 = x[j], x1 = x[j + 1], x2 = x[j + 2], x3 = x[j + 3];
#pragma omp simd
    for (std::size_t i = 0; i < rows; ++i) y[i] -= (a0[i] * x0 + a1[i] * x1) + (a2[i] * x2 + a3[i] * x3);
  }
  for (; j < width; ++j, a += rows) {
    const float xj = x[j];
#pragma omp simd
    for (std::size_t i = 0; i < rows; ++i) y[i] -= a[i] * xj;
  }
}

/// x -= Aᵀ y, likewise.
void subtract_transposed_product(const float* a, std::size_t rows, std::size_t width, const float* y, float* x) {
  std::size_t j = 0;
  for (; j + 4 <= width; j += 4, a += 4 * rows) {
    const float *a0 = a, *a1 = a + rows, *a2 = a + 2 * rows, *a3 = a + 3 * rows;
    float s0 = 0, s1 = 0, s2 = 0, s3 = 0;
#pragma omp simd reduction(+ : s0, s1, s2, s3)
    for (std::size_t i = 0; i < rows; ++i)
      s0 += a0[i] * y[i], s1 += a1[i] * y[i], s2 += a2[i] * y[i], s3 += a3[i] * y[i];
    x[j] -= s0, x[j + 1] -= s1, x[j + 2] -= s2, x[j + 3] -= s3;
  }
  for (; j < width; ++j, a += rows) {
    float sum = 0;
#pragma omp simd reduction(+ : sum)
    for (std::size_t i = 0; i < rows; ++i) sum += a[i] * y[i];
    x[j] -= sum;
  }
}

}  // namespace

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
    blocks_.push_back({first, width, row_.size(), rows.size() - width, value_.size(), rows.size() - width});
    most_rows = std::max(most_rows, rows.size() - width);
    row_.insert(row_.end(), rows.begin() + static_cast<std::ptrdiff_t>(width), rows.end());
    const auto scaled = [&](std::size_t i, std::size_t j) {
      return value[i + j * rows.size()] * scale_[static_cast<std::size_t>(rows[i])];
    };
    value_.resize(value_.size() + rows.size() * width);
    float* packed = value_.data() + blocks_.back().first_value;
    for (std::size_t j = 0; j < width; ++j, packed += width) {
      packed[j] = static_cast<float>(1 / scaled(j, j));
      for (std::size_t i = 0; i < j; ++i) packed[i] = static_cast<float>(scaled(j, i));
      for (std::size_t i = j + 1; i < width; ++i) packed[i] = static_cast<float>(scaled(i, j));
    }
    for (std::size_t j = 0; j < width; ++j)
      for (std::size_t i = width; i < rows.size(); ++i) *packed++ = static_cast<float>(scaled(i, j));
  }
  x_.resize(order.size());
  below_.resize(most_rows);
  divide();
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
    parts_.push_back({first[b], b + 1, blocks_[first[b]].first, end, std::vector<float>(below_.size()),
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
    for (std::size_t b = part.first_block; b < part.last_block; ++b) forward(blocks_[b], part.below, part.above);
  });
  for (const std::size_t k : trunk_columns_) load(k, r, size);
  for (const Part& part : parts_)
    for (std::size_t i = 0; i < trunk_columns_.size(); ++i) x_[trunk_columns_[i]] += part.above[i];
  for (const std::size_t b : trunk_) forward(blocks_[b], below_, nothing_above_);
  for (auto b = trunk_.rbegin(); b != trunk_.rend(); ++b) backward(blocks_[*b], below_);
  for (const std::size_t k : trunk_columns_) unload(k, size, z);
  parallel_for(parts_.size(), [&](std::size_t p) {
    Part& part = parts_[p];
    for (std::size_t b = part.last_block; b-- > part.first_block;) backward(blocks_[b], part.below);
    for (std::size_t k = part.first_column; k < part.last_column; ++k) unload(k, size, z);
  });
}

void PackedFactor::forward(const Block& block, std::vector<float>& below, std::vector<float>& above) {
  float* const x = x_.data() + block.first;
  const float* column = value_.data() + block.first_value;
  for (std::size_t j = 0; j < block.width; ++j, column += block.width) {
    const float xj = x[j] *= column[j];
#pragma omp simd
    for (std::size_t i = j + 1; i < block.width; ++i) x[i] -= column[i] * xj;
  }
  std::fill_n(below.begin(), block.rows, 0.0f);
  subtract_product(column, block.rows, block.width, x, below.data());
  const int* const row = row_.data() + block.first_row;
  for (std::size_t i = 0; i < block.inner_rows; ++i) x_[static_cast<std::size_t>(row[i])] += below[i];
  for (std::size_t i = block.inner_rows; i < block.rows; ++i)
    above[place_in_trunk_[static_cast<std::size_t>(row[i])]] += below[i];
}

void PackedFactor::backward(const Block& block, std::vector<float>& below) {
  float* const x = x_.data() + block.first;
  const float* column = value_.data() + block.first_value + block.width * block.width;
  const int* const row = row_.data() + block.first_row;
  for (std::size_t i = 0; i < block.rows; ++i) below[i] = x_[static_cast<std::size_t>(row[i])];
  subtract_transposed_product(column, block.rows, block.width, below.data(), x);
  for (std::size_t j = block.width; j-- > 0;) {
    column -= block.width;
    const float xj = x[j] *= column[j];
#pragma omp simd
    for (std::size_t i = 0; i < j; ++i) x[i] -= column[i] * xj;
  }
}

}  // namespace sluice
