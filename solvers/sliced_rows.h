/// SlicedRows: a sparse symmetric matrix by whole rows, eight rows side by side, for products with vectors.
///
/// The entries of eight rows in a slice take turns: the first of each row, the second of each, and so on; rows that
/// have fewer are filled up with zeros. A step of a product is then one operation on vectors of eight; where the
/// columns of a step follow one another, as they do for matrices of grids, it reads the vector as it lies.
///
/// Reference: M. Kreutzer, G. Hager, G. Wellein, H. Fehske, A. R. Bishop, A unified sparse matrix data format for
/// efficient general sparse matrix-vector multiplication, SIAM J. Sci. Comput. 36 (2014), C401 (SELL-C, here C = 8).
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "solvers/sparse_cholesky.h"

namespace sluice {

class SlicedRows {
 public:
  static constexpr std::size_t lanes = 8;

  SlicedRows() = default;
  explicit SlicedRows(const SymmetricPattern& pattern);

  /// Takes the entries of rows [begin, end) from the lower triangle, in the order of pattern.row. Here and in
  /// `multiply`, `begin` is a multiple of `lanes`, and so is `end` unless it is the number of rows.
  void set(std::span<const double> values, std::size_t begin, std::size_t end);
  /// y = A x in rows [begin, end).
  void multiply(std::span<const double> x, std::span<double> y, std::size_t begin, std::size_t end) const;

 private:
  std::vector<int> begin_;  ///< of the steps of each slice
  std::vector<int> first_;  ///< of each step: the column of its first row where those of the others follow, or -1
  // By step and lane:
  std::vector<int> column_, slot_;  ///< slot: place among the values; -1: none
  std::vector<double> value_;
};

}  // namespace sluice
