/// SceneLattice: what lies where in a case before it runs, at half the spacing of its cells: how far water has to go to
/// drain, how thick the layers are, and along which axes nothing varies.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/case/case.h"

namespace sluice::advice {

class SceneLattice {
 public:
  explicit SceneLattice(const Case& definition);

  int dimension() const { return dimension_; }
  std::size_t size() const { return body_.size(); }
  double spacing(int axis) const { return spacing_[static_cast<std::size_t>(axis)]; }
  std::array<double, 3> point(std::size_t i) const;
  /// Index of the body that holds the point, -1 if none; and of its material in Case::materials.
  int body(std::size_t i) const { return body_[i]; }
  int material(std::size_t i) const { return body_[i] < 0 ? -1 : material_[static_cast<std::size_t>(body_[i])]; }

  /// What a point is to the water of a material.
  enum class Passage { open, closed, through };

  /// The longest way from a point of `material` to where the water leaves, through the points that are `through` [m];
  /// infinite if it cannot leave. `passage(i)` is asked for points, `face(axis, upper)` whether a face of the grid is
  /// open. Ways go along axes and diagonals: up to 8 % too long in 2-D, 13 % in 3-D.
  double drainage_length(int material, const std::function<Passage(std::size_t)>& passage,
                         const std::function<bool(int, bool)>& face) const;

  /// How thick each body is [m]: the shortest way across it along an axis or diagonal, where that is longest. Ways from
  /// one face of the grid to another do not count; infinite if there is no other. 0 for bodies without points.
  std::vector<double> thickness() const;

  /// Whether what `key` says of the points is the same all along the axis.
  bool same_along(int axis, const std::function<double(std::size_t)>& key) const;

  /// Extent of the material along the axis [m].
  double extent(int axis) const;

 private:
  using Step = std::array<int, 3>;
  std::array<std::size_t, 3> index(std::size_t i) const;
  /// False beyond the grid.
  bool neighbour(std::size_t i, const Step& step, std::size_t& found) const;
  double length(const Step& step) const;
  std::vector<Step> directions() const;  ///< one of each pair

  int dimension_;
  std::array<std::size_t, 3> count_{1, 1, 1};
  std::array<double, 3> origin_{}, spacing_{};
  std::vector<std::int16_t> body_;
  std::vector<int> material_;  // by body
};

}  // namespace sluice::advice
