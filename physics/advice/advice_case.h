/// The section `advice` of a case.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/case/case.h"
#include "core/case/schema.h"

namespace sluice::advice {

/// A part of the process in which the load comes in its own way.
struct StageCase {
  std::string name;
  std::optional<double> loading_time;  ///< [s], for a load that comes and stays
  std::optional<double> frequency;     ///< [1/s], for one that goes to and fro
  Place place;
};

/// What a case in total stresses does not say of a material.
struct PoresCase {
  std::string name;
  double permeability = 0;  ///< [m/s]
  double porosity = 0.4;
  std::optional<double> constrained_modulus;  ///< of the skeleton [Pa]; absent: as in the case
  Place place;
};

struct AdviceCase {
  double tolerance = 0.05;
  std::optional<double> loading_time, frequency;  ///< in the place of stages
  std::vector<StageCase> stages;
  std::vector<PoresCase> materials;
  double water_density = 1000;        ///< [kg/m3], where the case has no water
  double water_bulk_modulus = 2.2e9;  ///< [Pa], where the case has none
  Node verdict;                       ///< of an earlier reading of the case; kept as it is
};

/// Throws CaseError.
AdviceCase read_advice(const Case& definition);
/// The section, for the reference.
FieldDoc advice_doc();

}  // namespace sluice::advice
