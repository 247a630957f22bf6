/// Every case in cases/: it passes `check`, runs, leaves what is promised, and its resolved case gives the same result.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/simulation/run.h"
#include "tests/regression/program.h"
#include "tests/regression/results_folder.h"
#include "tests/regression/scratch.h"

namespace sluice::test {

namespace {

namespace fs = std::filesystem;

/// All YAML files of the folder itself; those that hold shared geometry lie in folders below.
std::vector<fs::path> shipped_cases() {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(SLUICE_CASES_DIR))
    if (entry.path().extension() == ".yaml") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

/// The length of the step that `check` predicts [s].
double predicted_step(const std::string& prediction) {
  const std::string label = "time step ";
  const auto at = prediction.find(label);
  return at == std::string::npos ? 0 : std::strtod(prediction.c_str() + at + label.size(), nullptr);
}

/// Options that end a run after some 20 steps, without pictures.
std::vector<std::string> shortened(const fs::path& file, const Scratch& scratch) {
  const Ending prediction = run_sluice({"check", file.string()}, scratch.path());
  EXPECT_EQ(prediction.code, exit_code::done) << prediction.err;
  const double step = predicted_step(prediction.out);
  EXPECT_GT(step, 0) << prediction.out;
  return {"--set", fmt::format("end_time={} s", 20 * step),
          "--set", "output.pictures=[]",
          "--set", "output.picture_times=[]"};
}

Ending run(const fs::path& file, const std::string& folder, const std::vector<std::string>& options,
           const Scratch& scratch) {
  std::vector<std::string> words = {"run", file.string(), "--output", folder};
  words.insert(words.end(), options.begin(), options.end());
  return run_sluice(words, scratch.path());
}

void expect_sound_summary(const fs::path& folder) {
  const auto summary = nlohmann::json::parse(text_of(folder / "summary.json"));
  EXPECT_EQ(summary.at("exit_reason"), "end_time_reached");
  EXPECT_GE(summary.at("steps").get<int>(), 10);
  for (const auto* name : {"particles", "threads", "wall_seconds", "particle_steps_per_second"})
    EXPECT_GT(summary.at(name).get<double>(), 0) << name;
  EXPECT_FALSE(summary.at("stage_seconds").empty());
  const auto observations = table(folder / "observations.csv");
  EXPECT_EQ(summary.at("observations").size() + 2, observations.size());
  for (const auto& [name, value] : summary.at("observations").items()) {
    EXPECT_TRUE(value.is_number()) << name;
    const auto column = observations.lower_bound(name);  // the name of the column goes on with the unit
    ASSERT_TRUE(column != observations.end() && column->first.compare(0, name.size(), name) == 0) << name;
    EXPECT_DOUBLE_EQ(std::strtod(column->second.back().c_str(), nullptr), value.get<double>()) << name;
  }
}

}  // namespace

// One test for all of them, not one for each: ctest learns the names when the tests are built, and a case may come
// later.
TEST(ShippedCases, run_and_leave_what_is_promised) {
  const auto files = shipped_cases();
  ASSERT_GE(files.size(), 2u);
  for (const auto& file : files) {
    SCOPED_TRACE(file.string());
    const Scratch scratch;
    const auto options = shortened(file, scratch);
    const Ending ending = run(file, "out", options, scratch);
    ASSERT_EQ(ending.code, exit_code::done) << ending.err;
    EXPECT_EQ(ending.err, "");
    EXPECT_EQ(names_in(scratch / "out"), promised_names());
    expect_sound_summary(scratch / "out");

    const Ending again = run(scratch / "out/case.resolved.yaml", "again", {}, scratch);
    ASSERT_EQ(again.code, exit_code::done) << again.err;
    expect_equal_results(scratch / "again", scratch / "out");
    EXPECT_EQ(text_of(scratch / "again/case.resolved.yaml"), text_of(scratch / "out/case.resolved.yaml"));
  }
}

TEST(ShippedCases, are_shortened_without_a_word_about_their_pictures) {
  for (const auto& file : shipped_cases()) {
    SCOPED_TRACE(file.string());
    const Scratch scratch;
    const Ending ending = run_sluice({"check", file.string(), "--set", "end_time=0.1 s"}, scratch.path());
    EXPECT_EQ(ending.code, exit_code::done) << ending.err;
  }
}

}  // namespace sluice::test
