/// `sluice element` as a user runs it: shipped files, what is left in the folder, exit codes and messages.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "core/simulation/run.h"
#include "tests/regression/program.h"
#include "tests/regression/results_folder.h"
#include "tests/regression/scratch.h"

namespace sluice::test {

namespace {

namespace fs = std::filesystem;

const std::string oedometer =
    "schema: 1\n"
    "material: {model: linear_elastic, density: 1800 kg/m3, youngs_modulus: 10 MPa, poisson_ratio: 0.25}\n"
    "initial_void_ratio: 0.8\n"
    "path: {type: oedometer, strain: 1 %}\n"
    "increments: 10\n"
    "output: {every: 5}\n";

std::vector<fs::path> shipped_files() {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(fs::path(SLUICE_CASES_DIR) / "element"))
    if (entry.path().extension() == ".yaml") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

// Each leaves tables of as many rows with and without controlled error, whose ends agree to 1 % of the largest stress;
// each says in a comment at its head why it is there; what is resolved gives the same table.
TEST(Element, shipped_files_run_and_agree_with_their_reference) {
  const auto files = shipped_files();
  ASSERT_GE(files.size(), 5u);
  for (const auto& file : files) {
    SCOPED_TRACE(file.string());
    EXPECT_TRUE(begins(text_of(file), "# Why: "));
    const Scratch scratch;
    const Ending ending = run_sluice({"element", file.string(), "-o", "out", "--no-picture"}, scratch.path());
    ASSERT_EQ(ending.code, exit_code::done) << ending.err;
    EXPECT_EQ(ending.err, "");
    EXPECT_TRUE(holds(ending.out, "reference with tolerance 1e-06: stress differs by up to"));
    EXPECT_EQ(names_in(scratch / "out"),
              (std::set<std::string>{"element.csv", "reference.csv", "element.resolved.yaml"}));
    const auto found = table(scratch / "out/element.csv"), expected = table(scratch / "out/reference.csv");
    ASSERT_EQ(found.at("time_s").size(), expected.at("time_s").size());
    double largest = 0;
    for (const std::string& q : found.at("mises_stress_Pa")) largest = std::max(largest, std::stod(q));
    EXPECT_NEAR(last_number(scratch / "out/element.csv", "mises_stress_Pa"),
                last_number(scratch / "out/reference.csv", "mises_stress_Pa"), 0.01 * largest);

    const Ending again =
        run_sluice({"element", "out/element.resolved.yaml", "-o", "again", "--no-picture", "-q"}, scratch.path());
    ASSERT_EQ(again.code, exit_code::done) << again.err;
    EXPECT_EQ(again.out + again.err, "");
    EXPECT_EQ(text_of(scratch / "again/element.csv"), text_of(scratch / "out/element.csv"));
  }
}

// M = E (1 - nu) / ((1 + nu) (1 - 2 nu)) = 12 MPa; strains are logarithmic, hence e = 1.8 exp(-0.01) - 1.
TEST(Element, table_and_picture) {
  const Scratch scratch;
  scratch.write("e.yaml", oedometer);
  const Ending ending = run_sluice({"element", "e.yaml"}, scratch.path());
  ASSERT_EQ(ending.code, exit_code::done) << ending.err;
  const auto rows = table(scratch / "results/e/element.csv");
  EXPECT_EQ(rows.at("time_s"), (std::vector<std::string>{"0", "50", "100"}));
  EXPECT_NEAR(std::stod(rows.at("stress_zz_Pa").back()), -120e3, 1e-4);
  EXPECT_NEAR(std::stod(rows.at("pressure_Pa").back()), (120e3 + 2 * 40e3) / 3, 1e-4);
  EXPECT_NEAR(std::stod(rows.at("void_ratio").back()), 1.8 * std::exp(-0.01) - 1, 1e-12);
  EXPECT_EQ(rows.at("stage").back(), "oedometer");
  EXPECT_GT(fs::file_size(scratch / "results/e/pictures/element.png"), 10000u);
}

TEST(Element, options) {
  const Scratch scratch;
  scratch.write("e.yaml", oedometer);
  const Ending first = run_sluice(
      {"element", "e.yaml", "-o", "out", "--no-reference", "--no-picture", "--set", "path.strain=2 %"}, scratch.path());
  EXPECT_EQ(first.code, exit_code::done) << first.err;
  EXPECT_FALSE(fs::exists(scratch / "out/reference.csv"));
  EXPECT_NEAR(last_number(scratch / "out/element.csv", "strain_zz"), -0.02, 1e-12);
  const auto before = fingerprint(scratch.path());
  const Ending second = run_sluice({"element", "e.yaml", "-o", "out"}, scratch.path());
  EXPECT_EQ(second.code, exit_code::bad_input);
  EXPECT_TRUE(
      holds(second.err, "the output folder out is not empty; take another --output, or overwrite it with --force"));
  EXPECT_EQ(changes(before, fingerprint(scratch.path())), "");
  EXPECT_EQ(run_sluice({"element", "e.yaml", "-o", "out", "--force", "--no-picture"}, scratch.path()).code,
            exit_code::done);
  EXPECT_NEAR(last_number(scratch / "out/element.csv", "strain_zz"), -0.01, 1e-12);
  const Ending help = run_sluice({"element", "--help"}, scratch.path());
  EXPECT_EQ(help.code, exit_code::done);
  for (const auto* word : {"--no-reference", "triaxial_compression"}) EXPECT_TRUE(holds(help.out, word));
}

TEST(Element, bad_input_is_refused_and_nothing_is_written) {
  const Scratch scratch;
  scratch.write("e.yaml", with(oedometer, "type: oedometer", "type: odometer"));
  scratch.write("outside.yaml", with(with(oedometer, "linear_elastic,", "von_mises, strength: 1 kPa,"),
                                     "initial_void_ratio: 0.8", "initial_stress: [0, 0, -5 kPa, 0, 0, 0]"));
  const auto before = fingerprint(scratch.path());
  const Ending ending = run_sluice({"element", "e.yaml"}, scratch.path());
  EXPECT_EQ(ending.code, exit_code::bad_input);
  EXPECT_TRUE(begins(ending.err, "error: e.yaml:4:14: type: found 'odometer'"));
  EXPECT_TRUE(holds(ending.err, "did you mean 'oedometer'?"));
  const Ending outside = run_sluice({"element", "outside.yaml"}, scratch.path());
  EXPECT_EQ(outside.code, exit_code::bad_input);
  EXPECT_TRUE(holds(outside.err, "outside.yaml:3:17: the initial stress is more than the material bears"));
  EXPECT_EQ(run_sluice({"element", "e.yml"}, scratch.path()).code, exit_code::bad_input);
  EXPECT_EQ(run_sluice({"element"}, scratch.path()).code, exit_code::bad_input);
  EXPECT_EQ(changes(before, fingerprint(scratch.path())), "");
}

// Stress beyond the strength: the physics has no answer. The rows up to there are kept.
TEST(Element, stops_where_no_strain_leads_to_the_stress) {
  const Scratch scratch;
  scratch.write("e.yaml", with(with(oedometer, "linear_elastic,", "von_mises, strength: 10 kPa,"),
                               "type: oedometer, strain: 1 %", "type: direct_simple_shear, stress: 20 kPa"));
  const Ending ending = run_sluice({"element", "e.yaml", "-o", "out", "--no-picture"}, scratch.path());
  EXPECT_EQ(ending.code, exit_code::bad_physics);
  EXPECT_TRUE(holds(ending.err, "error: direct_simple_shear: no strain leads to the given stress at time 50"));
  EXPECT_TRUE(holds(ending.err, "the strength may be reached"));
  EXPECT_NEAR(last_number(scratch / "out/element.csv", "stress_xz_Pa"), 10e3, 1);
}

}  // namespace sluice::test
