/// Study: a case, the axes along which it is varied, and how the error of a run is measured. The file of `sluice
/// chart`.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/case/case.h"
#include "core/case/schema.h"

namespace sluice::chart {

/// One choice on an axis: its label, and the keys of the case that it sets.
struct Choice {
  std::string label;
  std::vector<Override> settings;
};

struct Axis {
  std::string name;
  std::vector<Choice> choices;
  Place place;
};

/// A curve that is drawn over a map: what a theory predicts.
struct Bound {
  std::string name;                           ///< in the legend, with its source
  std::vector<std::array<double, 2>> points;  ///< in the units of the axes; rows count from 1 on an axis of words
};

struct Limits {
  double cpu = 600;             ///< [s] of CPU time after which a run is stopped
  std::optional<double> error;  ///< above it a run has failed
};

struct Drawing {
  std::string kind = "curves";  ///< or map
  std::string error_label = "relative error";
  std::vector<Bound> bounds;
};

struct Study {
  std::string file, title;
  std::string case_file;                           ///< found beside the study
  std::vector<Override> settings;                  ///< of every variant
  std::vector<Axis> axes;                          ///< in the order of the file: colour, marker, line of the figure
  std::string along;                               ///< the axis whose choices are the points of a curve
  std::vector<Node> leave_out;                     ///< combinations {axis: label, ...}
  std::optional<std::vector<Override>> reference;  ///< settings of the run that the errors refer to
  Node error;                                      ///< read by the error measure
  int repetitions = 3;
  double repeat_up_to = 10;  ///< [s] of CPU time; dearer runs are done once
  Limits limits;
  Drawing draw;
};

/// One combination of choices.
struct Variant {
  std::vector<std::string> labels;  ///< one an axis
  std::vector<Override> settings;   ///< those of the study first
  std::string name() const;         ///< "linear, flip, 1 m"
};

/// Throws CaseError naming file, line and column of everything that is wrong.
Study load_study(const std::string& file);
Study parse_study(const std::string& text, const std::string& name);
std::vector<FieldDoc> study_docs();

/// All combinations that are not left out; the last axis changes fastest.
std::vector<Variant> variants_of(const Study& study);

}  // namespace sluice::chart
