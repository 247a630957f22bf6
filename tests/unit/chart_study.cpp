/// The study file of `sluice chart`: what its combinations are, and what is said of a bad one; its ledger and its
/// front.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "core/chart/ledger.h"
#include "core/chart/results_table.h"
#include "core/chart/study.h"

namespace sluice::chart {
namespace {

namespace fs = std::filesystem;

class ChartStudy : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / fs::path(::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(folder_);
    std::ofstream(folder_ / "case.yaml") << "schema: 1\n";
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string file() const { return (folder_ / "study.yaml").string(); }
  Study read(const std::string& text) const { return parse_study(text, file()); }

  /// What is wrong with the text, without the folder.
  std::string trouble(const std::string& text) const {
    try {
      read(text);
    } catch (const CaseError& error) {
      std::string message = error.what();
      for (std::size_t at; (at = message.find(folder_.string() + "/")) != std::string::npos;)
        message.erase(at, folder_.string().size() + 1);
      return message;
    }
    return "nothing";
  }

  fs::path folder_;
};

const std::string good = R"(schema: 1
title: A study
case: case.yaml
set: {end_time: 2 s}
axes:
  shape: {key: scheme.shape, values: [linear, ugimp]}
  transfer:
    FLIP: {scheme.transfer: flip, scheme.flip_fraction: 0.99}
    APIC: {scheme.transfer: apic}
  cell: {key: grid.cell, values: [1 m, 0.5 m]}
error: {measure: numbers, of: {runout: 3.5}}
)";

std::string with(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST_F(ChartStudy, CombinesItsChoices) {
  const Study study = read(good);
  EXPECT_EQ(study.along, "cell");
  EXPECT_EQ(study.case_file, (folder_ / "case.yaml").string());
  const auto variants = variants_of(study);
  ASSERT_EQ(variants.size(), 8u);
  EXPECT_EQ(variants[1].name(), "linear, FLIP, 0.5 m");
  std::string settings;
  for (const Override& o : variants[1].settings) settings += o.key + "=" + o.value + ";";
  EXPECT_EQ(settings,
            "end_time=2 s;scheme.shape=linear;scheme.transfer=flip;scheme.flip_fraction=0.99;grid.cell=0.5 m;");
}

TEST_F(ChartStudy, LeavesCombinationsOut) {
  const auto variants = variants_of(read(good + "leave_out: [{shape: ugimp, transfer: [FLIP, APIC], cell: 0.5 m}]\n"));
  EXPECT_EQ(variants.size(), 6u);
}

TEST_F(ChartStudy, KeepsListsAndMapsAsValues) {
  const Study study = read(with(good, "[1 m, 0.5 m]", "[[1 m, 2 m], {a: [1, 2], b: \"x: y\"}]"));
  EXPECT_EQ(study.axes[2].choices[0].settings[0].value, "[1 m, 2 m]");
  EXPECT_EQ(study.axes[2].choices[1].settings[0].value, "{a: [1, 2], b: \"x: y\"}");
}

TEST_F(ChartStudy, SaysWhatIsWrong) {
  const std::pair<std::string, std::string> wrong[] = {
      {good + "titel: x\n", "study.yaml:12:1: unknown key 'titel' in the study; allowed: "},
      {with(good, "case.yaml", "cases.yaml"), "study.yaml:3:7: case: there is no file 'cases.yaml'"},
      {good + "along: cells\n",
       "study.yaml:12:8: there is no axis 'cells'; allowed: shape, transfer, cell; did you mean "
       "'cell'?"},
      {good + "leave_out: [{shape: linar}]\n",
       "study.yaml:12:21: axis 'shape' has no choice 'linar'; allowed: linear, ugimp; did you mean 'linear'?"},
      {with(good, "{key: scheme.shape, values: [linear, ugimp]}", "{key: scheme.shape}"),
       "study.yaml:6:10: axis 'shape': expected {key: KEY, values: [...]}, or choices by name, NAME: {KEY: VALUE, "
       "...}"},
      {with(good, "measure: numbers", "measure: number"),
       "study.yaml:11:18: unknown error measure 'number'; allowed: "},
      {with(good, "{measure: numbers, of: {runout: 3.5}}", "{of: {runout: 3.5}}"),
       "study.yaml:11:8: error: `measure` is "
       "missing; allowed: "},
      {with(good, "{measure: numbers, of: {runout: 3.5}}", "{measure: reference, of: [runout]}"),
       "study.yaml:11:8: measure: `reference` compares with another run, and the study has no section `reference`"},
      {with(good, "3.5}}", "far}}"), "study.yaml:11:40: runout: 'far' is not a number"},
      {good + "repetitions: 0\n", "study.yaml:12:14: repetitions is"},
      {good + "draw: {kind: maps}\n", "study.yaml:12:14: kind: found "},
  };
  for (const auto& [text, message] : wrong) EXPECT_EQ(trouble(text).substr(0, message.size()), message);
}

TEST_F(ChartStudy, LedgerKeepsWhatWasRun) {
  const fs::path table = folder_ / "runs.csv";
  Entry entry{"00ff", "linear, \"x\"", 1, "0.2.0 (abc)", 0.1, {}};
  entry.report.failure = "physics failed";
  entry.report.message = "a, b";
  entry.report.cpu_seconds = 1.0 / 3;
  entry.report.iterations = 17;
  {
    Ledger ledger(table, true);
    ledger.append(entry);
    entry.repetition = 2;
    entry.error = NAN;
    ledger.append(entry);
  }
  std::ofstream(table, std::ios::app) << "00fe,cut off";
  {
    const Ledger again(table, false);
    ASSERT_EQ(again.entries().size(), 2u);
    const Entry* const first = again.find("00ff", 1);
    ASSERT_NE(first, nullptr);
    EXPECT_EQ(first->variant, "linear, \"x\"");
    EXPECT_EQ(first->report.message, "a, b");
    EXPECT_EQ(first->report.cpu_seconds, 1.0 / 3);
    EXPECT_EQ(first->report.iterations, 17);
    EXPECT_TRUE(std::isnan(again.find("00ff", 2)->error));
    EXPECT_EQ(again.find("00fe", 1), nullptr);
  }
  EXPECT_TRUE(Ledger(table, true).entries().empty());
  std::ofstream(table) << "time_s\n";
  EXPECT_THROW(Ledger(table, false), std::runtime_error);
}

/// A row that took `cpu` seconds a repetition and has an error.
Row row_of(const std::vector<double>& cpu, double error, const std::string& failure = "") {
  Row row{{{"a"}, {}}, {}, "", 0, 0, 0};
  for (const double seconds : cpu) {
    Entry entry;
    entry.error = error;
    entry.report.cpu_seconds = seconds;
    entry.report.failure = failure;
    row.runs.push_back(entry);
  }
  return row;
}

// On the front is what nothing beats in time without losing in error. The cost is the median of the repetitions.
TEST_F(ChartStudy, FindsTheFront) {
  std::vector<Row> rows = {row_of({1, 5, 2}, 0.1), row_of({4}, 0.01), row_of({8}, 0.02), row_of({1}, 0.5, "run failed"),
                           row_of({0.1}, 3)};
  Study study;
  study.limits.error = 1;
  complete(rows, study);
  EXPECT_EQ(rows[0].cpu_seconds, 2);
  EXPECT_TRUE(rows[0].on_front() && rows[1].on_front());
  EXPECT_EQ(rows[2].times_front, 2) << "the second is more exact in half of the time";
  EXPECT_EQ(rows[3].failure, "run failed");
  EXPECT_EQ(rows[4].failure, "error above limit");
}

}  // namespace
}  // namespace sluice::chart
