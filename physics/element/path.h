/// Paths of laboratory tests, written as stages.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "physics/element/element_case.h"

namespace sluice::element {

/// What a `path` of a named type says.
struct PathKeys {
  std::string type;
  std::optional<double> strain, stress;  ///< at the end, or the amplitude of cycles
  std::vector<double> components;        ///< of pure_strain
  double duration = 0;                   ///< until the end, or the first peak [s]
  bool undrained = false;
  std::optional<int> cycles;
  Place place;
};

struct PathType {
  std::string name, summary;
  bool two_way;        ///< cycles swing to both sides
  bool may_undrained;  ///< whether `undrained` has a meaning
};
const std::vector<PathType>& path_types();

/// What contradicts what in the keys of a path; "" if nothing does.
std::string contradiction(const PathKeys& keys);

/// The stages of a path of which nothing contradicts. `increments` go to each leg from zero to the end or first peak;
/// where `strain_increment` is above 0 it decides instead.
std::vector<Stage> stages_of(const PathKeys& keys, const Tensor& initial_stress, int increments,
                             double strain_increment);

/// Increments of a stage such that no strain component that is given changes by more than `strain_increment` in one; 0
/// if no strain is given.
int increments_for(const Stage& stage, double strain_increment);

}  // namespace sluice::element
