/// `sluice chart` as a user runs it: the shipped studies, tables and figures, failures as results, an interrupted
/// study.
#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <thread>

#include "core/chart/study.h"
#include "core/simulation/run.h"
#include "tests/regression/program.h"
#include "tests/regression/results_folder.h"
#include "tests/regression/scratch.h"

namespace sluice::test {

namespace {

namespace fs = std::filesystem;

/// A bar of few cells, whose exact solution the program knows.
const std::string bar = R"(schema: 1
physics: total_stress
grid: {min: [0 m, 0 m], max: [26 m, 1 m], cell: 1 m}
gravity: [4e-5 m/s2, 0]
materials: {rubber: {model: linear_elastic, density: 1 kg/m3, youngs_modulus: 100 Pa, poisson_ratio: 0}}
bodies: [{material: rubber, box: {min: [0 m, 0 m], max: [25 m, 1 m]}}]
boundaries: {left: roller, bottom: roller, top: roller}
end_time: 10 s
output: {every: 1 s, history_every: 10 s}
)";

const std::string study = R"(schema: 1
title: A bar
case: bar.yaml
axes:
  shape: {key: scheme.shape, values: [linear, quadratic_bspline]}
  step: {computed: {scheme.courant: 0.5}, too long: {scheme.time_step: 1 s}}
  cell: {key: grid.cell, values: [1 m, 0.5 m]}
error: {measure: vibrating_bar}
repetitions: 2
)";

class Chart : public testing::Test {
 protected:
  void SetUp() override {
    scratch_.write("bar.yaml", bar);
    scratch_.write("study.yaml", study);
  }
  Ending chart(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words = {"chart", "study.yaml", "-o", "out"};
    words.insert(words.end(), more.begin(), more.end());
    return run_sluice(words, scratch_.path());
  }
  std::size_t runs() const { return table(scratch_ / "out/runs.csv").at("identity").size(); }
  Scratch scratch_;
};

}  // namespace

// A step that is too long is a result: it is marked, and the others stand. Halving the cells reduces the error.
TEST_F(Chart, has_errors_costs_and_failures) {
  const Ending ending = chart();
  ASSERT_EQ(ending.code, exit_code::done) << ending.err << ending.out;
  const auto rows = table(scratch_ / "out/chart.csv");
  ASSERT_EQ(rows.at("error").size(), 8u);
  for (std::size_t i = 0; i < 8; ++i) {
    const bool computed = rows.at("step")[i] == "computed";
    EXPECT_EQ(rows.at("failure")[i].empty(), computed) << i;
    if (!computed) continue;
    EXPECT_LT(std::stod(rows.at("error")[i]), 0.03);
    EXPECT_GT(std::stod(rows.at("cpu_s")[i]), 0);
    EXPECT_LT(std::stod(rows.at("cpu_s")[i]), std::stod(rows.at("process_cpu_s")[i]));
    EXPECT_EQ(std::stod(rows.at("particle_steps")[i]),
              std::stod(rows.at("particles")[i]) * std::stod(rows.at("steps")[i]));
    EXPECT_GT(std::stod(rows.at("peak_memory_bytes")[i]), 1e6);
    if (rows.at("cell")[i] == "0.5 m") {
      EXPECT_LT(std::stod(rows.at("error")[i]), 0.5 * std::stod(rows.at("error")[i - 1]));
    }
  }
  EXPECT_TRUE(holds(text_of(scratch_ / "out/chart.csv"), "scheme.time_step of 1 s exceeds the wave limit of 0.05 s"));
  for (const char* figure : {"chart.png", "chart.svg"}) EXPECT_GT(fs::file_size(scratch_ / "out" / figure), 5000u);
  EXPECT_EQ(runs(), 12u) << "4 variants twice, 4 that fail once";
}

// What was run is not run again; a cut table and a killed study go on where they were.
TEST_F(Chart, goes_on_where_it_was) {
  Process process(sluice_words({"chart", "study.yaml", "-o", "out", "--no-picture"}), scratch_.path());
  while (process.running() && text_of(scratch_ / "out/runs.csv").find("1 m\"") == std::string::npos)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  process.signal(SIGKILL);
  process.wait();
  const std::string before = text_of(scratch_ / "out/runs.csv");
  const Ending ending = chart({"--no-picture"});
  ASSERT_EQ(ending.code, exit_code::done) << ending.err;
  EXPECT_TRUE(begins(text_of(scratch_ / "out/runs.csv"), before.substr(0, before.rfind('\n'))));
  EXPECT_EQ(runs(), 12u);
  const std::string whole = text_of(scratch_ / "out/runs.csv");
  ASSERT_EQ(chart({"--no-picture"}).code, exit_code::done);
  EXPECT_EQ(text_of(scratch_ / "out/runs.csv"), whole) << "nothing left to do";
}

// A second study in the same folder would write over the runs of the first. It waits a moment, then says so; when the
// first has let go, even by being killed, it goes on.
TEST_F(Chart, does_not_work_where_another_works) {
  fs::create_directories(scratch_ / "out");
  const int folder = open((scratch_ / "out").c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  ASSERT_EQ(flock(folder, LOCK_EX | LOCK_NB), 0);
  const Ending refused = chart({"--no-picture"});
  EXPECT_EQ(refused.code, exit_code::run_failed);
  EXPECT_TRUE(holds(refused.err, "another study works in out; wait until it ends, or take another --output"));
  close(folder);
  EXPECT_EQ(chart({"--no-picture"}).code, exit_code::done);
}

TEST_F(Chart, stops_in_order_when_interrupted) {
  Process process(sluice_words({"chart", "study.yaml", "-o", "out", "--no-picture"}), scratch_.path());
  while (process.running() && !fs::exists(scratch_ / "out/runs.csv"))
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  process.signal(SIGINT);
  const Ending ending = process.wait();
  EXPECT_EQ(ending.code, exit_code::interrupted);
  EXPECT_TRUE(holds(ending.err, "interrupted; the same command continues the study in out"));
}

TEST_F(Chart, says_what_is_wrong) {
  scratch_.write("study.yaml", with(study, "scheme.shape", "scheme.shap"));
  Ending ending = chart();
  EXPECT_EQ(ending.code, exit_code::bad_input);
  EXPECT_TRUE(holds(ending.err,
                    "study.yaml: the case refuses every combination; the first, linear, computed, 1 m:\n"
                    "--set scheme.shap: unknown key 'shap' in scheme"));
  EXPECT_TRUE(holds(ending.err, "did you mean 'shape'?"));

  scratch_.write("study.yaml", with(study, "[linear, quad", "[linaer, quad"));
  ending = chart();
  EXPECT_EQ(ending.code, exit_code::bad_input);
  EXPECT_TRUE(holds(ending.err,
                    "study.yaml:5:10: axis 'shape', choice 'linaer': the case refuses it in every "
                    "combination:\n--set scheme.shape: unknown shape function 'linaer'"));

  scratch_.write("study.yaml", with(study, "computed: {scheme.courant: 0.5}, too", "too"));
  ending = chart();
  EXPECT_EQ(ending.code, exit_code::run_failed);
  EXPECT_TRUE(holds(ending.err, "no variant has an error that could be charted\n  linear, too long, 1 m: "));

  scratch_.write("study.yaml", with(study, "vibrating_bar", "terzaghi"));
  ending = chart({"--force"});
  EXPECT_EQ(ending.code, exit_code::bad_input) << ending.err;

  fs::remove_all(scratch_ / "out");
  fs::create_directory(scratch_ / "out");
  scratch_.write("out/notes.txt", "mine");
  ending = chart();
  EXPECT_EQ(ending.code, exit_code::bad_input);
  EXPECT_TRUE(holds(ending.err, "the output folder out is not empty and holds no study"));
}

// The shipped studies: each can be read, and the case takes each of its choices.
TEST_F(Chart, shipped_studies_are_sound) {
  std::size_t count = 0;
  for (const auto& entry : fs::directory_iterator(fs::path(SLUICE_CASES_DIR) / "studies")) {
    if (entry.path().extension() != ".yaml") continue;
    SCOPED_TRACE(entry.path().string());
    ++count;
    const auto definition = chart::load_study(entry.path().string());
    for (const auto& variant : chart::variants_of(definition))
      EXPECT_NO_THROW(load_case(definition.case_file, variant.settings)) << variant.name();
    if (definition.reference) {
      EXPECT_NO_THROW(load_case(definition.case_file, *definition.reference));
    }
  }
  EXPECT_GE(count, 11u);
}

namespace {

/// A run of a shipped case, and the error that verification lets it have.
struct Known {
  std::string measure, file, settings;
  double most;
};

}  // namespace

// The error measures see through the files of a run what the tests of verification see: displacements of a bar and of
// standing waves (second order: 16 cells in a wavelength or more), the stress in a heavy column, pore pressures of
// columns and of the sphere. The bounds are those of the tests, widened where the grid is coarser.
TEST_F(Chart, measures_agree_with_verification) {
  const Known all[] = {
      {"vibrating_bar", "01_vibrating_bar.yaml",
       "gravity: [4e-5 m/s2, 0], end_time: 20 s, output.every: 2 s, output.pictures: [], output.picture_times: []",
       2e-3},
      {"manufactured", "studies/bases/manufactured_waves.yaml", "bodies.0.particles_per_cell: 16", 0.02},
      {"heavy_column", "studies/bases/heavy_column.yaml",
       "scheme.shape: cubic_bspline, bodies.0.particles_per_cell: 36", 3e-4},
      {"terzaghi", "studies/bases/saturated_column.yaml", "end_time: 0.2 s", 0.01},
      {"telegraph_column", "studies/bases/saturated_column.yaml", "grid.cell: 0.0125 m", 3e-3},
      {"undrained_column", "studies/bases/saturated_column.yaml",
       "materials.sand.water.permeability: 1e-8 m/s, end_time: 20 ms", 0.12},
      {"cryer", "studies/bases/saturated_sphere.yaml", "end_time: 80 ms", 0.05},
  };
  const auto error_of = [&](const Known& known) {
    scratch_.write("study.yaml", fmt::format("schema: 1\ntitle: One\ncase: {}/{}\naxes: {{only: {{one: {{{}}}}}}}\n"
                                             "error: {{measure: {}}}\nrepetitions: 1\n",
                                             SLUICE_CASES_DIR, known.file, known.settings, known.measure));
    const Ending ending = chart({"--force", "--no-picture"});
    EXPECT_EQ(ending.code, exit_code::done) << ending.err;
    return last_number(scratch_ / "out/chart.csv", "error");
  };
  for (const Known& known : all) {
    SCOPED_TRACE(known.measure);
    const double error = error_of(known);
    EXPECT_LT(error, known.most);
    EXPECT_GT(error, 1e-5) << "nothing was measured";
  }
  // The control: the column drains at its base, too.
  EXPECT_GT(error_of({"terzaghi", "studies/bases/saturated_column.yaml",
                      "end_time: 0.2 s, water.faces: {bottom: {pressure: 0 Pa}}", 1}),
            0.1);
}

}  // namespace sluice::test
