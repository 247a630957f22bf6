/// Tables in time: values, reading, messages.
#include "core/case/table.h"

#include <gtest/gtest.h>

#include "core/case/case_tree.h"

namespace sluice {
namespace {

Table read(const Node& node) {
  Problems problems;
  const auto table = value::table(node, "pressure", unit::stress, at_least(0), problems);
  problems.throw_if_any();
  return table.value();
}

Table read(const std::string& text) { return read(*read_yaml_text("pressure: " + text, "t.yaml").find("pressure")); }

std::string message_of(const std::string& text) {
  try {
    read(text);
  } catch (const CaseError& error) {
    return error.what();
  }
  return "";
}

TEST(Table, IsConstantWhereOneValueIsGiven) {
  const Table table = read("2 kPa");
  for (const double t : {-1.0, 0.0, 1e9}) EXPECT_EQ(table.at(t), 2000);
}

TEST(Table, IsLinearBetweenPointsAndConstantBeyondThem) {
  const Table table = read("[[1 s, 10 Pa], [3 s, 20 Pa], [1 min, 0]]");
  EXPECT_EQ(table.at(-5), 10);
  EXPECT_EQ(table.at(1), 10);
  EXPECT_EQ(table.at(2), 15);
  EXPECT_EQ(table.at(3), 20);
  EXPECT_DOUBLE_EQ(table.at(31.5), 10);
  EXPECT_EQ(table.at(60), 0);
  EXPECT_EQ(table.at(61), 0);
}

TEST(Table, WritesWhatItReads) {
  for (const char* text : {"2 kPa", "[[0 s, 1 kPa]]", "[[1 s, 10 Pa], [3 s, 20 Pa], [1 min, 0]]"}) {
    const Table table = read(text), again = read(value::from_table(table, unit::stress));
    EXPECT_EQ(again.value, table.value) << text;
    for (const double t : {0.0, 1.0, 2.0, 50.0}) EXPECT_EQ(again.at(t), table.at(t)) << text;
  }
}

TEST(Table, SaysWhatIsWrongAndWhere) {
  EXPECT_EQ(message_of("[]"),
            "t.yaml:1:11: pressure: found an empty list; expected a value or points [[time, value], …]");
  EXPECT_EQ(message_of("[[0 s, 1 Pa], [0 s, 2 Pa]]"),
            "t.yaml:1:25: pressure: the time 0 s must be after the one before it, 0 s");
  EXPECT_EQ(message_of("[[2 s, 1 Pa], [1 s, 2 Pa]]"),
            "t.yaml:1:25: pressure: the time 1 s must be after the one before it, 2 s");
  EXPECT_NE(message_of("[[0 s, 1 Pa, 2 Pa]]").find("t.yaml:1:12: pressure: found "), std::string::npos);
  EXPECT_NE(message_of("[0 s, 1 Pa]").find("expected a point [time, value]"), std::string::npos);
  EXPECT_NE(message_of("[[1 m, 1 Pa]]").find("t.yaml:1:13: pressure, time: found '1 m', a length"), std::string::npos)
      << message_of("[[1 m, 1 Pa]]");
  EXPECT_EQ(message_of("[[1 s, -1 Pa]]"), "t.yaml:1:18: pressure is -1 Pa; it must be at least 0");
  EXPECT_NE(message_of("-1 Pa").find("must be at least 0"), std::string::npos) << message_of("-1 Pa");
  EXPECT_NE(message_of("{a: 1}").find("t.yaml:1:11"), std::string::npos) << message_of("{a: 1}");
}

}  // namespace
}  // namespace sluice
