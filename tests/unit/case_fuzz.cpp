/// Random damage to the shipped case files: the reader must refuse what is wrong with a CaseError that says where, and
/// never crash, hang, or throw anything else. What it accepts must survive a round trip through case.resolved.yaml.
///
/// Each test takes some seconds; SLUICE_FUZZ_SECONDS=600 in the environment makes a long search of it, and
/// SLUICE_FUZZ_SEED begins it elsewhere. A failure prints the damaged text, which then belongs in a test of its own.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <random>
#include <sstream>

#include "core/case/case.h"
#include "core/case/node.h"
#include "core/case/resolved_case.h"
#include "core/simulation/physics_module.h"
#include "core/simulation/simulation.h"
#include "physics/element/element_case.h"

namespace sluice {
namespace {

using Random = std::mt19937_64;

std::size_t below(Random& random, std::size_t count) { return count == 0 ? 0 : random() % count; }

double number_from(const char* variable, double otherwise) {
  const char* const text = std::getenv(variable);
  return text == nullptr ? otherwise : std::strtod(text, nullptr);
}

std::string read_file(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// Case files of a folder, by name.
std::vector<std::pair<std::string, std::string>> files_of(const std::filesystem::path& folder) {
  std::vector<std::pair<std::string, std::string>> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.path().extension() == ".yaml") files.emplace_back(entry.path().string(), read_file(entry.path()));
  std::sort(files.begin(), files.end());
  return files;
}

bool of_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || std::strchr("_.+-", c) != nullptr; }

/// Where a random word of the text begins and ends; equal if the text has none at the place that was tried.
std::pair<std::size_t, std::size_t> any_word(const std::string& text, Random& random) {
  std::size_t begin = below(random, text.size()), end = begin;
  while (begin > 0 && of_word(text[begin - 1])) --begin;
  while (end < text.size() && of_word(text[end])) ++end;
  return {begin, end};
}

std::pair<std::size_t, std::size_t> any_line(const std::string& text, Random& random) {
  const std::size_t at = below(random, text.size());
  const std::size_t before = at == 0 ? std::string::npos : text.rfind('\n', at - 1), after = text.find('\n', at);
  return {before == std::string::npos ? 0 : before + 1, after == std::string::npos ? text.size() : after + 1};
}

const std::vector<std::string>& odd_values() {
  static const std::vector<std::string> values{
      "-1",    "0",       "1e308",  "-1e308",  "1e-320", "nan",   ".inf",  "-.inf",   "1e999",     "0x10",
      "true",  "null",    "~",      "''",      "[]",     "{}",    "[1]",   "[[1, 2]", "{a: 1}",    "*anchor",
      "&a b",  "!!int 3", "1 kPa",  "1 kPa/s", "1 m m",  "3 m 4", "%",     "@",       "a#b",       "#",
      "1e3 m", "-5 deg",  "1e-9 m", "1e9 m",   "1_000",  "1,5",   "2.5.1", "\"\"",    "\xff\xfe",  "\t",
      "- -",   ": :",     "? x",    "|",       ">-",     "---",   "...",   "<<: *a",  "polygon#x", "../../x.yaml#y"};
  return values;
}

/// One random act of damage, with words of `other` where it needs some.
void damage(std::string& text, const std::string& other, Random& random) {
  const auto word = any_word(text, random), line = any_line(text, random), from = any_word(other, random);
  const std::string foreign = other.substr(from.first, from.second - from.first);
  switch (below(random, 10)) {
    case 0:  // a word of a case replaced by one of another
      text.replace(word.first, word.second - word.first, foreign);
      break;
    case 1:  // or by something odd
    case 2:
      text.replace(word.first, word.second - word.first, odd_values()[below(random, odd_values().size())]);
      break;
    case 3:  // a letter changed, as by a slip of the hand
      if (word.second > word.first)
        text[word.first + below(random, word.second - word.first)] = static_cast<char>('a' + below(random, 26));
      break;
    case 4:  // a line lost
      text.erase(line.first, line.second - line.first);
      break;
    case 5:  // a line twice
      text.insert(line.first, text.substr(line.first, line.second - line.first));
      break;
    case 6: {  // a line of another case
      const auto other_line = any_line(other, random);
      text.insert(line.first, other.substr(other_line.first, other_line.second - other_line.first));
      break;
    }
    case 7:  // indented otherwise
      text.insert(line.first, std::string(1 + below(random, 4), ' '));
      break;
    case 8:  // cut off
      if (below(random, 8) == 0) text.resize(below(random, text.size()));
      break;
    default:  // any byte anywhere
      if (!text.empty()) text[below(random, text.size())] = static_cast<char>(below(random, 256));
  }
}

/// Damages files at random, each by one to four acts, and gives them to `read` until time is up.
template <class Read>
void fuzz(const std::filesystem::path& folder, const Read& read) {
  using Clock = std::chrono::steady_clock;
  const auto files = files_of(folder);
  ASSERT_FALSE(files.empty());
  const auto seed = static_cast<std::uint64_t>(number_from("SLUICE_FUZZ_SEED", 1));
  const auto end = Clock::now() + std::chrono::duration<double>(number_from("SLUICE_FUZZ_SECONDS", 4));
  std::size_t accepted = 0, refused = 0;
  for (std::uint64_t round = 0; Clock::now() < end && !testing::Test::HasFailure(); ++round) {
    Random random(seed * 1'000'003 + round);
    const auto& [name, whole] = files[below(random, files.size())];
    std::string text = whole;
    for (std::size_t acts = 1 + below(random, 4); acts > 0; --acts)
      damage(text, files[below(random, files.size())].second, random);
    SCOPED_TRACE(name + ", round " + std::to_string(round) + ":\n" + text);
    const std::clock_t start = std::clock();
    try {
      read(text, name);
      ++accepted;
    } catch (const CaseError& error) {
      // Of this file, or of one that it extends or refers to.
      EXPECT_NE(std::string(error.what()).find(".yaml"), std::string::npos) << error.what();
      ++refused;
    } catch (const std::exception& error) {
      ADD_FAILURE() << "an exception that is no CaseError: " << error.what();
    }
    EXPECT_LT(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC, 20)
        << "as good as hangs";  // of the processor
  }
  if (std::getenv("SLUICE_FUZZ_SECONDS") != nullptr)
    std::cout << accepted << " files accepted, " << refused << " refused\n";
  // The damage is neither too little nor too much to find anything.
  EXPECT_GT(accepted, 0u);
  EXPECT_GT(refused, 10u);
}

TEST(CaseFuzz, DamagedCasesAreRefusedOrSurviveARoundTrip) {
  fuzz(SLUICE_CASES_DIR, [](const std::string& text, const std::string& name) {
    const Case once = parse_case(text, name);
    const std::string resolved = resolved_yaml(once);
    try {
      EXPECT_EQ(resolved_yaml(parse_case(resolved, "case.resolved.yaml")), resolved);
    } catch (const CaseError& error) {
      ADD_FAILURE() << "the resolved case is refused: " << error.what() << "\n" << resolved;
    }
  });
}

/// Whether a scene is small enough to be set up many times a second.
bool is_small(const Case& definition) {
  double cells = 1, points = 0;
  for (std::size_t a = 0; a < definition.grid.min.size(); ++a)
    cells *= (definition.grid.max[a] - definition.grid.min[a]) / definition.grid.cell[a];
  for (const BodyCase& body : definition.bodies) points += cells * body.particles_per_cell;
  return points < 30'000;
}

// What the modules refuse, they refuse before the first step or in it, and say why.
TEST(CaseFuzz, DamagedCasesRunOrAreRefused) {
  fuzz(SLUICE_CASES_DIR, [](const std::string& text, const std::string& name) {
    const Case definition = parse_case(text, name);
    if (!is_small(definition)) throw CaseError(name + ": left out");
    try {
      const auto simulation = Simulation::create(definition);
      simulation->advance(definition.end_time);
    } catch (const PhysicsError&) {
    } catch (const CaseError& error) {
      throw CaseError(name + ": " + error.what());
    }
  });
}

TEST(CaseFuzz, DamagedElementTestsAreRefused) {
  fuzz(std::filesystem::path(SLUICE_CASES_DIR) / "element",
       [](const std::string& text, const std::string& name) { element::parse_element(text, name); });
}

}  // namespace
}  // namespace sluice
