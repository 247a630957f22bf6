/// What the other commands print, and what the options do.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/simulation/run.h"
#include "tests/regression/program.h"
#include "tests/regression/results_folder.h"
#include "tests/regression/scratch.h"

namespace sluice::test {

TEST(CommandLine, schema_is_the_page_in_docs) {
  const Scratch scratch;
  const Ending ending = run_sluice({"schema"}, scratch.path());
  EXPECT_EQ(ending.code, exit_code::done);
  EXPECT_TRUE(ending.out == text_of(SLUICE_SOURCE_DIR "/docs/case_reference.md"))
      << "the declarations have changed; write the page anew: build/sluice schema > docs/case_reference.md";
}

TEST(CommandLine, schema_for_editors_is_json) {
  const Scratch scratch;
  const Ending ending = run_sluice({"schema", "--json"}, scratch.path());
  EXPECT_EQ(ending.code, exit_code::done);
  const auto schema = nlohmann::json::parse(ending.out);
  EXPECT_TRUE(schema.at("$schema").is_string());
  EXPECT_TRUE(schema.at("properties").contains("materials"));
}

TEST(CommandLine, list_names_what_is_registered) {
  const Scratch scratch;
  const struct {
    std::string kind, name;
  } expected[] = {{"materials", "mohr_coulomb"},
                  {"measures", "drop_of_highest_point"},
                  {"physics", "total_stress"},
                  {"shapes", "quadratic_bspline"},
                  {"transfers", "apic"}};
  const std::string kinds = run_sluice({"list"}, scratch.path()).out;
  for (const auto& [kind, name] : expected) {
    EXPECT_TRUE(holds(kinds, kind + "\n"));
    const Ending ending = run_sluice({"list", kind}, scratch.path());
    EXPECT_EQ(ending.code, exit_code::done);
    EXPECT_TRUE(holds("\n" + ending.out, "\n" + name + " "));
  }
  std::stringstream lines(kinds);
  for (std::string kind; std::getline(lines, kind);) {
    const Ending ending = run_sluice({"list", kind}, scratch.path());
    EXPECT_EQ(ending.code, exit_code::done);
    EXPECT_NE(ending.out, "") << kind;
  }
}

TEST(CommandLine, tells_its_version_and_its_options) {
  const Scratch scratch;
  const Ending version = run_sluice({"--version"}, scratch.path());
  EXPECT_EQ(version.code, exit_code::done);
  EXPECT_TRUE(begins(version.out, "sluice 0."));
  for (const auto* command : {"run", "check", "plot", "list", "schema", "element"}) {
    EXPECT_TRUE(holds(run_sluice({"--help"}, scratch.path()).out, std::string("\n  ") + command + " "));
    const Ending help = run_sluice({command, "--help"}, scratch.path());
    EXPECT_EQ(help.code, exit_code::done);
    EXPECT_NE(help.out, "");
    EXPECT_EQ(help.err, "");
  }
}

TEST(CommandLine, check_predicts_and_writes_nothing) {
  const Scratch scratch;
  scratch.write("case.yaml", column);
  const Ending ending = run_sluice({"check", "case.yaml", "--threads", "1"}, scratch.path());
  EXPECT_EQ(ending.code, exit_code::done);
  for (const auto* word : {"particles       256", "(wave)", "time step ", "steps           about 3", "on 1 thread ("})
    EXPECT_TRUE(holds(ending.out, word));
  EXPECT_EQ(names_in(scratch.path()), std::set<std::string>{"case.yaml"});
}

TEST(CommandLine, a_run_is_silent_if_told_and_otherwise_closes_with_a_table) {
  const Scratch scratch;
  scratch.write("case.yaml", column);
  const Ending quiet = run_sluice({"run", "case.yaml", "-q", "-o", "quiet"}, scratch.path());
  EXPECT_EQ(quiet.code, exit_code::done);
  EXPECT_EQ(quiet.out + quiet.err, "");
  const Ending spoken = run_sluice({"run", "case.yaml", "-o", "spoken"}, scratch.path());
  for (const auto* word :
       {"steps of 256 particles", "million particle-steps per second", "scatter", "runout = ", "results in spoken"})
    EXPECT_TRUE(holds(spoken.out, word));
  EXPECT_EQ(spoken.out.find('\r'), std::string::npos) << "a line is redrawn where there is no terminal";
}

TEST(CommandLine, set_changes_the_run_and_stands_in_the_resolved_case) {
  const Scratch scratch;
  scratch.write("case.yaml", column);
  const Ending ending = run_sluice({"run", "case.yaml", "-o", "out", "--set", "end_time=50 ms", "--set",
                                    "bodies.0.velocity=[1 m/s, 0]", "--set", "materials.sand.cohesion=25 kPa"},
                                   scratch.path());
  EXPECT_EQ(ending.code, exit_code::done) << ending.err;
  EXPECT_DOUBLE_EQ(last_number(scratch / "out/history.csv", "time_s"), 0.05);
  EXPECT_TRUE(holds(text_of(scratch / "out/case.resolved.yaml"), "cohesion: 25 kPa"));
}

/// The case names a file beside it, and is named from elsewhere, by paths with blanks.
TEST(CommandLine, a_case_runs_from_any_folder) {
  const Scratch scratch;
  std::filesystem::create_directories(scratch / "my cases/shapes");
  std::filesystem::create_directory(scratch / "elsewhere");
  scratch.write("my cases/shapes/square.yaml", "square: [[0, 0], [2, 0], [2, 2], [0, 2]]\n");
  scratch.write("my cases/a column.yaml",
                with(column, "box: {min: [0 m, 0 m], max: [2 m, 2 m]}", "polygon: shapes/square.yaml#square"));
  const Ending ending =
      run_sluice({"run", "../my cases/a column.yaml", "--output", "../my results", "--set", "end_time=0.05 s"},
                 scratch / "elsewhere");
  EXPECT_EQ(ending.code, exit_code::done) << ending.err;
  EXPECT_EQ(names_in(scratch / "my results"), promised_names());
  EXPECT_TRUE(std::filesystem::is_empty(scratch / "elsewhere"));
}

TEST(CommandLine, the_number_of_threads_does_not_change_a_bit) {
  const Scratch scratch;
  for (const auto& [name, text] :
       {std::pair{std::string("column"), with(column, "cell: 0.25 m", "cell: 0.1 m")}, {std::string("block"), block}}) {
    SCOPED_TRACE(name);
    scratch.write(name + ".yaml", text);
    for (const std::string threads : {"1", "2", "3"}) {
      const Ending ending =
          run_sluice({"run", name + ".yaml", "-o", name + threads, "--threads", threads, "--set", "end_time=0.2 s"},
                     scratch.path());
      ASSERT_EQ(ending.code, exit_code::done) << ending.err;
      if (threads != "1") expect_equal_results(scratch / (name + threads), scratch / (name + "1"));
    }
  }
}

}  // namespace sluice::test
