/// Interrupted, killed and resumed runs: nothing that was computed is lost, and the result is that of one run.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <random>
#include <thread>

#include "core/simulation/run.h"
#include "tests/regression/program.h"
#include "tests/regression/results_folder.h"
#include "tests/regression/scratch.h"

namespace sluice::test {

namespace {

namespace fs = std::filesystem;

/// A column that takes about a second, with a checkpoint every ten milliseconds, and output times that are no multiples
/// of anything. Signals come well before its end, so that a busy machine does not let it finish first.
class Interruption : public testing::Test {
 protected:
  void SetUp() override {
    const std::string finer = with(with(column, "cell: 0.25 m", "cell: 0.1 m"), "end_time: 1 s", "end_time: 2 s");
    scratch_.write("case.yaml",
                   with(finer, "every: 0.1 s", "every: 0.07 s, history_every: 0 s, checkpoint_every: 10 ms"));
  }

  std::vector<std::string> run(const std::string& folder, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words = {"run", "case.yaml", "--output", folder, "--threads", "2"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }

  /// Starts a run and sends it a signal after `step`, and up to a few milliseconds more.
  Ending signal_after(double step, int signal, const std::vector<std::string>& more = {}) {
    Process process(sluice_words(run("out", more)), scratch_.path());
    while (process.running() && last_number(scratch_ / "out/history.csv", "step") < step)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    std::this_thread::sleep_for(std::chrono::microseconds(std::uniform_int_distribution(0, 5000)(random_)));
    process.signal(signal);
    return process.wait();
  }

  /// The uninterrupted run, in "whole".
  void run_whole() {
    ASSERT_EQ(run_sluice(run("whole"), scratch_.path()).code, exit_code::done);
    last_step_ = last_number(scratch_ / "whole/history.csv", "step");
    ASSERT_GT(last_step_, 300);
  }

  void expect_whole(const std::string& folder) const {
    expect_equal_results(scratch_ / folder, scratch_ / "whole");
    EXPECT_EQ(names_in(scratch_ / folder), promised_names());
    EXPECT_TRUE(holds(text_of(scratch_ / folder / "summary.json"), R"("exit_reason": "end_time_reached")"));
  }

  Scratch scratch_;
  double last_step_ = 0;
  std::mt19937 random_{std::random_device{}()};
};

/// The same for sand full of water under a growing load: what the pressure solver carries from step to step, the old
/// factor among it, must be there again.
class InterruptionOfTwoPhase : public Interruption, public testing::WithParamInterface<std::string> {
 protected:
  void SetUp() override {
    std::string text = with(column, "cell: 0.25 m", "cell: 0.125 m");
    text = with(text, "total_stress\n",
                "two_phase\nwater: {formulation: " + GetParam() + ", bulk_modulus: 50 MPa}\n" +
                    "surface_loads: [{pressure: [[0 s, 0 kPa], [0.5 s, 5 kPa]]}]\n");
    text = with(text, "cohesion: 100 Pa", "cohesion: 100 Pa\n    water: {porosity: 0.4, permeability: 5 mm/s}");
    scratch_.write("case.yaml",
                   with(text, "every: 0.1 s", "every: 0.07 s, history_every: 0 s, checkpoint_every: 10 ms"));
  }

  /// Steps of the uninterrupted run that renewed the factor, and that iterated with an old one.
  std::pair<int, int> factors_new_and_old() const {
    const auto history = table(scratch_ / "whole/history.csv");
    const auto& renewed = history.at("pressure_factorized");
    const auto fresh = std::ranges::count_if(renewed, [](const std::string& v) { return std::stod(v) != 0; });
    return {static_cast<int>(fresh), static_cast<int>(renewed.size()) - static_cast<int>(fresh)};
  }
};

std::string halved(const fs::path& file) {
  std::string text = text_of(file);
  text.resize(text.size() / 2);
  return text;
}

}  // namespace

TEST_F(Interruption, by_ctrl_c_leaves_a_checkpoint_from_which_the_run_goes_on) {
  run_whole();
  for (const int signal : {SIGINT, SIGTERM}) {
    fs::remove_all(scratch_ / "out");
    const Ending ending = signal_after(last_step_ / 3, signal);
    ASSERT_EQ(ending.code, exit_code::interrupted) << ending.err;
    EXPECT_TRUE(holds(ending.err, "interrupted at time "));
    EXPECT_TRUE(holds(ending.err, "--resume"));
    EXPECT_TRUE(holds(text_of(scratch_ / "out/summary.json"), R"("exit_reason": "interrupted")"));
    EXPECT_FALSE(datasets(scratch_ / "out/results.h5").empty());

    const Ending resumed = run_sluice(run("out", {"--resume"}), scratch_.path());
    EXPECT_EQ(resumed.code, exit_code::done) << resumed.err;
    EXPECT_TRUE(holds(resumed.out, "resuming at time "));
    expect_whole("out");
  }
}

TEST_F(Interruption, by_a_kill_at_any_moment_leaves_results_and_a_checkpoint) {
  run_whole();
  const int kills = 6;
  for (int k = 0; k < kills; ++k) {
    // After 5 steps there is a checkpoint for certain.
    const double step = 5 + 0.75 * last_step_ * (k + std::uniform_real_distribution(0.0, 1.0)(random_)) / kills;
    SCOPED_TRACE("kill after step " + std::to_string(step));
    const auto more = k == 0 ? std::vector<std::string>{} : std::vector<std::string>{"--resume"};
    const Ending ending = signal_after(step, SIGKILL, more);
    ASSERT_EQ(ending.code, -SIGKILL) << ending.err;
    EXPECT_FALSE(datasets(scratch_ / "out/results.h5").empty());
  }
  const Ending resumed = run_sluice(run("out", {"--resume"}), scratch_.path());
  ASSERT_EQ(resumed.code, exit_code::done) << resumed.err;
  expect_whole("out");
}

/// Particles that leave are taken out, on both sides of every kill; the measures look at the start as well.
TEST_F(Interruption, by_a_kill_keeps_what_was_removed_and_what_is_measured_from_the_start) {
  const std::string measures = R"(
  drop: {measure: drop_of_highest_point}
  push: {measure: mean_displacement, direction: [1, 0], region: {box: {min: [0 m, 1 m], max: [1 m, 2 m]}}}
  energy: {measure: kinetic_energy}
)";
  std::string text = with(text_of(scratch_ / "case.yaml"), "max: [6 m, 3 m]", "max: [2.5 m, 3 m]");
  text = with(with(text, "right: roller", "right: free"), "end_time", "outflow: remove\nend_time");
  scratch_.write("case.yaml", with(text, "[1, 0]}\n", "[1, 0]}" + measures));
  run_whole();
  EXPECT_GT(nlohmann::json::parse(text_of(scratch_ / "whole/summary.json")).at("removed_particles").get<double>(), 10);
  for (const double share : {0.2, 0.35, 0.5, 0.75}) {
    SCOPED_TRACE(share);
    const auto more = fs::exists(scratch_ / "out") ? std::vector<std::string>{"--resume"} : std::vector<std::string>{};
    ASSERT_EQ(signal_after(share * last_step_, SIGKILL, more).code, -SIGKILL);
  }
  ASSERT_EQ(run_sluice(run("out", {"--resume"}), scratch_.path()).code, exit_code::done);
  expect_whole("out");
}

INSTANTIATE_TEST_SUITE_P(formulations, InterruptionOfTwoPhase, testing::Values("u-p", "v-w-p"),
                         [](const auto& test) { return std::string(test.param == "u-p" ? "u_p" : "v_w_p"); });

TEST_P(InterruptionOfTwoPhase, by_a_kill_at_any_moment_is_not_seen_in_the_results) {
  run_whole();
  const auto [renewed, kept] = factors_new_and_old();
  EXPECT_GT(renewed, 5);
  EXPECT_GT(kept, 100);
  for (const double share : {0.15, 0.3, 0.5, 0.7}) {
    SCOPED_TRACE(share);
    const auto more = fs::exists(scratch_ / "out") ? std::vector<std::string>{"--resume"} : std::vector<std::string>{};
    ASSERT_EQ(signal_after(share * last_step_, SIGKILL, more).code, -SIGKILL);
  }
  const Ending resumed = run_sluice(run("out", {"--resume"}), scratch_.path());
  ASSERT_EQ(resumed.code, exit_code::done) << resumed.err;
  expect_whole("out");
}

TEST_P(InterruptionOfTwoPhase, by_ctrl_c_is_not_seen_in_the_results) {
  run_whole();
  ASSERT_EQ(signal_after(last_step_ / 3, SIGINT).code, exit_code::interrupted);
  auto words = run("out", {"--resume"});
  *(std::find(words.begin(), words.end(), "--threads") + 1) = "1";
  ASSERT_EQ(run_sluice(words, scratch_.path()).code, exit_code::done);
  expect_whole("out");
}

TEST_F(Interruption, of_a_run_that_overwrites_does_not_pass_for_the_finished_run_before_it) {
  ASSERT_EQ(run_sluice(run("out", {"--set", "end_time=0.02 s"}), scratch_.path()).code, exit_code::done);
  const auto step = last_number(scratch_ / "out/history.csv", "step");
  ASSERT_EQ(signal_after(step + 20, SIGKILL, {"--force"}).code, -SIGKILL);
  EXPECT_FALSE(fs::exists(scratch_ / "out/summary.json"));
}

TEST_F(Interruption, may_be_followed_by_another_number_of_threads) {
  run_whole();
  ASSERT_EQ(signal_after(last_step_ / 2, SIGINT).code, exit_code::interrupted);
  auto words = run("out", {"--resume"});
  *(std::find(words.begin(), words.end(), "--threads") + 1) = "1";
  EXPECT_EQ(run_sluice(words, scratch_.path()).code, exit_code::done);
  expect_whole("out");
}

TEST_F(Interruption, of_a_finished_run_is_none_and_it_can_be_extended) {
  ASSERT_EQ(run_sluice(run("out", {"--set", "end_time=0.07 s"}), scratch_.path()).code, exit_code::done);
  ASSERT_EQ(run_sluice(run("out", {"--set", "end_time=0.07 s", "--resume"}), scratch_.path()).code, exit_code::done);
  EXPECT_EQ(names_in(scratch_ / "out"), promised_names());
  ASSERT_EQ(run_sluice(run("out", {"--resume"}), scratch_.path()).code, exit_code::done);
  run_whole();
  expect_whole("out");  // 0.07 s is an output time of both, so the steps are the same
}

// ---- what cannot be resumed ----------------------------------------------------------------------------------------

TEST(Resume, of_nothing_is_an_error) {
  const Scratch scratch;
  scratch.write("case.yaml", column);
  const Ending nowhere = run_sluice({"run", "case.yaml", "-o", "nowhere", "--resume"}, scratch.path());
  EXPECT_EQ(nowhere.code, exit_code::bad_input);
  EXPECT_TRUE(holds(nowhere.err, "there is no folder nowhere"));

  fs::create_directory(scratch / "empty");
  const Ending empty = run_sluice({"run", "case.yaml", "-o", "empty", "--resume"}, scratch.path());
  EXPECT_EQ(empty.code, exit_code::run_failed);
  EXPECT_TRUE(holds(empty.err, "no usable checkpoint in empty"));
  EXPECT_EQ(names_in(scratch.path()), (std::set<std::string>{"case.yaml", "empty"}));
  EXPECT_TRUE(fs::is_empty(scratch / "empty"));
}

TEST(Resume, of_another_case_is_refused) {
  const Scratch scratch;
  scratch.write("case.yaml", column);
  ASSERT_EQ(run_sluice({"run", "case.yaml", "-o", "out", "--set", "end_time=0.1 s"}, scratch.path()).code, 0);
  const auto before = fingerprint(scratch / "out");
  for (const std::string change : {"materials.sand.cohesion=200 Pa", "gravity=[0, -5 m/s2]", "grid.cell=0.5 m"}) {
    SCOPED_TRACE(change);
    const Ending ending = run_sluice({"run", "case.yaml", "-o", "out", "--resume", "--set", change}, scratch.path());
    EXPECT_EQ(ending.code, exit_code::bad_input);
    EXPECT_TRUE(holds(ending.err, "--resume: the run in out is of another case"));
    EXPECT_EQ(changes(before, fingerprint(scratch / "out")), "");
  }
}

TEST(Resume, takes_the_older_checkpoint_if_the_newer_is_damaged) {
  const Scratch scratch;
  scratch.write("case.yaml", column);
  const std::vector<std::string> arguments = {"run", "case.yaml", "-o", "out"};
  ASSERT_EQ(run_sluice(arguments, scratch.path()).code, exit_code::done);
  fs::copy(scratch / "out", scratch / "whole");
  auto resume = arguments;
  resume.emplace_back("--resume");

  // The second of the two checkpoints of this short run is that of its end.
  scratch.write("out/checkpoint_1.h5", halved(scratch / "out/checkpoint_1.h5"));
  const Ending ending = run_sluice(resume, scratch.path());
  EXPECT_EQ(ending.code, exit_code::done);
  EXPECT_TRUE(holds(ending.err, "warning: out/checkpoint_1.h5"));
  EXPECT_TRUE(holds(ending.out, "resuming at time 0 s"));
  expect_equal_results(scratch / "out", scratch / "whole");

  // A single changed byte, which only the checksum sees.
  std::string text = text_of(scratch / "out/checkpoint_1.h5");
  text[text.size() / 2] = static_cast<char>(text[text.size() / 2] ^ 1);
  scratch.write("out/checkpoint_1.h5", text);
  scratch.write("out/checkpoint_0.h5", halved(scratch / "out/checkpoint_0.h5"));
  const auto before = fingerprint(scratch / "out");
  const Ending both = run_sluice(resume, scratch.path());
  EXPECT_EQ(both.code, exit_code::run_failed);
  for (const auto* word : {"no usable checkpoint", "checkpoint_0.h5", "checkpoint_1.h5"})
    EXPECT_TRUE(holds(both.err, word));
  EXPECT_EQ(changes(before, fingerprint(scratch / "out")), "");
}

}  // namespace sluice::test
