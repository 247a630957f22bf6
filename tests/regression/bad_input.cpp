/// Bad input: a clear message on stderr, the documented exit code, and nothing lost.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "core/simulation/run.h"
#include "tests/regression/program.h"
#include "tests/regression/results_folder.h"
#include "tests/regression/scratch.h"

namespace sluice::test {

namespace {

/// Asserts that `sluice run` and `sluice check` refuse the case with this message, and that neither a new folder nor
/// one with earlier results is touched, whatever the options.
void expect_refused(const std::string& text, const std::vector<std::string>& words,
                    const std::vector<std::string>& options = {}) {
  const Scratch scratch;
  scratch.write("case.yaml", text);
  std::filesystem::create_directory(scratch / "earlier");
  for (const auto& name : promised_names()) scratch.write("earlier/" + name, "precious");
  const auto before = fingerprint(scratch.path());
  for (const std::vector<std::string>& command : {std::vector<std::string>{"check", "case.yaml"},
                                                  {"run", "case.yaml"},
                                                  {"run", "case.yaml", "--output", "new/folder"},
                                                  {"run", "case.yaml", "--output", "earlier", "--force"}}) {
    auto arguments = command;
    arguments.insert(arguments.end(), options.begin(), options.end());
    SCOPED_TRACE(testing::PrintToString(arguments));
    const Ending ending = run_sluice(arguments, scratch.path());
    EXPECT_EQ(ending.code, exit_code::bad_input);
    EXPECT_TRUE(begins(ending.err, "error: "));
    for (const auto& word : words) EXPECT_TRUE(holds(ending.err, word));
    EXPECT_EQ(changes(before, fingerprint(scratch.path())), "");
  }
}

/// The number that follows `words`; -1 if they are not there.
double number_after(const std::string& text, const std::string& words) {
  const auto place = text.find(words);
  return place == std::string::npos ? -1 : std::strtod(text.c_str() + place + words.size(), nullptr);
}

}  // namespace

// ---- the case file -------------------------------------------------------------------------------------------------

TEST(BadCase, is_not_there) {
  const Scratch scratch;
  const Ending ending = run_sluice({"run", "colunm.yaml"}, scratch.path());
  EXPECT_EQ(ending.code, exit_code::bad_input);
  EXPECT_EQ(ending.err, "error: colunm.yaml: no such file\n");
  EXPECT_TRUE(std::filesystem::is_empty(scratch.path()));
}

TEST(BadCase, is_a_folder) {
  const Scratch scratch;
  const Ending ending = run_sluice({"check", "."}, scratch.path());
  EXPECT_EQ(ending.code, exit_code::bad_input);
  EXPECT_TRUE(holds(ending.err, "is a folder"));
}

TEST(BadCase, is_empty) { expect_refused("", {"case.yaml:1:1", "'schema' is missing", "'grid' is missing"}); }

TEST(BadCase, is_no_yaml) { expect_refused(with(column, "max: [6 m, 3 m]", "max: [6 m, 3 m"), {"case.yaml:4:"}); }

TEST(BadCase, has_an_unknown_key) {
  expect_refused(with(column, "    youngs_modulus", "    young_modulus"),
                 {"case.yaml:10:5", "unknown key 'young_modulus'", "allowed: ", "did you mean 'youngs_modulus'?"});
}

TEST(BadCase, has_an_unknown_material) {
  expect_refused(with(column, "- material: sand", "- material: snad"),
                 {"case.yaml:14:15", "unknown material 'snad'", "did you mean 'sand'?"});
}

TEST(BadCase, has_an_unknown_physics) {
  expect_refused(with(column, "total_stress", "total_stres"), {"case.yaml:3:10", "did you mean 'total_stress'?"});
}

TEST(BadCase, has_a_negative_modulus) {
  expect_refused(with(column, "2 MPa", "-2 MPa"), {"case.yaml:10:21", "youngs_modulus", "must be above 0"});
}

TEST(BadCase, has_a_unit_of_another_dimension) {
  expect_refused(with(column, "2 MPa", "2 kg"), {"case.yaml:10:21", "found '2 kg', a mass", "expected a stress"});
}

TEST(BadCase, has_an_unknown_unit) { expect_refused(with(column, "2 MPa", "2 psi"), {"case.yaml:10:21", "psi"}); }

TEST(BadCase, has_water_that_its_physics_does_not_know) {
  expect_refused(with(column, "end_time: 1 s", "end_time: 1 s\nwater: {density: 1 t/m3}"),
                 {"case.yaml:21:8", "water: the physics total_stress has neither water", "`physics: two_phase`"});
}

TEST(BadCase, has_an_unknown_face_of_the_water) {
  expect_refused(with(with(column, "total_stress", "two_phase"), "end_time: 1 s",
                      "end_time: 1 s\nwater: {faces: {upper: drained}}"),
                 {"case.yaml:21:17", "unknown face 'upper' in water.faces"});
}

// Found when the system of the pressure is solved: by `check`, which tries some steps, and in the first step of a run.
TEST(BadCase, closes_in_water_that_cannot_be_compressed) {
  const Scratch scratch;
  scratch.write("case.yaml",
                "schema: 1\nphysics: two_phase\nend_time: 1 s\ngravity: [0, -9.81 m/s2]\n"
                "grid: {min: [0 m, 0 m], max: [2 m, 2 m], cell: 0.5 m}\n"
                "materials: {soil: {model: linear_elastic, density: 1600 kg/m3, youngs_modulus: 1 MPa,\n"
                "                   water: {porosity: 0.4, permeability: 1e-4 m/s}}}\n"
                "bodies: [{material: soil, box: {min: [0 m, 0 m], max: [2 m, 2 m]}}]\n"
                "boundaries: {left: roller, right: roller, bottom: roller, top: roller}\n");
  for (const char* const command : {"check", "run"}) {
    const Ending ending = run_sluice({command, "case.yaml"}, scratch.path());
    EXPECT_EQ(ending.code, exit_code::bad_input);
    EXPECT_TRUE(holds(ending.err, "incompressible and closed in"));
  }
}

// A limit of the water: with an explicit step that of sound, with water on its own that of gravity.
TEST(CheckedCase, shows_the_limits_of_the_water) {
  const Scratch scratch;
  scratch.write("case.yaml",
                "schema: 1\nphysics: two_phase\nend_time: 1 s\ngravity: [0, -9.81 m/s2]\n"
                "grid: {min: [0 m, 0 m], max: [2 m, 2 m], cell: 0.5 m}\n"
                "materials: {soil: {model: linear_elastic, density: 1600 kg/m3, youngs_modulus: 1 MPa,\n"
                "                   water: {porosity: 0.4, permeability: 1e-4 m/s}}, sea: {model: water}}\n"
                "bodies: [{material: soil, box: {min: [0 m, 0 m], max: [1 m, 1 m]}},\n"
                "         {material: sea, box: {min: [1 m, 0 m], max: [2 m, 1 m]}}]\n"
                "boundaries: {left: roller, right: roller, bottom: roller}\nwater: {bulk_modulus: 2.2 GPa}\n");
  Ending ending = run_sluice({"check", "case.yaml"}, scratch.path());
  EXPECT_EQ(ending.code, 0);
  for (const char* const limit : {"(wave)", "(gravity)"}) EXPECT_TRUE(holds(ending.out, limit));
  ending = run_sluice({"check", "case.yaml", "--set", "water.formulation=explicit"}, scratch.path());
  EXPECT_EQ(ending.code, 0);
  EXPECT_TRUE(holds(ending.out, "sound"));
}

TEST(BadCase, is_told_all_mistakes_at_once) {
  expect_refused(with(with(column, "end_time: 1 s", "end_time: -1 s"), "friction: 0.5", "friction: -0.5"),
                 {"case.yaml:19:37", "case.yaml:20:11"});
}

TEST(BadCase, has_overlapping_bodies) {
  const std::string second = "  - material: sand\n    box: {min: [1 m, 1 m], max: [3 m, 2 m]}\n";
  expect_refused(with(column, "boundaries:", second + "boundaries:"),
                 {"case.yaml:16:5", "overlap", "case.yaml:14:5", "replaces: sand"});
}

TEST(BadCase, has_a_body_that_reaches_out_of_the_grid) {
  expect_refused(with(column, "max: [2 m, 2 m]", "max: [7 m, 2 m]"),
                 {"case.yaml:14:5", "1 m beyond the right face", "x = 7 m", "6 m"});
}

TEST(BadCase, has_a_body_outside_the_grid) {
  expect_refused(with(column, "box: {min: [0 m, 0 m], max: [2 m, 2 m]}", "box: {min: [8 m, 0 m], max: [9 m, 2 m]}"),
                 {"case.yaml:14:5", "lies outside the grid"});
}

TEST(BadCase, has_a_body_without_particles) {
  expect_refused(with(column, "max: [2 m, 2 m]", "max: [1 cm, 1 cm]"), {"case.yaml:14:5", "holds no material points"});
}

TEST(BadCase, has_no_bodies) { expect_refused(column, {"--set bodies", "empty list"}, {"--set", "bodies=[]"}); }

TEST(BadCase, has_a_time_step_above_the_limit) {
  expect_refused(column + "scheme: {time_step: 10 ms}\n",
                 {"case.yaml:24:21: scheme.time_step of 0.01 s", "wave limit of 0.00", "time_step: computed"});
  expect_refused(column, {"--set scheme.time_step: scheme.time_step of 0.01 s"}, {"--set", "scheme.time_step=10 ms"});
}

TEST(BadCase, has_an_unknown_form_of_strain) {
  expect_refused(column + "scheme: {strain: henky}\n", {"strain", "henky", "jaumann", "did you mean", "hencky"});
}

TEST(BadCase, observes_nothing) {
  expect_refused(with(column, "front, direction: [1, 0]",
                      "mean_displacement, direction: [1, 0], region: {box: {min: [4 m, 0 m], max: [5 m, 1 m]}}"),
                 {"case.yaml:22:11", "no material lies in its region"});
}

TEST(BadCase, observes_without_a_direction) {
  expect_refused(with(column, ", direction: [1, 0]", ""), {"case.yaml:22:", "needs a direction"});
}

TEST(BadCase, asks_for_pictures_of_nothing) {
  expect_refused(with(column, "every: 0.1 s", "every: 0.1 s, pictures: [displacment]"),
                 {"case.yaml:23:35", "'displacment'", "displacement", "did you mean"});
  // One word may stand for a list of one.
  expect_refused(with(column, "every: 0.1 s", "every: 0.1 s, pictures: displacment"),
                 {"case.yaml:23:34", "'displacment'", "did you mean 'displacement'?"});
  expect_refused(column, {"--set output.pictures: ", "unknown field 'false'", "allowed: ", "displacement", "`[]`"},
                 {"--set", "output.pictures=false"});
}

// ---- the command line ----------------------------------------------------------------------------------------------

TEST(BadCommand, overrides_what_is_not_there) {
  expect_refused(column, {"--set materials.sand.young", "unknown key"}, {"--set", "materials.sand.young=3 MPa"});
  expect_refused(column, {"--set bodies.7.material", "from 0 to 0"}, {"--set", "bodies.7.material=sand"});
}

TEST(BadCommand, overrides_with_a_bad_value) {
  expect_refused(column, {"--set end_time", "'soon'"}, {"--set", "end_time=soon"});
  expect_refused(column, {"--set bodies.0.velocity", "not a finite number"}, {"--set", "bodies.0.velocity=[nan, 0]"});
}

TEST(BadCommand, overrides_without_a_value) {
  expect_refused(column, {"--set end_time", "KEY=VALUE"}, {"--set", "end_time"});
  expect_refused(column, {"--set =3", "KEY=VALUE"}, {"--set", "=3"});
}

TEST(BadCommand, asks_for_a_number_of_threads_that_cannot_be) {
  for (const std::string word : {"0", "-1", "two", "1.5", "2x", "1025", "99999999999"})
    expect_refused(column, {"--threads", "found '" + word + "'", "a whole number from 1 to 1024", "all cores"},
                   {"--threads", word});
}

TEST(BadCommand, is_not_known) {
  const Scratch scratch;
  const struct {
    std::vector<std::string> arguments;
    std::string word;
  } mistakes[] = {{{}, "run, check, plot, list, schema"},
                  {{"runn", "case.yaml"}, "did you mean 'run'?"},
                  {{"run"}, "case"},
                  {{"run", "case.yaml", "--outptu", "x"}, "--outptu"},
                  {{"run", "case.yaml", "--threads", "many"}, "--threads"},
                  {{"run", "case.yaml", "--resume", "--force"}, "--force"},
                  {{"schema", "--jsn"}, "--jsn"},
                  {{"list", "mater"}, "did you mean 'materials'?"},
                  {{"plot"}, "results"},
                  {{"plot", "nowhere"}, "nowhere"}};
  scratch.write("case.yaml", column);
  for (const auto& [arguments, word] : mistakes) {
    SCOPED_TRACE(testing::PrintToString(arguments));
    const Ending ending = run_sluice(arguments, scratch.path());
    EXPECT_EQ(ending.code, exit_code::bad_input);
    EXPECT_TRUE(begins(ending.err, "error: "));
    EXPECT_TRUE(holds(ending.err, word));
    EXPECT_EQ(ending.out, "");
  }
  EXPECT_EQ(names_in(scratch.path()), std::set<std::string>{"case.yaml"});
}

// ---- the output folder ---------------------------------------------------------------------------------------------

TEST(OutputFolder, is_not_overwritten_unless_told) {
  const Scratch scratch;
  scratch.write("case.yaml", column);
  const std::vector<std::string> again = {"run", "case.yaml", "--output", "out", "--set", "end_time=0.05 s"};
  ASSERT_EQ(run_sluice(again, scratch.path()).code, exit_code::done);
  const auto before = fingerprint(scratch / "out");

  const Ending refused = run_sluice(again, scratch.path());
  EXPECT_EQ(refused.code, exit_code::bad_input);
  EXPECT_TRUE(holds(refused.err, "out is not empty"));
  EXPECT_TRUE(holds(refused.err, "--force"));
  EXPECT_EQ(changes(before, fingerprint(scratch / "out")), "");

  auto forced = again;
  forced.back() = "end_time=0.1 s";
  forced.emplace_back("--force");
  EXPECT_EQ(run_sluice(forced, scratch.path()).code, exit_code::done);
  EXPECT_EQ(names_in(scratch / "out"), promised_names());
  EXPECT_DOUBLE_EQ(last_number(scratch / "out/history.csv", "time_s"), 0.1);
}

TEST(OutputFolder, is_results_and_the_name_of_the_case_by_default) {
  const Scratch scratch;
  scratch.write("sand heap.yaml", column);
  EXPECT_EQ(run_sluice({"run", "sand heap.yaml", "--set", "end_time=0.05 s"}, scratch.path()).code, exit_code::done);
  EXPECT_EQ(names_in(scratch / "results/sand heap"), promised_names());
}

/// A file in the way is bad input, and is left as it is; a folder that the system refuses is a failed run.
TEST(OutputFolder, cannot_be_made) {
  const Scratch scratch;
  scratch.write("case.yaml", column);
  scratch.write("a_file", "precious");
  const struct {
    std::string folder, reason;
    int code;
  } troubles[] = {{"a_file", "a_file is a file; take another --output", exit_code::bad_input},
                  {"a_file/out", "a_file is a file; take another --output", exit_code::bad_input},
                  {"/proc/out", "", exit_code::run_failed}};
  for (const auto& [folder, reason, code] : troubles)
    for (const std::string option : {"", "--force", "--resume"}) {
      if (option == "--resume" && code != exit_code::bad_input) continue;
      SCOPED_TRACE(folder + " " + option);
      std::vector<std::string> arguments = {"run", "case.yaml", "--output", folder};
      if (!option.empty()) arguments.push_back(option);
      const Ending ending = run_sluice(arguments, scratch.path());
      EXPECT_EQ(ending.code, code);
      EXPECT_TRUE(begins(ending.err, "error: the output folder " + folder + " cannot be made: " + reason));
    }
  EXPECT_EQ(names_in(scratch.path()), (std::set<std::string>{"case.yaml", "a_file"}));
  EXPECT_EQ(text_of(scratch / "a_file"), "precious");
}

/// A full disk, played by a limit on the size of files, in units of 512 bytes: too little for a checkpoint, and enough
/// for everything but the results.h5 of the end.
TEST(OutputFolder, is_full) {
  const Scratch scratch;
  scratch.write("case.yaml", column);
  for (const std::string limit : {"100", "200"}) {
    SCOPED_TRACE(limit);
    const std::string command =
        "trap '' XFSZ; ulimit -f " + limit + "; exec '" SLUICE_PROGRAM "' run case.yaml --force -o out";
    const Ending ending = Process({"/bin/sh", "-c", command}, scratch.path()).wait();
    EXPECT_EQ(ending.code, exit_code::run_failed);
    EXPECT_TRUE(begins(ending.err, "error: out/"));
    EXPECT_TRUE(holds(ending.err, "(File too large)\n"));
    EXPECT_FALSE(datasets(scratch / "out/results.h5").empty());
  }
  // There is room again.
  EXPECT_EQ(run_sluice({"run", "case.yaml", "-o", "out", "--resume"}, scratch.path()).code, exit_code::done);
  EXPECT_EQ(run_sluice({"run", "case.yaml", "-o", "whole"}, scratch.path()).code, exit_code::done);
  expect_equal_results(scratch / "out", scratch / "whole");
}

// ---- the run -------------------------------------------------------------------------------------------------------

TEST(FailedRun, names_the_particle_that_left_the_grid) {
  const Scratch scratch;
  const std::string opened = with(column, "right: roller", "right: free");
  scratch.write("case.yaml", with(opened, "- material: sand", "- material: sand\n    velocity: [20 m/s, 0]"));
  const Ending ending = run_sluice({"run", "case.yaml", "-o", "out"}, scratch.path());
  EXPECT_EQ(ending.code, exit_code::run_failed);
  for (const auto* word : {"error: a particle left the grid: particle ", "(sand) at (6.0", "m/s, in step ", "outflow"})
    EXPECT_TRUE(holds(ending.err, word));
  EXPECT_TRUE(holds(text_of(scratch / "out/summary.json"), R"("exit_reason": "run_failed")"));
  EXPECT_FALSE(datasets(scratch / "out/results.h5").empty());

  // What the message proposes, from the state before the step that failed on: nothing that was computed is lost.
  const double failed = number_after(ending.err, "m/s, in step ");
  ASSERT_GT(failed, 1);
  const Ending resumed =
      run_sluice({"run", "case.yaml", "-o", "out", "--resume", "--set", "outflow=remove"}, scratch.path());
  EXPECT_EQ(resumed.code, exit_code::done);
  EXPECT_EQ(number_after(resumed.out, ", step "), failed - 1);
  EXPECT_EQ(names_in(scratch / "out"), promised_names());
}

/// Bit for bit the same, whether the latest checkpoint is of the step before or of the start.
TEST(FailedRun, keeps_the_state_before_the_step_that_failed) {
  const Scratch scratch;
  const std::string opened = with(column, "right: roller", "right: free");
  scratch.write("case.yaml", with(opened, "- material: sand", "- material: sand\n    velocity: [20 m/s, 0]"));
  std::vector<std::map<std::string, std::string>> kept;
  for (const std::string every : {"1e-9 s", "1 h"}) {
    SCOPED_TRACE(every);
    const Ending ending = run_sluice(
        {"run", "case.yaml", "-o", "out", "--force", "--set", "output.checkpoint_every=" + every}, scratch.path());
    ASSERT_EQ(ending.code, exit_code::run_failed) << ending.err;
    kept.push_back(datasets(scratch / "out/results.h5"));
    const auto summary = nlohmann::json::parse(text_of(scratch / "out/summary.json"));
    EXPECT_EQ(summary.at("time").get<double>(), last_number(scratch / "out/history.csv", "time_s"));
    EXPECT_EQ(summary.at("steps").get<double>(), number_after(ending.err, "m/s, in step ") - 1);
  }
  EXPECT_EQ(kept[0], kept[1]);
}

/// A pull of 1e8 g: the first step, before which nothing moves, is computed from the wave speed alone and far too long.
TEST(FailedRun, names_the_particle_whose_physics_went_bad) {
  const Scratch scratch;
  scratch.write("case.yaml", with(column, "-9.81", "-1e9"));
  const Ending ending = run_sluice({"run", "case.yaml", "-o", "out"}, scratch.path());
  EXPECT_EQ(ending.code, exit_code::bad_physics);
  for (const auto* word : {"error: the physics went bad", "particle ", "(sand) at (", "born at (", "m/s, in step 1 "})
    EXPECT_TRUE(holds(ending.err, word));
  EXPECT_TRUE(holds(text_of(scratch / "out/summary.json"), R"("exit_reason": "physics_failed")"));
  EXPECT_FALSE(datasets(scratch / "out/results.h5").empty());
  EXPECT_TRUE(std::filesystem::exists(scratch / "out/checkpoint_0.h5"));
}

/// Fast enough that a fixed step, fine at the start, breaks a limit later.
TEST(FailedRun, states_the_limit_that_a_fixed_step_breaks_on_the_way) {
  const Scratch scratch;
  scratch.write("case.yaml", with(column, "-9.81", "-300") + "scheme: {time_step: 5 ms}\n");
  const Ending ending = run_sluice({"run", "case.yaml", "-o", "out"}, scratch.path());
  EXPECT_EQ(ending.code, exit_code::bad_input);
  EXPECT_TRUE(holds(ending.err, "case.yaml:24:21: scheme.time_step of 0.005 s exceeds the "));
  EXPECT_TRUE(holds(ending.err, " limit of "));
  EXPECT_GT(last_number(scratch / "out/history.csv", "step"), 0);
}

}  // namespace sluice::test
