/// ErrorMeasure: how far a finished run is from what is known: numbers, another run, or an exact solution. Measures
/// register by name; those with exact solutions are in physics/error_measures.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/case/case.h"
#include "core/case/registry.h"
#include "core/chart/study.h"

namespace sluice::chart {

/// A run that reached its end time.
struct FinishedRun {
  const Case& definition;
  std::filesystem::path folder;     ///< what `sluice run` wrote
  std::filesystem::path reference;  ///< folder of the reference run; empty without one
};

class ErrorMeasure {
 public:
  virtual ~ErrorMeasure() = default;
  /// Not negative, 0 for an exact result; relative unless the measure says otherwise. Throws CaseError where the case
  /// is not one that the measure knows, std::runtime_error where results lack what it needs.
  virtual double evaluate(const FinishedRun& run) const = 0;
};

/// `section` is the section `error` of the study.
using ErrorMeasureFactory = std::function<std::unique_ptr<ErrorMeasure>(const Node& section, const Study& study)>;
Registry<ErrorMeasureFactory>& error_measure_registry();

/// What `error.measure` names. Throws CaseError.
std::unique_ptr<ErrorMeasure> make_error_measure(const Study& study);

/// A table of a finished run (history.csv, observations.csv), by columns.
class RunTable {
 public:
  explicit RunTable(const std::filesystem::path& file);
  /// The column of this name, or NAME_UNIT; empty if there is none.
  const std::vector<double>* find(const std::string& name) const;
  std::vector<std::string> names() const;

 private:
  std::vector<std::pair<std::string, std::vector<double>>> columns_;
};

/// Root mean square of values that are added one by one, over that of a scale.
class RelativeRms {
 public:
  void add(double error, double exact) { squares_ += error * error, scale_ += exact * exact; }
  double value() const;

 private:
  double squares_ = 0, scale_ = 0;
};

}  // namespace sluice::chart
