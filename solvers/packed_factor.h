/// PackedFactor: a copy of a Cholesky factor in single precision, for use as a preconditioner.
///
/// Solving with a factor reads all of it twice and computes little: its time is that of moving the numbers. Half as
/// many bytes, and no call for each small block, make the solution several times as fast. Where a triangle is solved,
/// every number waits for the one before it; so the triangles of blocks are inverted beforehand, and a block is applied
/// by one product (partitioned inverses: Alvarado, Pothen & Schreiber 1993). Seven digits are plenty for a
/// preconditioner as long as the condition number is below 1e7 or so; conjugate gradients restore all digits.
///
/// The copy is that of D^-1/2 A D^-1/2 with D the diagonal of A, whose factor has no entry above one: coefficients of
/// any size fit into single precision.
///
/// Parts of the elimination tree that do not depend on each other are solved in parallel. Which parts is settled by the
/// factor alone, and what they add to the unknowns above them is summed in their order: the bits do not depend on the
/// number of threads.
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

  /// Parts that are solved in parallel; 0 where the factor is too small for it.
  std::size_t parts() const { return parts_.size(); }

 private:
  /// Consecutive columns with the same rows below them: of the factor [L; B], the numbers [L^-1; -B L^-1] by columns.
  struct Block {
    std::size_t first, width, first_row, rows, first_value;
    std::size_t height;      ///< of a column: width + rows, and zeros that make it a multiple of eight
    std::size_t inner_rows;  ///< so many of the rows belong to the same part
  };
  /// Consecutive blocks, a whole branch of the elimination tree, and their columns.
  struct Part {
    std::size_t first_block, last_block, first_column, last_column;
    std::vector<float> work;   ///< a column of the largest block
    std::vector<float> above;  ///< what it adds to the columns of the trunk
  };
  void add_block(std::size_t first, std::size_t width, std::span<const int> rows, const double* value,
                 std::size_t stride);
  void divide();
  void forward(const Block& block, std::vector<float>& work, std::vector<float>& above);
  void backward(const Block& block, std::vector<float>& work);
  void load(std::size_t k, std::span<const double> r, double size);
  void unload(std::size_t k, double size, std::span<double> z) const;

  std::vector<Block> blocks_;
  std::vector<Part> parts_;
  std::vector<std::size_t> trunk_;  // blocks that belong to no part
  std::vector<std::size_t> trunk_columns_;
  std::vector<std::size_t> place_in_trunk_;  // of a column that belongs to no part
  std::vector<float> work_, nothing_above_;  // working memory of the trunk
  std::vector<double> block_, eliminated_;   // a block in double precision, while it is copied
  std::vector<int> row_, order_;             // rows of the blocks; unknown that is eliminated k-th
  std::vector<float> value_, x_;
  std::vector<double> scale_;  // D^-1/2, in the order of elimination
};

}  // namespace sluice
