#include "solvers/packed_factor.h"

#include <algorithm>
#include <cmath>

namespace sluice {
namespace {

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
    blocks_.push_back({first, width, row_.size(), rows.size() - width, value_.size()});
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
}

void PackedFactor::solve(std::span<const double> r, double size, std::span<double> z) {
  for (std::size_t k = 0; k < x_.size(); ++k)
    x_[k] = static_cast<float>(r[static_cast<std::size_t>(order_[k])] * scale_[k] / size);
  for (const Block& block : blocks_) forward(block);
  for (auto block = blocks_.rbegin(); block != blocks_.rend(); ++block) backward(*block);
  for (std::size_t k = 0; k < x_.size(); ++k)
    z[static_cast<std::size_t>(order_[k])] = static_cast<double>(x_[k]) * scale_[k] * size;
}

void PackedFactor::forward(const Block& block) {
  float* const x = x_.data() + block.first;
  const float* column = value_.data() + block.first_value;
  for (std::size_t j = 0; j < block.width; ++j, column += block.width) {
    const float xj = x[j] *= column[j];
#pragma omp simd
    for (std::size_t i = j + 1; i < block.width; ++i) x[i] -= column[i] * xj;
  }
  std::fill_n(below_.begin(), block.rows, 0.0f);
  subtract_product(column, block.rows, block.width, x, below_.data());
  for (std::size_t i = 0; i < block.rows; ++i) x_[static_cast<std::size_t>(row_[block.first_row + i])] += below_[i];
}

void PackedFactor::backward(const Block& block) {
  float* const x = x_.data() + block.first;
  const float* column = value_.data() + block.first_value + block.width * block.width;
  for (std::size_t i = 0; i < block.rows; ++i) below_[i] = x_[static_cast<std::size_t>(row_[block.first_row + i])];
  subtract_transposed_product(column, block.rows, block.width, below_.data(), x);
  for (std::size_t j = block.width; j-- > 0;) {
    column -= block.width;
    const float xj = x[j] *= column[j];
#pragma omp simd
    for (std::size_t i = 0; i < j; ++i) x[i] -= column[i] * xj;
  }
}

}  // namespace sluice
