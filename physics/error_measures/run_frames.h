/// RunFrames: the states that a run has written, as error measures want them, and what they need to know of the case.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "core/chart/error_measure.h"
#include "core/output/results_reader.h"
#include "physics/exact/saturated_soil.h"
#include "physics/materials/material.h"

namespace sluice {

/// A state: one entry a particle, in the order of the file. Vectors have three components, the third 0 in 2-D.
struct RunFrame {
  double time;                               ///< [s]
  std::vector<std::array<double, 3>> start;  ///< places before the run [m]
  std::vector<std::array<double, 3>> displacement;
  std::vector<double> field;  ///< the field that was asked for; components side by side
};

class RunFrames {
 public:
  /// `field` may be empty. Throws std::runtime_error if there are no results, or no such field.
  RunFrames(const std::filesystem::path& folder, std::string field);
  std::size_t size() const { return reader_.times().size(); }
  int dimension() const { return reader_.dimension(); }
  RunFrame at(std::size_t i) const;

 private:
  ResultsReader reader_;
  std::string field_;
};

/// The only material of the case. Throws CaseError where there are several.
std::unique_ptr<Material> only_material(const Case& definition);

/// The height that the only body has along an axis [m]. Throws CaseError where it has no end.
double extent(const Case& definition, int axis);

/// The soil of a `two_phase` case with one material, permeability along the last axis.
exact::SaturatedSoil saturated_soil_of(const Case& definition);

/// The constant pressure of the only surface load [Pa].
double load_of(const Case& definition);

/// Registers a measure that has no keys: `evaluate` is its whole.
bool add_error_measure(const std::string& name, const std::string& summary,
                       double (*evaluate)(const chart::FinishedRun& run));

}  // namespace sluice
