/// Rasters: the ESRI ASCII format, bilinear heights, and bodies below and above them.
#include "core/case/raster.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "core/case/case.h"
#include "core/case/resolved_case.h"
#include "core/particles/fill.h"
#include "core/simulation/scene.h"

namespace sluice {
namespace {

/// A folder of this test alone.
class RasterFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              fmt::format("sluice_raster_{}_{}", ::testing::UnitTest::GetInstance()->random_seed(),
                          ::testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return (folder_ / name).string();
  }
  /// The message about a raster with this text, without its folder.
  std::string error_of(const std::string& text) const {
    return error_from([&] { read_raster(write("r.asc", text)); });
  }
  template <class Action>
  std::string error_from(const Action& action) const {
    try {
      action();
    } catch (const CaseError& error) {
      std::string message = error.what();
      for (auto at = message.find(folder_.string()); at != std::string::npos; at = message.find(folder_.string()))
        message.erase(at, folder_.string().size() + 1);
      return message;
    }
    return "accepted";
  }

  std::filesystem::path folder_;
};

const std::string header = "ncols 3\nnrows 2\nxllcorner 10\nyllcorner 20\ncellsize 2\n";

// Rows come from the north, heights stand in the middles of cells; between them bilinear: the mean in the middle of
// four. Exact: the numbers are multiples of powers of two.
TEST_F(RasterFiles, HeightsAreBilinear) {
  const Raster raster = read_raster(write("r.asc", header + "1 2 4\n8 16 32\n"));
  EXPECT_EQ(raster.height(11, 21), 8);
  EXPECT_EQ(raster.height(15, 23), 4);
  EXPECT_EQ(raster.height(12, 21), 12);
  EXPECT_EQ(raster.height(12, 22), (1 + 2 + 8 + 16) / 4.0);
  EXPECT_EQ(raster.height(10, 20), 8) << "as at the nearest middle";
  EXPECT_EQ(raster.height(16, 24), 4);
  EXPECT_FALSE(raster.height(9.99, 21));
  EXPECT_FALSE(raster.height(12, 24.01));
  EXPECT_FALSE(raster.height(NAN, 22));
  EXPECT_EQ(raster.extremes(), (std::array<double, 2>{1, 32}));
  EXPECT_EQ(raster.slope(12, 21)[0], 4);
}

// A plane is bilinear: its heights are exact to round-off everywhere between the outermost middles.
TEST_F(RasterFiles, APlaneIsExact) {
  std::string text = "NCOLS 6\nNROWS 5\nXLLCENTER -1\nYLLCENTER 3\nCELLSIZE 0.7\nNODATA_value -1\n";
  for (int row = 4; row >= 0; --row)
    for (int column = 0; column < 6; ++column)
      text += fmt::format("{} ", 2 + 0.3 * (-1 + 0.7 * column) - 0.2 * (3 + 0.7 * row));
  const Raster raster = read_raster(write("r.asc", text));
  for (double x = -1; x < 2.5; x += 0.23)
    for (double y = 3; y < 5.8; y += 0.31) EXPECT_NEAR(raster.height(x, y).value(), 2 + 0.3 * x - 0.2 * y, 1e-14);
}

TEST_F(RasterFiles, NoHeightWhereOneIsMissing) {
  const Raster raster = read_raster(write("r.asc", header + "NODATA_value -99\n1 2 -99\n8 16 32\n"));
  EXPECT_TRUE(raster.height(12, 22));
  EXPECT_TRUE(raster.height(13, 23)) << "where the missing one has no weight";
  EXPECT_FALSE(raster.height(13.5, 22));
  EXPECT_EQ(raster.extremes(), (std::array<double, 2>{1, 32}));
}

TEST_F(RasterFiles, MessagesNameLineAndColumn) {
  EXPECT_EQ(error_of(header + "1 2 4\n8 16\n"), "r.asc:8:1: the raster ends after 5 values; ncols times nrows is 6");
  EXPECT_EQ(error_of(header + "1 2 4\n8 16 32 64\n"),
            "r.asc:7:9: the raster has more values than ncols times nrows, 6");
  EXPECT_EQ(error_of(header + "1 2 x4\n8 16 32\n"), "r.asc:6:5: value 3 of row 1: found 'x4'; expected a number");
  EXPECT_EQ(error_of("ncol 3\n1"),
            "r.asc:1:1: unknown word 'ncol' in the header of the raster; allowed: ncols, nrows, xllcorner, xllcenter, "
            "yllcorner, yllcenter, cellsize, nodata_value; did you mean 'ncols'?");
  EXPECT_EQ(error_of("ncols 3\nncols 3\n1"), "r.asc:2:1: 'ncols' stands twice in the header of the raster");
  EXPECT_EQ(error_of("ncols 3\nnrows 2.5\ncellsize 1\n1"),
            "r.asc:2:1: nrows: found 2.5; expected a whole number from 1 to 100000");
  EXPECT_EQ(error_of("ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\n1"),
            "r.asc:1:1: the header of the raster has no 'cellsize'");
  EXPECT_EQ(error_of("ncols 3\nnrows 2\nxllcorner 0\nxllcenter 0\nyllcorner 0\ncellsize 1\n1"),
            "r.asc:4:1: the header of the raster must have either 'xllcorner' or 'xllcenter'");
  EXPECT_EQ(error_of("ncols 1\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize -1\n1"),
            "r.asc:5:1: cellsize: -1 is not above 0");
  EXPECT_EQ(error_of("ncols 1\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\n-9999"),
            "r.asc: all values of the raster are NODATA, -9999");
}

/// 4 m x 4 m x 4 m, with bodies below and above rasters beside the case.
std::string scene(double cell, const std::string& bodies) {
  return fmt::format(
      "schema: 1\nphysics: total_stress\nend_time: 1 s\ngrid: {{min: [0, 0, 0, m], max: [4, 4, 4, m], cell: {} m}}\n"
      "materials:\n"
      "  rock: {{model: linear_elastic, density: 1 kg/m3, youngs_modulus: 1 MPa}}\n"
      "  slide: {{model: linear_elastic, density: 1 kg/m3, youngs_modulus: 1 MPa}}\nbodies:\n{}",
      cell, bodies);
}

/// Volume by material.
std::array<double, 2> volumes(const Case& definition) {
  Particles particles(3);
  fill_bodies<3>(
      definition, grid_of<3>(definition.grid), [](int) { return 1.0; }, particles);
  std::array<double, 2> sum{};
  for (std::size_t p = 0; p < particles.size(); ++p)
    sum[static_cast<std::size_t>(particles.material[p])] += particles.columns.data(particles.volume)[p];
  return sum;
}

/// Heights 1 + x / 4, and 2 + x / 4 - y / 8, in the middles of cells of 1 m from -1 m to 5 m.
std::string plane(double at_origin, double along_x, double along_y) {
  std::string text = "ncols 6\nnrows 6\nxllcorner -1\nyllcorner -1\ncellsize 1\n";
  for (int row = 5; row >= 0; --row)
    for (int column = 0; column < 6; ++column)
      text += fmt::format("{} ", at_origin + along_x * (column - 0.5) + along_y * (row - 0.5));
  return text;
}

// The slide is what lies above the rock and below the ground. Volumes: mean heights 1.5 m and 2.25 m over 16 m2; points
// of the lattice stand for columns of s = cell / 2, so each column is off by s / 2 at most, 16 m2 * s / 2 in all.
TEST_F(RasterFiles, ASlideIsTheDifferenceOfTwoRasters) {
  write("rock.asc", plane(1, 0.25, 0));
  write("ground.asc", plane(2, 0.25, -0.125));
  for (const double cell : {1.0, 0.5, 0.25}) {
    const auto [rock, slide] =
        volumes(parse_case(scene(cell,
                                 "  - {material: rock, below_raster: rock.asc}\n"
                                 "  - {material: slide, above_raster: rock.asc, below_raster: ground.asc}\n"),
                           (folder_ / "case.yaml").string()));
    const double tolerance = 16 * cell / 4;
    EXPECT_NEAR(rock, 16 * 1.5, tolerance);
    EXPECT_NEAR(slide, 16 * 0.75, 2 * tolerance);
    // Nothing is lost or taken twice on the surface between them.
    const auto whole = volumes(
        parse_case(scene(cell, "  - {material: rock, below_raster: ground.asc}\n"), (folder_ / "case.yaml").string()));
    EXPECT_EQ(rock + slide, whole[0]);
  }
}

TEST_F(RasterFiles, AResolvedCaseFindsTheRasterFromAnotherFolder) {
  write("rock.asc", plane(1, 0.25, 0));
  const Case here =
      parse_case(scene(1, "  - {material: rock, below_raster: rock.asc}\n"), (folder_ / "case.yaml").string());
  const Case there = parse_case(resolved_yaml(here), "elsewhere.yaml");
  EXPECT_EQ(volumes(there), volumes(here));
  EXPECT_EQ(resolved_yaml(there), resolved_yaml(here));
}

TEST_F(RasterFiles, ABodyMustLieWhereThereAreHeights) {
  const auto error = [&](const std::string& text, const std::string& more) {
    write("r.asc", text);
    return error_from([&] {
      volumes(parse_case(scene(1, "  - {material: rock, below_raster: r.asc" + more + "}\n"),
                         (folder_ / "case.yaml").string()));
    });
  };
  const std::string small = "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 1\n1 1\n";
  EXPECT_EQ(error(small, ""),
            "case.yaml:9:5: the raster 'r.asc' has no height at (2.25, 0.25) m, where this body of 'rock' may have "
            "material: it reaches from (0, 0) m to (2, 2) m, less what is NODATA; confine the body to where there are "
            "heights, for example with a box");
  EXPECT_EQ(error(small, ", box: {min: [0, 0, 0, m], max: [2, 2, 2, m]}"), "accepted");
  const std::string hole = "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 2\n1 1\n1 -9999\n";
  EXPECT_NE(error(hole, "").find("has no height at (1.25, 0.25) m"), std::string::npos);
  EXPECT_EQ(error(hole, ", box: {min: [0, 0, 0, m], max: [1, 4, 2, m]}"), "accepted");
  EXPECT_EQ(error("ncols 1\nnrows 1\nxllcorner 0\nyllcorner 0\n", ""),
            "r.asc:1:1: the header of the raster has no 'cellsize'");
}

TEST_F(RasterFiles, AreFor3D) {
  write("rock.asc", plane(1, 0, 0));
  EXPECT_EQ(error_from([&] {
              parse_case(
                  "schema: 1\nphysics: total_stress\nend_time: 1 s\ngrid: {min: [0, 0, m], max: [4, 4, m], "
                  "cell: 1 m}\nmaterials: {rock: {model: linear_elastic, density: 1 kg/m3, youngs_modulus: 1 "
                  "MPa}}\nbodies:\n  - {material: rock, below_raster: rock.asc}\n",
                  (folder_ / "case.yaml").string());
            }),
            "case.yaml:7:36: below_raster: it is for 3-D; in 2-D take polygon");
}

}  // namespace
}  // namespace sluice
