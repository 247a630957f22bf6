/// Element case: what the file of `sluice element` declares, checked, in SI units, its path as a list of stages.
/// Keys and signs: docs/element.md.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/case/case.h"
#include "core/case/schema.h"
#include "physics/materials/material.h"

namespace sluice::element {

inline constexpr int components = symmetric_components<3>;
/// xx yy zz xy yz xz: tension positive, shear strains of the tensor; z points up.
using Tensor = std::array<double, components>;
const std::vector<std::string>& component_names();

/// A part of the path, on which every component of either strain or total stress is given, at constant rates.
struct Stage {
  std::string name;
  double duration = 0;  ///< [s]
  int increments = 0;
  Tensor strain_rate{};  ///< of the components whose stress is not given [1/s]
  std::array<bool, components> stress_given{};
  /// Total stress at the end of the stage, reached along a straight line [Pa]; none: that of its beginning is held.
  std::array<std::optional<double>, components> stress{};
  bool undrained = false;  ///< constant volume; the total stress is sigma - u with an excess pore pressure u
};

struct ReferenceKeys {
  bool compute = true;
  double tolerance = 1e-6;
};

struct OutputKeys {
  int every = 1;  ///< increments
};

struct ElementCase {
  std::string file, title;
  Node material;
  Tensor initial_stress{};
  Place initial_stress_place;
  std::vector<Stage> stages;
  std::optional<double> initial_void_ratio;
  double cell_size = 1;  ///< [m]
  ReferenceKeys reference;
  OutputKeys output;
  std::string resolved;  ///< YAML with all defaults
};

/// Reads and checks a file. Throws CaseError naming file, line and column of everything that is wrong.
ElementCase load_element(const std::string& file, const std::vector<Override>& overrides = {});
/// The same from text; `name` stands for the file in messages.
ElementCase parse_element(const std::string& text, const std::string& name,
                          const std::vector<Override>& overrides = {});

/// The material, ready for its first update. Throws CaseError for one that has no stress of its own.
std::unique_ptr<Material> material_of(const ElementCase& definition);

/// All keys of the file, for the manual.
std::vector<FieldDoc> element_docs();

}  // namespace sluice::element
