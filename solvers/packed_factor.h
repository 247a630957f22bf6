/// PackedFactor: a copy of a Cholesky factor in single precision, for use as a preconditioner.
///
/// Solving with a factor reads all of it twice and computes little: its time is that of moving the numbers. Half as
/// many bytes, without the zeros that CHOLMOD keeps above the diagonal and without a call for each small block, make
/// the solution two to three times as fast. Seven digits are plenty for a preconditioner as long as the condition
/// number is below 1e7 or so; conjugate gradients restore all digits.
///
/// The copy is that of D^-1/2 A D^-1/2 with D the diagonal of A, whose factor has no entry above one: coefficients of
/// any size fit into single precision.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "solvers/sparse_cholesky.h"

namespace sluice {

class PackedFactor {
 public:
  PackedFactor() = default;

  /// Copies the factor of the matrix with these diagonal entries. Allocates only where the pattern has changed.
  void copy(const SparseCholesky& cholesky, std::span<const double> inverse_diagonal);

  /// z with A z = r to single precision; `size` is any number of the size of D^-1/2 r, for the range of the numbers.
  void solve(std::span<const double> r, double size, std::span<double> z);

 private:
  /// Consecutive columns with the same rows below them. Values by columns: a square of `width` columns with the
  /// triangle L and, above the diagonal, its transpose, so that both solutions run down columns; the diagonal is
  /// inverted. Then `width` columns of the `rows` below.
  struct Block {
    std::size_t first, width, first_row, rows, first_value;
  };
  void forward(const Block& block);
  void backward(const Block& block);

  std::vector<Block> blocks_;
  std::vector<int> row_, order_;  // rows of the blocks; unknown that is eliminated k-th
  std::vector<float> value_, x_, below_;
  std::vector<double> scale_;  // D^-1/2, in the order of elimination
};

}  // namespace sluice
