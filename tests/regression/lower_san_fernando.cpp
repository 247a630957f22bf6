/// The dam in full, against what was observed and published.
///
/// Source: the advance of the upstream toe in 1971, and the analysis of Tjung and Soga: 36 to 50 m. The crest lost 11
/// to 15 m. docs/validation.md compares in detail; here the bands only guard against change.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "core/output/hdf5_file.h"
#include "core/simulation/run.h"
#include "tests/regression/program.h"
#include "tests/regression/results_folder.h"
#include "tests/regression/scratch.h"

namespace sluice::test {

namespace {

/// The observations at the end of a case in full.
nlohmann::json observations_of(const std::string& name, const Scratch& scratch,
                               const std::vector<std::string>& options = {}) {
  std::vector<std::string> words = {
      "run",           SLUICE_CASES_DIR "/" + name + ".yaml", "--output", "out", "--set", "output.pictures=[]", "--set",
      "output.every=0"};
  words.insert(words.end(), options.begin(), options.end());
  const Ending ending = run_sluice(words, scratch.path());
  EXPECT_EQ(ending.code, exit_code::done) << ending.err;
  const auto summary = nlohmann::json::parse(text_of(scratch / "out/summary.json"));
  EXPECT_NEAR(summary.at("particles").get<double>(), 21823, 30);  // the paper's number; ours depends on the outline
  return summary.at("observations");
}

void expect_within(double value, double low, double high, const std::string& what) {
  EXPECT_GE(value, low) << what;
  EXPECT_LE(value, high) << what;
}

/// Mass over area of what lies upstream of x = -30 m in the last state [kg/m2], in squares of 2 m (16 particles at the
/// start) whose eight neighbours all hold particles too, or lie below the base.
double density_of_the_slide(const std::filesystem::path& results) {
  const Hdf5File file(results, Hdf5File::Mode::read);
  const auto last = file.read<std::int64_t>("VTKHDF/Steps/PointOffsets").back();
  const auto place = file.read<double>("VTKHDF/Points"), mass = file.read<double>("VTKHDF/PointData/mass");
  std::map<std::array<int, 2>, double> squares;
  for (auto p = static_cast<std::size_t>(last); p < mass.size(); ++p)
    squares[{static_cast<int>(std::floor(place[3 * p] / 2)), static_cast<int>((place[3 * p + 1] - 307) / 2)}] +=
        mass[p];
  const auto inside = [&](int column, int row) {
    for (int i = column - 1; i <= column + 1; ++i)
      for (int j = std::max(0, row - 1); j <= row + 1; ++j)
        if (!squares.contains({i, j})) return false;
    return true;
  };
  double sum = 0, area = 0;
  for (const auto& [square, kilograms] : squares) {
    if (square[0] >= -15 || !inside(square[0], square[1])) continue;
    sum += kilograms;
    area += 4;
  }
  EXPECT_GT(area, 1000);
  return sum / area;
}

}  // namespace

TEST(LowerSanFernando, runs_out_and_comes_to_rest) {
  const Scratch scratch;
  const auto observations = observations_of("11_lower_san_fernando", scratch);
  expect_within(observations.at("runout"), 36, 50, "runout [m]");
  expect_within(observations.at("crest_loss"), 11, 15, "crest_loss [m]");
  double peak = 0, last = 0;
  const auto history = table(scratch / "out/history.csv");
  for (const auto& cell : history.at("kinetic_energy_J")) {
    last = std::strtod(cell.c_str(), nullptr);
    peak = std::max(peak, last);
  }
  EXPECT_GT(peak, 0);
  EXPECT_LT(last, 1e-3 * peak);
  // The soil does not dilate. It was 1 % too dense when this was written; twice that is tolerated, for the choice of
  // squares, which favours full ones.
  EXPECT_NEAR(density_of_the_slide(scratch / "out/results.h5"), 1800, 0.02 * 1800);
}

/// Nor does F-bar make it swell, even in long steps: that it did when its means were those of the grid's cells, which
/// quadratic B-splines can cheat (tests/verification/f_bar.cpp), by 4 %.
TEST(LowerSanFernando, keeps_its_density_under_f_bar) {
  const Scratch scratch;
  observations_of("11_lower_san_fernando", scratch, {"--set", "scheme.f_bar=true", "--set", "scheme.courant=0.5"});
  EXPECT_NEAR(density_of_the_slide(scratch / "out/results.h5"), 1800, 0.02 * 1800);
}

TEST(LowerSanFernando, runs_out_with_the_discretisation_of_the_paper) {
  const Scratch scratch;
  const auto observations = observations_of("12_lower_san_fernando_paper", scratch);
  expect_within(observations.at("runout"), 36, 50, "runout [m]");
  EXPECT_EQ(last_number(scratch / "out/history.csv", "step"), 50000);
}

}  // namespace sluice::test
