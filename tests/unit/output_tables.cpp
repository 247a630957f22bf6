#include <limits>
#include <nlohmann/json.hpp>

#include "core/output/csv_table.h"
#include "core/output/summary.h"
#include "tests/unit/output_fixture.h"

namespace sluice {
namespace {

using test::content;
using test::ScratchFolder;

const std::vector<std::string> columns{"step", "time_s", "limiter"};

TEST(CsvTable, NumbersReadBackExactly) {
  const ScratchFolder folder;
  CsvTable table(folder / "t.csv", {"value"});
  const std::vector<double> values{1.0 / 3, 1e-300, -123456789.123456789, 0.1 + 0.2};
  for (const double value : values) table.append({value});
  std::ifstream file(folder / "t.csv");
  std::string line;
  std::getline(file, line);
  for (const double value : values) {
    std::getline(file, line);
    EXPECT_EQ(std::stod(line), value);
  }
}

TEST(CsvTable, TextIsQuotedWhereNeededAndRowsAreFlushed) {
  const ScratchFolder folder;
  CsvTable table(folder / "t.csv", columns);
  table.append({std::int64_t{1}, 0.5, "wave, \"fast\""});
  EXPECT_EQ(content(folder / "t.csv"), "step,time_s,limiter\n1,0.5,\"wave, \"\"fast\"\"\"\n");
}

TEST(CsvTable, ResumeDropsLaterRowsAndACutLine) {
  const ScratchFolder folder;
  {
    CsvTable table(folder / "t.csv", columns);
    for (int i = 0; i < 6; ++i) table.append({std::int64_t{i}, 0.1 * i, i % 2 ? "a,b" : "wave"});
  }
  std::ofstream(folder / "t.csv", std::ios::app) << "7,0.05";
  CsvTable table(folder / "t.csv", columns, "time_s", 0.1 * 3);
  table.append({std::int64_t{4}, 0.4, "wave"});
  EXPECT_EQ(content(folder / "t.csv"),
            "step,time_s,limiter\n0,0,wave\n1,0.1,\"a,b\"\n2,0.2,wave\n3,0.30000000000000004,\"a,b\"\n4,0.4,wave\n");
}

TEST(CsvTable, ResumeWithOtherColumnsIsRefusedAndWithoutFileBegins) {
  const ScratchFolder folder;
  { CsvTable table(folder / "t.csv", {"time_s", "front_m"}); }
  try {
    CsvTable table(folder / "t.csv", {"time_s", "drop_m"}, "time_s", 1);
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("front_m"), std::string::npos);
  }
  EXPECT_EQ(content(folder / "t.csv"), "time_s,front_m\n");
  { CsvTable table(folder / "new.csv", columns, "time_s", 1); }
  EXPECT_EQ(content(folder / "new.csv"), "step,time_s,limiter\n");
}

TEST(Summary, AllEntries) {
  const ScratchFolder folder;
  Summary summary;
  summary.exit_reason = "end_time_reached";
  summary.steps = 50000;
  summary.particles = 21800;
  summary.particle_steps_per_second = 3e7;
  summary.stage_seconds["scatter"] = 1.5;
  summary.observations["runout"] = 38.25;
  summary.observations["lost"] = std::numeric_limits<double>::quiet_NaN();
  summary.extra["peak_memory_bytes"] = 1e8;
  write_summary(folder / "summary.json", summary);
  const auto json = nlohmann::json::parse(content(folder / "summary.json"));
  EXPECT_EQ(json.at("exit_reason"), "end_time_reached");
  EXPECT_EQ(json.at("steps"), 50000);
  EXPECT_EQ(json.at("stage_seconds").at("scatter"), 1.5);
  EXPECT_EQ(json.at("observations").at("runout"), 38.25);
  EXPECT_TRUE(json.at("observations").at("lost").is_null());
  EXPECT_EQ(json.at("peak_memory_bytes"), 1e8);
  for (const auto* key : {"particles", "threads", "wall_seconds", "particle_steps_per_second", "time", "version"})
    EXPECT_TRUE(json.contains(key)) << key;
}

}  // namespace
}  // namespace sluice
