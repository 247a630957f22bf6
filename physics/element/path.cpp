#include "physics/element/path.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace sluice::element {

const std::vector<std::string>& component_names() {
  static const std::vector<std::string> names = {"xx", "yy", "zz", "xy", "yz", "xz"};
  return names;
}

const std::vector<PathType>& path_types() {
  static const std::vector<PathType> types = {
      {"isotropic", "Isotropic compression.", false, false},
      {"oedometer", "Compression along z without lateral strain.", false, false},
      {"triaxial_compression", "Compression along z at constant lateral stress.", true, true},
      {"triaxial_extension", "Extension along z at constant lateral stress.", true, true},
      {"direct_simple_shear", "Shear xz at constant vertical stress zz without horizontal normal strain.", true, true},
      {"pure_strain", "Given strain in all components.", true, false}};
  return types;
}

namespace {

const PathType& type_of(const std::string& name) {
  return *std::ranges::find_if(path_types(), [&](const PathType& type) { return type.name == name; });
}

enum : std::size_t { xx, yy, zz, xy, yz, xz };

/// From 0 to the end or first peak: strain by the rate for a strain of 1, or stress.
Stage leg(const PathKeys& keys, const Tensor& initial) {
  Stage stage;
  stage.name = keys.type;
  stage.duration = keys.duration;
  stage.undrained = keys.undrained;
  const bool by_stress = keys.stress.has_value();
  const double end = by_stress ? *keys.stress : keys.strain.value_or(0), rate = end / keys.duration;
  const auto hold = [&](std::size_t k) { stage.stress_given[k] = true, stage.stress[k] = initial[k]; };
  const auto drive = [&](std::size_t k, double strain_share, double sign) {
    if (by_stress) {
      hold(k);
      *stage.stress[k] += sign * end;
    } else {
      stage.strain_rate[k] = strain_share * rate;
    }
  };
  if (keys.type == "isotropic") {
    for (const std::size_t k : {xx, yy, zz}) drive(k, -1.0 / 3, -1);
  } else if (keys.type == "oedometer") {
    drive(zz, -1, -1);
  } else if (keys.type == "direct_simple_shear") {
    hold(zz);
    drive(xz, 0.5, 1);
  } else if (keys.type == "pure_strain") {
    for (std::size_t k = 0; k < components; ++k) stage.strain_rate[k] = keys.components[k] / keys.duration;
  } else {
    const double sign = keys.type == "triaxial_compression" ? -1 : 1;
    hold(xx), hold(yy);
    drive(zz, sign, sign);
  }
  return stage;
}

/// The leg that goes on from the end of `first` by `share` of it, back where that is negative.
Stage scaled(const Stage& first, const Tensor& initial, double from, double share) {
  Stage stage = first;
  stage.duration *= std::abs(share);
  stage.increments = static_cast<int>(std::lround(stage.increments * std::abs(share)));
  for (std::size_t k = 0; k < components; ++k) {
    stage.strain_rate[k] *= share < 0 ? -1 : 1;
    if (stage.stress[k]) *stage.stress[k] = initial[k] + (from + share) * (*first.stress[k] - initial[k]);
  }
  return stage;
}

}  // namespace

std::string contradiction(const PathKeys& keys) {
  const PathType& type = type_of(keys.type);
  if (keys.type == "pure_strain") {
    if (keys.components.empty()) return "`type: pure_strain` needs `components: [xx, yy, zz, xy, yz, xz]`";
    if (keys.strain || keys.stress) return "`type: pure_strain` takes `components`, and neither `strain` nor `stress`";
  } else {
    if (!keys.components.empty()) return "`components` is for `type: pure_strain` only";
    if (keys.strain.has_value() == keys.stress.has_value())
      return fmt::format("{} of `strain` and `stress` {} given; one of them must be", keys.strain ? "both" : "none",
                         keys.strain ? "are" : "is");
  }
  if (keys.undrained && !type.may_undrained)
    return fmt::format("`undrained` is for triaxial and shear tests, not for {}, whose volume is given", keys.type);
  return "";
}

int increments_for(const Stage& stage, double strain_increment) {
  double largest = 0;
  for (std::size_t k = 0; k < components; ++k)
    if (!stage.stress_given[k]) largest = std::max(largest, std::abs(stage.strain_rate[k]) * stage.duration);
  return static_cast<int>(std::min(1e9, std::ceil(largest / strain_increment * (1 - 1e-12))));
}

std::vector<Stage> stages_of(const PathKeys& keys, const Tensor& initial_stress, int increments,
                             double strain_increment) {
  Stage first = leg(keys, initial_stress);
  first.increments = strain_increment > 0 ? increments_for(first, strain_increment) : increments;
  std::vector<Stage> stages = {first};
  if (!keys.cycles) return stages;
  const double back = type_of(keys.type).two_way ? -2 : -1;
  for (int cycle = 0; cycle < *keys.cycles; ++cycle) {
    if (cycle > 0) stages.push_back(scaled(first, initial_stress, 1 + back, -back));
    stages.push_back(scaled(first, initial_stress, 1, back));
  }
  if (back < -1) stages.push_back(scaled(first, initial_stress, -1, 1));
  return stages;
}

}  // namespace sluice::element
