/// Pictures: what is promised is drawn.
#include <gtest/gtest.h>

#include <filesystem>

#include "core/simulation/run.h"
#include "tests/regression/program.h"
#include "tests/regression/results_folder.h"
#include "tests/regression/scratch.h"

namespace sluice::test {

namespace {

namespace fs = std::filesystem;

void expect_pictures(const fs::path& folder, const std::set<std::string>& names) {
  EXPECT_EQ(names_in(folder), names);
  for (const auto& name : names) {
    const std::string text = text_of(folder / name);
    EXPECT_GT(text.size(), 2000u) << name;
    EXPECT_TRUE(begins(text.substr(0, 8), name.ends_with(".png") ? "\x89PNG\r\n\x1a\n" : "GIF8")) << name;
  }
}

/// The results of a case, in "out".
class Pictures : public testing::Test {
 protected:
  void run(const std::string& text, const std::vector<std::string>& options = {}) {
    scratch_.write("case.yaml", text);
    std::vector<std::string> words = {"run", "case.yaml", "-o", "out"};
    words.insert(words.end(), options.begin(), options.end());
    const Ending ending = run_sluice(words, scratch_.path());
    ASSERT_EQ(ending.code, exit_code::done) << ending.err;
    EXPECT_EQ(ending.err, "");
  }

  Ending plot(const std::vector<std::string>& options = {}) {
    std::vector<std::string> words = {"plot", "out"};
    words.insert(words.end(), options.begin(), options.end());
    return run_sluice(words, scratch_.path());
  }

  Scratch scratch_;
};

}  // namespace

TEST_F(Pictures, of_a_run_are_those_that_the_case_asks_for) {
  run(with(column, "every: 0.1 s", "every: 0.1 s, pictures: [displacement], picture_times: [0 s, 1 s]"));
  expect_pictures(scratch_ / "out/pictures",
                  {"displacement.gif", "displacement.png", "history.png", "observations.png"});
  auto names = promised_names();
  names.insert("pictures");
  EXPECT_EQ(names_in(scratch_ / "out"), names);
}

TEST_F(Pictures, are_plastic_strain_materials_and_displacement_unless_told_otherwise) {
  run(column);
  const Ending ending = plot();
  EXPECT_EQ(ending.code, exit_code::done) << ending.err;
  const std::set<std::string> names = {"displacement.png", "equivalent_plastic_strain.png", "history.png",
                                       "material.png", "observations.png"};
  expect_pictures(scratch_ / "out/pictures", names);
  for (const auto& name : names) EXPECT_TRUE(holds(ending.out, "out/pictures/" + name));
}

TEST_F(Pictures, are_of_the_fields_and_times_that_are_asked_for_and_can_move) {
  run(column);
  const Ending ending = plot({"--fields", "velocity", "stress", "--times", "0", "0.52", "--animation"});
  EXPECT_EQ(ending.code, exit_code::done) << ending.err;
  expect_pictures(scratch_ / "out/pictures",
                  {"history.png", "observations.png", "stress.png", "velocity.gif", "velocity.png"});
}

TEST_F(Pictures, of_three_dimensions_show_a_section_and_a_view) {
  run(block);
  const Ending ending = plot({"--fields", "displacement", "material", "--times", "0.2", "--animation"});
  EXPECT_EQ(ending.code, exit_code::done) << ending.err;
  expect_pictures(scratch_ / "out/pictures", {"displacement.gif", "displacement.png", "displacement_3d.png",
                                              "history.png", "material.png", "material_3d.png", "observations.png"});
}

/// The names of the axes are those of the case file and of the messages: in plane strain y points up, in 3-D z.
TEST_F(Pictures, name_the_axes_as_the_case_does) {
  for (const auto& [text, upwards] : {std::pair{column, "y [m]"}, {block, "z [m]"}}) {
    run(text, {"--set", "end_time=0.05 s", "--force"});
    const std::string program =
        "import sys\n"
        "sys.dont_write_bytecode = True\n"
        "sys.path.insert(0, '" SLUICE_SOURCE_DIR
        "/core/output')\n"
        "import pictures\n"
        "results = pictures.Results('out')\n"
        "pictures.plt.Figure.savefig = lambda figure, *a, **k: print(figure.axes[0].get_xlabel(), "
        "figure.axes[0].get_ylabel())\n"
        "pictures.draw_field(results, pictures.View(results), 'displacement', [0], 'one.png')\n";
    const Ending ending = Process({"/usr/bin/python3", "-c", program}, scratch_.path()).wait();
    EXPECT_EQ(ending.code, exit_code::done) << ending.err;
    EXPECT_EQ(ending.out, std::string("x [m] ") + upwards + "\n");
  }
}

TEST_F(Pictures, of_a_field_that_is_not_there_are_refused_with_those_that_are) {
  run(column, {"--set", "end_time=0.05 s"});
  const Ending ending = plot({"--fields", "temperature"});
  EXPECT_NE(ending.code, exit_code::done);
  for (const auto* word : {"has no field temperature", "displacement", "equivalent_plastic_strain", "velocity"})
    EXPECT_TRUE(holds(ending.err, word));
  EXPECT_FALSE(fs::exists(scratch_ / "out/pictures"));
}

/// Without Python the run is complete all the same.
TEST_F(Pictures, that_cannot_be_drawn_do_not_fail_a_run) {
  scratch_.write("case.yaml", with(column, "every: 0.1 s", "every: 0.1 s, pictures: [displacement]"));
  const std::string command = "SLUICE_PYTHON=/no/python exec '" SLUICE_PROGRAM "' run case.yaml -o out";
  const Ending ending = Process({"/bin/sh", "-c", command}, scratch_.path()).wait();
  EXPECT_EQ(ending.code, exit_code::done);
  EXPECT_TRUE(holds(ending.err, "warning: the pictures could not be drawn"));
  EXPECT_TRUE(holds(ending.err, "/no/python"));
  EXPECT_EQ(names_in(scratch_ / "out"), promised_names());
}

}  // namespace sluice::test
