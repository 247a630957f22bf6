/// ResultsTable: the runs of a study as one row a variant, with medians, failures and the Pareto front: chart.csv.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/chart/ledger.h"
#include "core/chart/study.h"

namespace sluice::chart {

struct Row {
  Variant variant;
  std::vector<Entry> runs;  ///< one a repetition; the first has the error
  std::string failure;      ///< "" where there is an error
  double error = 0;         ///< NaN where it failed
  double cpu_seconds = 0;   ///< median
  double times_front = 0;   ///< CPU time over the least of all variants that are at least as exact; 1 on the front
  bool on_front() const { return failure.empty() && times_front == 1; }
};

/// Fills medians, failures (also by limits.error) and the front.
void complete(std::vector<Row>& rows, const Study& study);

/// chart.csv and chart.json, what the figure is drawn from.
void write_chart(const std::filesystem::path& folder, const Study& study, const std::vector<Row>& rows);

}  // namespace sluice::chart
