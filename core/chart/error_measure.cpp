#include "core/chart/error_measure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "core/case/schema.h"
#include "core/output/csv_table.h"

namespace sluice::chart {

Registry<ErrorMeasureFactory>& error_measure_registry() {
  static Registry<ErrorMeasureFactory> registry("error measure", "errors");
  return registry;
}

std::unique_ptr<ErrorMeasure> make_error_measure(const Study& study) {
  const Node* const measure = study.error.find("measure");
  if (measure == nullptr || measure->kind != Node::Kind::scalar)
    throw CaseError(study.error.place, fmt::format("error: `measure` is missing; {}",
                                                   allowed_words("", error_measure_registry().names())));
  return error_measure_registry().find(measure->scalar, measure->place)(study.error, study);
}

RunTable::RunTable(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::string line;
  if (!std::getline(in, line)) throw std::runtime_error(fmt::format("{} cannot be read", file.string()));
  for (const std::string& name : csv_cells(line)) columns_.push_back({name, {}});
  while (std::getline(in, line)) {
    const auto cells = csv_cells(line);
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      const char* const text = c < cells.size() ? cells[c].c_str() : "";
      char* end = nullptr;
      const double value = std::strtod(text, &end);
      columns_[c].second.push_back(end == text ? NAN : value);
    }
  }
}

double RelativeRms::value() const { return std::sqrt(squares_ / scale_); }

const std::vector<double>* RunTable::find(const std::string& name) const {
  for (const auto& [column, values] : columns_)
    if (column == name) return &values;
  for (const auto& [column, values] : columns_)
    if (column.starts_with(name + "_") && column.find('_', name.size() + 1) == std::string::npos) return &values;
  for (const auto& [column, values] : columns_)
    if (column.starts_with(name + "_")) return &values;
  return nullptr;
}

std::vector<std::string> RunTable::names() const {
  std::vector<std::string> all;
  for (const auto& column : columns_) all.push_back(column.first);
  return all;
}

namespace {

/// A followed number over time: an observation, or a column of history.csv.
struct Series {
  std::vector<double> time, value;
};

Series series_of(const std::filesystem::path& folder, const std::string& name, const Place& place) {
  std::vector<std::string> known;
  for (const char* file : {"observations.csv", "history.csv"}) {
    const RunTable table(folder / file);
    if (const auto* const found = table.find(name)) return {*table.find("time_s"), *found};
    for (const std::string& column : table.names()) known.push_back(column);
  }
  throw CaseError(place, fmt::format("of: the run has no number '{}'; {}", name, allowed_words(name, known)));
}

/// Linear between the rows.
double at(const Series& series, double time) {
  const auto after = std::ranges::lower_bound(series.time, time);
  if (after == series.time.begin()) return series.value.front();
  if (after == series.time.end()) return series.value.back();
  const auto i = static_cast<std::size_t>(after - series.time.begin());
  const double share = (time - series.time[i - 1]) / (series.time[i] - series.time[i - 1]);
  return series.value[i - 1] + share * (series.value[i] - series.value[i - 1]);
}

double taken(const Series& series, const std::string& take, double from) {
  if (take == "end") return series.value.back();
  double best = NAN;
  for (std::size_t i = 0; i < series.value.size(); ++i)
    if (series.time[i] >= from && !(take == "largest" ? series.value[i] <= best : series.value[i] >= best))
      best = series.value[i];
  return best;
}

/// Numbers of the run against numbers that are known.
struct NumberKeys {
  std::string measure, take;
  double from = 0;
  std::vector<std::pair<std::string, double>> values;
  Place place;
};

const Schema<NumberKeys>& number_schema() {
  static const auto schema =
      Schema<NumberKeys>("error")
          .text("measure", &NumberKeys::measure, "numbers")
          .custom(
              {.name = "of",
               .type = field_type::section,
               .sentence = "Observations or columns of history.csv by name, with what is right in SI units.",
               .required = true},
              [](NumberKeys& keys, const Node& node, Problems& problems) {
                if (node.kind != Node::Kind::map)
                  return problems.add(node.place, fmt::format("of: found {}; expected NAME: VALUE", description(node)));
                for (std::size_t i = 0; i < node.items.size(); ++i)
                  if (const auto v =
                          value::quantity(node.items[i], node.keys[i].first, unit::none, any_number, problems))
                    keys.values.emplace_back(node.keys[i].first, *v);
              },
              [](const NumberKeys&) { return Node{}; })
          .word("take", &NumberKeys::take, {"end", "largest", "least"}, "Which value of the run.", "end")
          .quantity("from", &NumberKeys::from, unit::time, at_least(0), "Earliest time, for largest and least.", 0.0);
  return schema;
}

/// The largest relative error of the numbers.
class Numbers final : public ErrorMeasure {
 public:
  explicit Numbers(const Node& section) : keys_(number_schema().read(section)) {}
  double evaluate(const FinishedRun& run) const override {
    double largest = 0;
    for (const auto& [name, right] : keys_.values) {
      const double found = taken(series_of(run.folder, name, keys_.place), keys_.take, keys_.from);
      const double error = std::abs(found - right) / (right == 0 ? 1 : std::abs(right));
      largest = std::isnan(error) ? error : std::max(largest, error);
    }
    return largest;
  }

 private:
  NumberKeys keys_;
};

struct ReferenceKeys {
  std::string measure, over;
  std::vector<std::string> names;
  Place place;
};

const Schema<ReferenceKeys>& reference_schema() {
  static const auto schema = Schema<ReferenceKeys>("error")
                                 .text("measure", &ReferenceKeys::measure, "reference")
                                 .words("of", &ReferenceKeys::names, "Observations or columns of history.csv.")
                                 .word("over", &ReferenceKeys::over, {"end", "time"},
                                       "The last values, or the root mean square over the rows of the run.", "end");
  return schema;
}

/// The same numbers of the reference run. The largest relative error of them.
class AgainstReference final : public ErrorMeasure {
 public:
  AgainstReference(const Node& section, const Study& study) : keys_(reference_schema().read(section)) {
    if (!study.reference)
      throw CaseError(section.place,
                      "measure: `reference` compares with another run, and the study has no section `reference`: give "
                      "the keys and values of that run");
  }
  double evaluate(const FinishedRun& run) const override {
    double largest = 0;
    for (const std::string& name : keys_.names) {
      const Series own = series_of(run.folder, name, keys_.place), right = series_of(run.reference, name, keys_.place);
      largest = std::max(largest, keys_.over == "end"
                                      ? std::abs(own.value.back() - right.value.back()) / std::abs(right.value.back())
                                      : over_time(own, right));
    }
    return largest;
  }

 private:
  static double over_time(const Series& own, const Series& right) {
    RelativeRms rms;
    for (std::size_t i = 0; i < own.time.size(); ++i) {
      const double exact = at(right, own.time[i]);
      rms.add(own.value[i] - exact, exact);
    }
    return rms.value();
  }
  ReferenceKeys keys_;
};

const bool registered =
    error_measure_registry().add(
        "numbers", {"Numbers of the run against known ones.", [] { return number_schema().docs(); }},
        [](const Node& section, const Study&) { return std::make_unique<Numbers>(section); }) &&
    error_measure_registry().add(
        "reference", {"Numbers of the run against those of a reference run.", [] { return reference_schema().docs(); }},
        [](const Node& section, const Study& study) { return std::make_unique<AgainstReference>(section, study); });

}  // namespace
}  // namespace sluice::chart
