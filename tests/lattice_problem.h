/// Matrices for the tests and benchmarks of solvers: the diffusion operator with bilinear or trilinear elements on a
/// lattice of square cells, a coefficient for each cell; 9 entries a row in 2-D, 27 in 3-D.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <random>
#include <span>
#include <vector>

#include "solvers/sparse_cholesky.h"

namespace sluice {

template <int Dim>
struct LatticeProblem {
  static constexpr int corners = 1 << Dim;
  std::vector<std::array<int, Dim>> places;     // of the nodes
  std::vector<std::array<int, corners>> cells;  // nodes of each cell
  SymmetricPattern pattern;
  std::vector<std::array<int, corners * corners>> slots;  // entry of each pair of a cell's nodes; -1 above the diagonal
  std::vector<char> fixed;  // nodes with a given value: rows of the identity, the pattern unchanged

  explicit LatticeProblem(std::array<int, Dim> cell_counts) {
    make_nodes(cell_counts);
    make_pattern();
  }
  int size() const { return pattern.size(); }

  /// `storage` is added to the diagonal, times the share of a node in the cell.
  std::vector<double> values(std::span<const double> coefficient, double storage) const {
    std::vector<double> result(pattern.row.size(), 0.0);
    double mean = 0;
    for (std::size_t c = 0; c < cells.size(); ++c) {
      mean += coefficient[c] / static_cast<double>(cells.size());
      for (int a = 0; a < corners; ++a)
        for (int b = 0; b < corners; ++b) {
          const int slot = slots[c][static_cast<std::size_t>(a * corners + b)];
          if (slot < 0 || is_fixed(cells[c][static_cast<std::size_t>(a)]) ||
              is_fixed(cells[c][static_cast<std::size_t>(b)]))
            continue;
          result[static_cast<std::size_t>(slot)] += coefficient[c] * element(a, b) + (a == b ? storage / corners : 0);
        }
    }
    for (int node = 0; node < size(); ++node)
      if (is_fixed(node)) result[diagonal_slot(node)] = mean;
    return result;
  }

  std::size_t diagonal_slot(int node) const {
    return static_cast<std::size_t>(pattern.column_begin[static_cast<std::size_t>(node)]);
  }
  bool is_fixed(int node) const { return fixed[static_cast<std::size_t>(node)] != 0; }
  /// Fixes the nodes on the first layer of the last axis.
  void fix_bottom() {
    for (std::size_t node = 0; node < places.size(); ++node) fixed[node] = places[node][Dim - 1] == 0;
  }

 private:
  /// Integral of grad N_a . grad N_b over a unit cell: tensor products of the stiffness and mass of one interval.
  static double element(int a, int b) {
    double sum = 0;
    for (int derived = 0; derived < Dim; ++derived) {
      double product = 1;
      for (int axis = 0; axis < Dim; ++axis) {
        const bool same = ((a >> axis) & 1) == ((b >> axis) & 1);
        product *= axis == derived ? (same ? 1.0 : -1.0) : (same ? 1.0 / 3 : 1.0 / 6);
      }
      sum += product;
    }
    return sum;
  }

  void make_nodes(std::array<int, Dim> counts) {
    std::array<int, Dim> stride, nodes;
    int total = 1;
    for (std::size_t axis = 0; axis < Dim; ++axis) {
      nodes[axis] = counts[axis] + 1;
      stride[axis] = total;
      total *= nodes[axis];
    }
    fixed.assign(static_cast<std::size_t>(total), 0);
    for (int node = 0; node < total; ++node) {
      std::array<int, Dim> place;
      bool is_cell = true;
      for (std::size_t axis = 0; axis < Dim; ++axis) {
        place[axis] = node / stride[axis] % nodes[axis];
        is_cell = is_cell && place[axis] < counts[axis];
      }
      places.push_back(place);
      if (!is_cell) continue;
      std::array<int, corners> cell;
      for (int corner = 0; corner < corners; ++corner) {
        cell[static_cast<std::size_t>(corner)] = node;
        for (std::size_t axis = 0; axis < Dim; ++axis)
          cell[static_cast<std::size_t>(corner)] += ((corner >> axis) & 1) * stride[axis];
      }
      cells.push_back(cell);
    }
  }

  void make_pattern() {
    std::vector<std::vector<int>> columns(places.size());
    for (const auto& cell : cells)
      for (const int a : cell)
        for (const int b : cell)
          if (a >= b) columns[static_cast<std::size_t>(b)].push_back(a);
    pattern.column_begin = {0};
    for (auto& column : columns) {
      std::sort(column.begin(), column.end());
      column.erase(std::unique(column.begin(), column.end()), column.end());
      pattern.row.insert(pattern.row.end(), column.begin(), column.end());
      pattern.column_begin.push_back(static_cast<int>(pattern.row.size()));
    }
    for (const auto& cell : cells) {
      auto& slot = slots.emplace_back();
      for (std::size_t a = 0; a < corners; ++a)
        for (std::size_t b = 0; b < corners; ++b) {
          const auto column = static_cast<std::size_t>(cell[b]);
          const auto begin = pattern.row.begin() + pattern.column_begin[column];
          const auto end = pattern.row.begin() + pattern.column_begin[column + 1];
          slot[a * corners + b] =
              cell[a] < cell[b] ? -1 : static_cast<int>(std::lower_bound(begin, end, cell[a]) - pattern.row.begin());
        }
    }
  }
};

/// Coefficients exp(sin(phase)) with a random phase for each cell that grows so that the root mean square of their
/// relative change is `drift` in a step.
class DriftingCoefficients {
 public:
  DriftingCoefficients(std::size_t cells, double drift, unsigned seed = 1)
      : phases_(cells), speed_(std::sqrt(2.0) * drift) {
    std::mt19937 random(seed);
    for (double& phase : phases_) phase = 2 * M_PI * std::generate_canonical<double, 32>(random);
  }
  std::vector<double> at(int step) const {
    std::vector<double> coefficients(phases_.size());
    for (std::size_t i = 0; i < phases_.size(); ++i) coefficients[i] = std::exp(std::sin(phases_[i] + speed_ * step));
    return coefficients;
  }

 private:
  std::vector<double> phases_;
  double speed_;
};

}  // namespace sluice
