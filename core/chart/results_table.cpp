#include "core/chart/results_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/output/csv_table.h"
#include "core/output/file_aside.h"
#include "core/version.h"

namespace sluice::chart {

namespace {

double median_cpu(const std::vector<Entry>& runs) {
  std::vector<double> seconds;
  for (const Entry& run : runs) seconds.push_back(run.report.cpu_seconds);
  std::ranges::sort(seconds);
  const std::size_t n = seconds.size();
  return n == 0 ? 0 : (seconds[(n - 1) / 2] + seconds[n / 2]) / 2;
}

void find_front(std::vector<Row>& rows) {
  for (Row& row : rows) {
    if (!row.failure.empty()) continue;
    double least = row.cpu_seconds;
    for (const Row& other : rows)
      if (other.failure.empty() && other.error <= row.error) least = std::min(least, other.cpu_seconds);
    row.times_front = row.cpu_seconds / least;
  }
}

}  // namespace

void complete(std::vector<Row>& rows, const Study& study) {
  for (Row& row : rows) {
    if (row.runs.empty()) {
      if (row.failure.empty()) row.failure = "not run";
      row.error = NAN;
      continue;
    }
    const Entry& first = row.runs.front();
    row.cpu_seconds = median_cpu(row.runs);
    row.error = first.error;
    row.failure = first.report.failure;
    if (row.failure.empty() && !std::isfinite(row.error)) row.failure = "no finite error";
    if (row.failure.empty() && study.limits.error && row.error > *study.limits.error) row.failure = "error above limit";
  }
  find_front(rows);
}

void write_chart(const std::filesystem::path& folder, const Study& study, const std::vector<Row>& rows) {
  std::vector<std::string> columns;
  for (const Axis& axis : study.axes) columns.push_back(axis.name);
  for (const char* name :
       {"error", "cpu_s", "times_front", "failure", "process_cpu_s", "particle_steps", "steps", "particles",
        "peak_memory_bytes", "factorizations", "iterations", "repetitions", "version", "message"})
    columns.emplace_back(name);
  CsvTable table(folder / "chart.csv", columns);
  for (const Row& row : rows) {
    std::vector<CsvTable::Cell> cells(row.variant.labels.begin(), row.variant.labels.end());
    const RunReport report = row.runs.empty() ? RunReport{} : row.runs.front().report;
    cells.insert(cells.end(), {row.error, row.cpu_seconds, row.times_front, row.failure, report.process_cpu,
                               report.particle_steps, report.steps, report.particles, report.peak_memory,
                               report.factorizations, report.iterations, static_cast<std::int64_t>(row.runs.size()),
                               row.runs.empty() ? version_text() : row.runs.front().version, report.message});
    table.append(cells);
  }
  nlohmann::ordered_json json;
  json["title"] = study.title;
  json["along"] = study.along;
  json["kind"] = study.draw.kind;
  json["error_label"] = study.draw.error_label;
  for (const Axis& axis : study.axes) {
    std::vector<std::string> labels;
    for (const Choice& choice : axis.choices) labels.push_back(choice.label);
    json["axes"].push_back({{"name", axis.name}, {"labels", labels}});
  }
  json["bounds"] = nlohmann::ordered_json::array();
  for (const Bound& bound : study.draw.bounds)
    json["bounds"].push_back({{"name", bound.name}, {"points", bound.points}});
  replace_text_file(folder / "chart.json", json.dump(2) + '\n');
}

}  // namespace sluice::chart
