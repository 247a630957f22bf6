/// The YAML tree, near words, catalogues.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "core/case/node.h"
#include "core/case/registry.h"

namespace sluice {
namespace {

template <class Act>
std::string message_of(const Act& act) {
  try {
    act();
  } catch (const CaseError& error) {
    return error.what();
  }
  return "";
}

std::string message_of_text(const std::string& text) {
  return message_of([&] { read_yaml_text(text, "a.yaml"); });
}

TEST(Node, KnowsItsPlace) {
  const Node tree = read_yaml_text("grid:\n  min: [0 m, '1 m']\n  cell: 1 m\n", "a.yaml");
  const Node* const grid = tree.find("grid");
  ASSERT_NE(grid, nullptr);
  EXPECT_EQ(tree.keys[0].second.text(), "a.yaml:1:1");
  EXPECT_EQ(grid->keys[1].second.text(), "a.yaml:3:3");
  const Node* const min = grid->find("min");
  EXPECT_EQ(min->place.text(), "a.yaml:2:8");
  EXPECT_EQ(min->items[1].place.text(), "a.yaml:2:14");
  EXPECT_EQ(min->items[1].scalar, "1 m");
  EXPECT_TRUE(min->items[1].quoted);
  EXPECT_FALSE(min->items[0].quoted);
  EXPECT_EQ(grid->find("max"), nullptr);
}

TEST(Node, AliasesAreCopiesOfTheirAnchors) {
  const Node tree = read_yaml_text("a: &soil {density: 1800 kg/m3}\nb: *soil\n", "a.yaml");
  EXPECT_EQ(tree.find("b")->find("density")->scalar, "1800 kg/m3");
}

TEST(Node, BrokenYamlIsLocated) {
  EXPECT_EQ(message_of_text("a: 1\nb: [1, 2\nc: 3\n").substr(0, 25), "a.yaml:3:2: YAML syntax: ");
  EXPECT_EQ(message_of_text("a: b: c\n").substr(0, 25), "a.yaml:1:5: YAML syntax: ");
  EXPECT_NE(message_of_text("a: *nothing\n").find("a.yaml:1:4: YAML syntax: "), std::string::npos);
  EXPECT_EQ(message_of_text("a: 1\nb: 2\na: 3\n"), "a.yaml:3:1: the key 'a' occurs twice; the first is at a.yaml:1:1");
  EXPECT_EQ(message_of_text("a: 1\n---\nb: 2\n"),
            "a.yaml:1:1: the file holds 2 YAML documents (separated by ---); it must hold one");
  EXPECT_NE(message_of_text("? [1, 2]\n: 3\n"), "");
}

// Found by fuzzing: yaml-cpp's LoadAll reads such texts for ever, as documents of nothing, until there is no memory
// left.
TEST(Node, WhatCannotBeginADocumentIsLocated) {
  for (const char* first : {", b: 2", "] b", "} b", ",", ": , b"})
    EXPECT_EQ(message_of_text(std::string("# a comment\n") + first + "\na: 1\n").find("a.yaml:2:"), 0u) << first;
  EXPECT_EQ(message_of_text("a: 1\n, b: 2\n").find("a.yaml:2:1: YAML syntax: "), 0u);
  EXPECT_EQ(message_of_text("a: 1\n---\n, b: 2\n").find("a.yaml:3:1: YAML syntax: "), 0u);
}

TEST(Node, AliasesThatRunAwayAreErrors) {
  EXPECT_NE(message_of_text("&a [*a]\n"), "");
  std::string bomb = "a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]\n";
  for (int i = 1; i < 10; ++i) {
    const std::string last = "*a" + std::to_string(i - 1);
    bomb += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [" + last;
    for (int k = 0; k < 9; ++k) bomb += ", " + last;
    bomb += "]\n";
  }
  EXPECT_NE(message_of_text(bomb).find("more than 2 million values"), std::string::npos);
}

TEST(Node, MissingFilesNameTheNearest) {
  const auto folder = std::filesystem::path(testing::TempDir()) / "sluice_case_node";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "dam.yaml") << "a: 1\n";
  const std::string wrong = (folder / "damm.yaml").string();
  EXPECT_EQ(message_of([&] { read_yaml_file(wrong); }),
            wrong + ": no such file; did you mean '" + (folder / "dam.yaml").string() + "'?");
  EXPECT_EQ(message_of([&] { read_yaml_file(folder.string()); }), folder.string() + ": is a folder, not a file");
  EXPECT_EQ(read_yaml_file((folder / "dam.yaml").string()).find("a")->scalar, "1");
  std::filesystem::remove_all(folder);
}

TEST(Node, WrittenTextReadsBackAsTheSameTree) {
  const std::string text =
      "title: \"a: b # c\"\nquote: \"say \\\"x\\\"\"\nnothing: \"null\"\nempty: \"\"\ntilde: \"~\"\ndash: \"- a\"\n"
      "lines: \"one\\ntwo\"\nlist: [[-250 m, 0.5], [1e-5 m/s, 5 %]]\nnone: []\nmap: {}\n"
      "bodies:\n  - {a: {b: [1, 2]}}\n  - {a: 1, b: {c: {d: 1}}}\n\"key: odd\": 1\n";
  const std::string once = yaml_text(read_yaml_text(text, "a"));
  EXPECT_EQ(yaml_text(read_yaml_text(once, "b")), once);
  const Node back = read_yaml_text(once, "b");
  EXPECT_EQ(back.find("title")->scalar, "a: b # c");
  EXPECT_EQ(back.find("quote")->scalar, "say \"x\"");
  EXPECT_EQ(back.find("nothing")->kind, Node::Kind::scalar);
  EXPECT_EQ(back.find("tilde")->scalar, "~");
  EXPECT_EQ(back.find("lines")->scalar, "one\ntwo");
  EXPECT_EQ(back.find("list")->items[0].items[0].scalar, "-250 m");
  EXPECT_EQ(back.find("none")->kind, Node::Kind::list);
  EXPECT_EQ(back.find("bodies")->items[1].find("b")->find("c")->find("d")->scalar, "1");
  EXPECT_EQ(back.find("key: odd")->scalar, "1");
}

TEST(NearestWord, FindsWhatWasMeant) {
  const std::vector<std::string> words = {"density", "youngs_modulus", "poisson_ratio", "cohesion"};
  EXPECT_EQ(nearest_word("desnity", words), "density");  // swapped
  EXPECT_EQ(nearest_word("densty", words), "density");   // left out
  EXPECT_EQ(nearest_word("Young's modulus", words), "youngs_modulus");
  EXPECT_EQ(nearest_word("poisson", words), "poisson_ratio");  // a part of it
  EXPECT_EQ(nearest_word("permeability", words), "");
  EXPECT_EQ(nearest_word("x", {"y", "z"}), "");
  EXPECT_EQ(nearest_word("", words), "");
  EXPECT_EQ(nearest_word("abc", {}), "");
}

TEST(Catalogue, UnknownNamesGetTheNearest) {
  Registry<int> models("material model", "");
  models.add("linear_elastic", {"", {}}, 1);
  models.add("mohr_coulomb", {"", {}}, 2);
  EXPECT_EQ(models.find("mohr_coulomb", {}), 2);
  EXPECT_EQ(message_of([&] {
              models.require("mohr_columb", {"dam.yaml", 12, 5});
            }),
            "dam.yaml:12:5: unknown material model 'mohr_columb'; allowed: linear_elastic, mohr_coulomb; did you mean "
            "'mohr_coulomb'?");
}

}  // namespace
}  // namespace sluice
