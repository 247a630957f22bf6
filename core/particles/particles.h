/// Particles: the material points of a scene, as columns.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/particles/columns.h"

namespace sluice {

/// Components of a symmetric tensor: 2-D (plane strain) xx yy zz xy; 3-D xx yy zz xy yz xz.
template <int Dim>
inline constexpr int symmetric_components = Dim == 2 ? 4 : 6;

/// Columns that every physics has, and the two whole numbers of a point: its identity and its material.
struct Particles {
  explicit Particles(int dimension);

  int dimension;
  Columns columns;
  ColumnId position;          ///< [m], state
  ColumnId initial_position;  ///< [m], state
  ColumnId velocity;          ///< [m/s], state, at the middle of the last step (leap-frog)
  ColumnId mass;              ///< [kg] (2-D: per metre of thickness), state
  ColumnId volume;            ///< [m3] (2-D: per metre), state
  ColumnId stress;            ///< Cauchy [Pa], tension positive, xx yy zz xy (yz xz), state
  ColumnId crossings;         ///< of the ends of periodic axes, state; declared by declare_periodic

  std::vector<std::int32_t> id;        ///< identity from 0 in order of creation; never changes
  std::vector<std::int32_t> material;  ///< index into `material_names`
  std::vector<std::string> material_names;

  /// Declares what a scene with periodic axes needs: their lengths [m], 0 for other axes.
  void declare_periodic(std::span<const double> lengths);
  /// Where a particle would be along an axis [m], had periodic axes no ends.
  double unrolled_position(std::size_t particle, int axis) const {
    const double period = period_[static_cast<std::size_t>(axis)], x = columns.data(position, axis)[particle];
    return period > 0 ? x + columns.data(crossings, axis)[particle] * period : x;
  }
  double displacement(std::size_t particle, int axis) const {
    return unrolled_position(particle, axis) - columns.data(initial_position, axis)[particle];
  }

  std::size_t size() const { return columns.size(); }
  void resize(std::size_t size);
  /// Reorders everything; see Columns::permute.
  void permute(std::span<const std::uint32_t> order);

 private:
  std::array<double, 3> period_{};  // [m]; 0: not periodic
};

}  // namespace sluice
