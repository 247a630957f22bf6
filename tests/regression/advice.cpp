/// The advice as users get it: what `sluice check` says of shipped cases, and what a run under `physics: auto` leaves.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/simulation/run.h"
#include "tests/regression/program.h"
#include "tests/regression/results_folder.h"
#include "tests/regression/scratch.h"

namespace sluice::test {

namespace {

std::string advice_on(const std::string& name, const std::vector<std::string>& options = {}) {
  const Scratch scratch;
  std::vector<std::string> words{"check", std::string(SLUICE_CASES_DIR) + "/" + name + ".yaml"};
  words.insert(words.end(), options.begin(), options.end());
  const Ending ending = run_sluice(words, scratch.path());
  EXPECT_EQ(ending.code, exit_code::done) << ending.err;
  return ending.out;
}

void expect_words(const std::string& text, const std::vector<std::string>& all) {
  for (const std::string& words : all) EXPECT_NE(text.find(words), std::string::npos) << words << "\n" << text;
}

}  // namespace

// H = 1 m, c_v t / H2 = 1 over the run: neither drained nor undrained. A column is as good with one cell across.
TEST(AdviceOnCases, Terzaghi) {
  expect_words(advice_on("13_terzaghi_column"),
               {"model           u-p is the right one within 5 %", "water drains over 1 m", "c_v t / L2 = 1\n",
                "nothing varies along x: one cell across gives the same 8 times cheaper", "(the case)"});
}

// The drain lets the berm consolidate within the slide: total stresses would not do.
TEST(AdviceOnCases, DamWithItsWater) {
  const std::string said = advice_on("19_lower_san_fernando_effective");
  expect_words(said, {"model           u-p is the right one within 5 %", "'lens', is 3 m thick: 3 cells, where 4 are"});
}

// k = 1e-5 m/s and less, M = 2.7 MPa: in 50 s at most a few per cent of the pressure leave. Gravel would drain.
TEST(AdviceOnCases, DamInTotalStresses) {
  const auto with = [](const std::string& permeability) {
    return advice_on("11_lower_san_fernando",
                     {"--set", "advice.materials={lower_hydraulic_fill: {permeability: " + permeability +
                                   "}, liquefied: {permeability: " + permeability + "}}"});
  };
  expect_words(advice_on("11_lower_san_fernando"), {"model           total stresses; with advice.materials.NAME"});
  expect_words(with("1e-6 m/s"), {"model           undrained total stress is the right one", "M = 2.69 MPa"});
  expect_words(with("1e-5 m/s"), {"model           undrained total stress is the right one"});
  expect_words(with("1e-3 m/s"), {"WARNING         the case models too little: undrained total stress is", "take u-p"});
}

// Said before the first step, and not with -q; the run goes on.
TEST(AdviceOnCases, ARunIsWarned) {
  const Scratch scratch;
  std::vector<std::string> words{"run",   std::string(SLUICE_CASES_DIR) + "/13_terzaghi_column.yaml",
                                 "--set", "end_time=1 ms",
                                 "--set", "advice={frequency: 2 kHz}",
                                 "--set", "output={}",
                                 "-o",    "out"};
  const Ending loud = run_sluice(words, scratch.path());
  EXPECT_EQ(loud.code, exit_code::done);
  expect_words(loud.err, {"warning: the case models too little: u-p is ", "take v-w-p"});
  words.insert(words.end(), {"-q", "--force"});
  EXPECT_EQ(run_sluice(words, scratch.path()).err, "");
}

// The run is one of two_phase; what was decided, and by which numbers, stands in both files.
TEST(AdviceOnCases, AutoRunsAndRecordsWhatItTook) {
  const Scratch scratch;
  const std::vector<std::string> words{"run",   std::string(SLUICE_CASES_DIR) + "/13_terzaghi_column.yaml",
                                       "--set", "physics=auto",
                                       "--set", "end_time=0.05 s",
                                       "--set", "output.pictures=[]",
                                       "--set", "output.picture_times=[]",
                                       "-q",    "-o",
                                       "out"};
  const Ending ending = run_sluice(words, scratch.path());
  ASSERT_EQ(ending.code, exit_code::done) << ending.err;
  expect_words(text_of(scratch / "out/case.resolved.yaml"), {"physics: two_phase", "formulation: u-p", "model: u-p"});
  const auto advice = nlohmann::json::parse(text_of(scratch / "out/summary.json")).at("advice");
  EXPECT_EQ(advice.at("model"), "u-p");
  EXPECT_EQ(advice.at("material"), "soil");
  EXPECT_NEAR(advice.at("drainage_length_m").get<double>(), 1, 1e-9);
  EXPECT_NEAR(advice.at("time_factor").get<double>(), 0.06849, 1e-5);  // c_v = 1.372 m2/s, less 0.2 % with K_w
  EXPECT_LT(advice.at("error_of_u_p").get<double>(), 0.05);
  EXPECT_GT(advice.at("error_of_undrained_total_stress").get<double>(), 0.2);
  // The same again, from what was resolved.
  const Ending again = run_sluice({"run", "out/case.resolved.yaml", "-q", "-o", "again"}, scratch.path());
  ASSERT_EQ(again.code, exit_code::done) << again.err;
  EXPECT_EQ(text_of(scratch / "out/observations.csv"), text_of(scratch / "again/observations.csv"));
}

// The shipped case under `physics: auto`: in clay nothing drains while the load comes, and total stresses are the
// cheapest; in silt a fifth of the pressure leaves, and the run is one of u-p. So is the one that asks for an error of
// 1e-4. Both models settle alike, as docs/advisor.md and the case say: the case takes 14 mm in total stresses, 15 mm
// with its water. Tolerance: 15 %, for the undrained material is a little compressible, and its strength does not
// change with depth.
TEST(AdviceOnCases, FastLoadOnClay) {
  const std::string silt = "materials.soft_clay.water.permeability=0.1 mm/s", exact = "advice.tolerance=1e-4";
  expect_words(
      advice_on("20_fast_load_on_clay"),
      {"physics         total_stress", "undrained total stress was taken by `physics: auto`: the cheapest within 5 %",
       "errors of the others: drained total stress 100 %, u-p 0 %"});
  expect_words(advice_on("20_fast_load_on_clay", {"--set", silt}),
               {"physics         two_phase", "u-p is the right one"});
  std::vector<double> settlements;
  for (const std::string& setting : {std::string("advice.tolerance=5 %"), exact}) {
    const Scratch scratch;
    std::vector<std::string> words{"run",   std::string(SLUICE_CASES_DIR) + "/20_fast_load_on_clay.yaml",
                                   "--set", setting,
                                   "--set", "grid.cell=0.5 m",
                                   "--set", "output.pictures=[]",
                                   "--set", "output.picture_times=[]",
                                   "-q",    "-o",
                                   "out"};
    ASSERT_EQ(run_sluice(words, scratch.path()).code, exit_code::done);
    const auto advice = nlohmann::json::parse(text_of(scratch / "out/summary.json")).at("advice");
    EXPECT_EQ(advice.at("model"), setting == exact ? "u-p" : "undrained total stress");
    settlements.push_back(
        std::strtod(table(scratch / "out/observations.csv").at("settlement_m").back().c_str(), nullptr));
  }
  EXPECT_NEAR(settlements[0], settlements[1], 0.15 * settlements[1]);
}

// An interrupted run goes on: the choice is the same on every reading.
TEST(AdviceOnCases, AutoResumes) {
  const Scratch scratch;
  std::vector<std::string> words{"run",   std::string(SLUICE_CASES_DIR) + "/13_terzaghi_column.yaml",
                                 "--set", "physics=auto",
                                 "--set", "output.pictures=[]",
                                 "--set", "output.picture_times=[]",
                                 "-q",    "-o",
                                 "out",   "--set"};
  auto first = words, second = words;
  first.emplace_back("end_time=0.02 s");
  second.emplace_back("end_time=0.04 s");
  second.emplace_back("--resume");
  EXPECT_EQ(run_sluice(first, scratch.path()).code, exit_code::done);
  const Ending ending = run_sluice(second, scratch.path());
  EXPECT_EQ(ending.code, exit_code::done) << ending.err;
}

}  // namespace sluice::test
