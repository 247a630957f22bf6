#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <numeric>
#include <thread>

#include "core/output/hdf5_file.h"
#include "core/output/results.h"
#include "tests/unit/output_fixture.h"

namespace sluice {
namespace {

using test::row_of_particles;
using test::ScratchFolder;
using test::set_state;

/// Frames of `set_state` at 0, 1, 2 … s; the last particle is lost after each frame if `shrink`.
void write_frames(ResultsWriter& writer, Particles& particles, int first, int last, bool shrink = false) {
  for (int i = first; i <= last; ++i) {
    set_state(particles, i);
    writer.add_frame(particles, i, 10 * i);
    if (shrink) particles.resize(particles.size() - 1);
  }
}

/// Reads everything by the index of the VTKHDF layout, as a reader of that format does, and compares with `set_state`.
/// Returns the number of frames.
std::size_t verify_frames(const std::filesystem::path& path) {
  const Hdf5File file(path, Hdf5File::Mode::read);
  EXPECT_EQ(file.text_attribute("VTKHDF", "Type"), "UnstructuredGrid");
  EXPECT_EQ(file.integer_attribute("VTKHDF", "Version").at(0), 2);
  const auto times = file.read<double>("VTKHDF/Steps/Values");
  EXPECT_EQ(file.integer_attribute("VTKHDF/Steps", "NSteps").at(0), static_cast<std::int64_t>(times.size()));
  const auto part = file.read<std::int64_t>("VTKHDF/Steps/PartOffsets");
  const auto parts = file.read<std::int64_t>("VTKHDF/Steps/NumberOfParts");
  const auto points = file.read<std::int64_t>("VTKHDF/NumberOfPoints");
  const auto cells = file.read<std::int64_t>("VTKHDF/NumberOfCells");
  const auto connections = file.read<std::int64_t>("VTKHDF/NumberOfConnectivityIds");
  const auto first_point = file.read<std::int64_t>("VTKHDF/Steps/PointOffsets");
  const auto first_cell = file.read<std::int64_t>("VTKHDF/Steps/CellOffsets");
  const auto first_connection = file.read<std::int64_t>("VTKHDF/Steps/ConnectivityIdOffsets");
  const auto first_strain = file.read<std::int64_t>("VTKHDF/Steps/PointDataOffsets/equivalent_plastic_strain");
  for (std::size_t i = 0; i < times.size(); ++i) {
    EXPECT_EQ(parts.at(i), 1);
    const auto p = static_cast<std::size_t>(part.at(i));
    const auto n = static_cast<std::size_t>(points.at(p));
    const auto at = static_cast<std::size_t>(first_point.at(i));
    EXPECT_EQ(cells.at(p), points.at(p));
    EXPECT_EQ(connections.at(p), points.at(p));
    const auto cell = static_cast<std::size_t>(first_cell.at(i));
    std::vector<std::int64_t> count(n + 1);
    std::iota(count.begin(), count.end(), 0);
    EXPECT_EQ(file.read_rows<std::int64_t>("VTKHDF/Offsets", cell + p, n + 1), count);  // one more than cells per part
    count.pop_back();
    EXPECT_EQ(file.read_rows<std::int64_t>("VTKHDF/Connectivity", static_cast<std::size_t>(first_connection.at(i)), n),
              count);
    EXPECT_EQ(file.read_rows<std::uint8_t>("VTKHDF/Types", cell, n), std::vector<std::uint8_t>(n, 1));
    const auto position = file.read_rows<double>("VTKHDF/Points", at, n);
    const auto displacement = file.read_rows<double>("VTKHDF/PointData/displacement", at, n);
    const auto velocity = file.read_rows<double>("VTKHDF/PointData/velocity", at, n);
    const auto stress = file.read_rows<double>("VTKHDF/PointData/stress", at, n);
    const auto strain = file.read_rows<double>("VTKHDF/PointData/equivalent_plastic_strain",
                                               static_cast<std::size_t>(first_strain.at(i)), n);
    const auto id = file.read_rows<std::int32_t>("VTKHDF/PointData/id", at, n);
    const auto material = file.read_rows<std::int32_t>("VTKHDF/PointData/material", at, n);
    for (std::size_t k = 0; k < n; ++k) {
      EXPECT_EQ(position[3 * k], 0.25 + 0.5 * id[k] + times[i]);
      EXPECT_EQ(position[3 * k + 2], 0);
      EXPECT_EQ(displacement[3 * k], times[i]);
      EXPECT_EQ(velocity[3 * k], 1);
      EXPECT_EQ(velocity[3 * k + 2], 0);
      EXPECT_EQ(stress[4 * k + 3], -1000 * times[i]);
      EXPECT_EQ(strain[k], id[k] + times[i]);
      EXPECT_EQ(material[k], id[k] % 2);
    }
  }
  return times.size();
}

TEST(Results, UnfinishedFilePresentsAllFrames) {
  const ScratchFolder folder;
  auto particles = row_of_particles(7);
  ResultsWriter writer(folder.path(), test::provenance(), particles);
  write_frames(writer, particles, 0, 4);
  EXPECT_EQ(verify_frames(folder / "results.h5"), 5u);
  EXPECT_TRUE(Hdf5File(folder / "results.h5", Hdf5File::Mode::read).is_virtual("VTKHDF/Points"));
}

TEST(Results, FinishedFileHoldsTheDataItself) {
  const ScratchFolder folder;
  auto particles = row_of_particles(7);
  ResultsWriter writer(folder.path(), test::provenance(), particles);
  write_frames(writer, particles, 0, 4, true);  // the number of particles changes
  writer.finish();
  EXPECT_FALSE(std::filesystem::exists(folder / "frames"));
  EXPECT_EQ(verify_frames(folder / "results.h5"), 5u);
  const Hdf5File file(folder / "results.h5", Hdf5File::Mode::read);
  const std::size_t points = 7 + 6 + 5 + 4 + 3;
  EXPECT_EQ(file.shape("VTKHDF/Points"), (Hdf5File::Shape{points, 3}));
  EXPECT_EQ(file.shape("VTKHDF/Offsets"), (Hdf5File::Shape{points + 5}));
  EXPECT_EQ(file.shape("VTKHDF/Steps/CellOffsets"), (Hdf5File::Shape{5, 1}));
  for (const auto& field : file.members("VTKHDF/PointData")) {
    EXPECT_FALSE(file.is_virtual("VTKHDF/PointData/" + field)) << field;
    EXPECT_EQ(file.shape("VTKHDF/PointData/" + field).at(0), points) << field;
    EXPECT_TRUE(file.has_attribute("VTKHDF/PointData/" + field, "unit")) << field;
    EXPECT_TRUE(file.contains("VTKHDF/Steps/PointDataOffsets/" + field)) << field;
  }
}

TEST(Results, FieldsUnitsAndProvenance) {
  const ScratchFolder folder;
  auto particles = row_of_particles(3);
  ResultsWriter writer(folder.path(), test::provenance(), particles);
  write_frames(writer, particles, 0, 0);
  writer.finish();
  const Hdf5File file(folder / "results.h5", Hdf5File::Mode::read);
  EXPECT_EQ(file.members("VTKHDF/PointData"),
            (std::vector<std::string>{"displacement", "equivalent_plastic_strain", "id", "mass", "material", "stress",
                                      "velocity", "volume"}));
  EXPECT_EQ(file.text_attribute("VTKHDF/PointData/stress", "unit"), "Pa");
  EXPECT_EQ(file.text_attribute("VTKHDF/PointData/equivalent_plastic_strain", "description"),
            "Accumulated plastic strain.");
  EXPECT_EQ(file.read_text("Sluice/case"), test::provenance().case_text);
  EXPECT_EQ(file.read_texts("Sluice/material_names"), particles.material_names);
  EXPECT_EQ(file.real_attribute("Sluice", "grid_max"), (std::vector<double>{10, 1}));
  EXPECT_FALSE(file.text_attribute("Sluice", "compiler").empty());
  EXPECT_EQ(file.text_attribute("Sluice/columns/hidden", "description"), "Not written to results.");
}

TEST(Results, ThreeDimensions) {
  const ScratchFolder folder;
  auto particles = row_of_particles(4, 3);
  ResultsWriter writer(folder.path(), test::provenance(), particles);
  writer.add_frame(particles, 0, 0);
  const Hdf5File file(folder / "results.h5", Hdf5File::Mode::read);
  EXPECT_EQ(file.shape("VTKHDF/PointData/stress"), (Hdf5File::Shape{4, 6}));
  EXPECT_EQ(file.shape("VTKHDF/PointData/velocity"), (Hdf5File::Shape{4, 3}));
}

TEST(Results, ResumeKeepsEarlierFramesOnly) {
  for (const bool finished : {false, true}) {
    const ScratchFolder folder;
    {
      auto particles = row_of_particles(7);
      ResultsWriter writer(folder.path(), test::provenance(), particles);
      write_frames(writer, particles, 0, 5);
      if (finished) writer.finish();
    }
    auto particles = row_of_particles(7);
    ResultsWriter writer(folder.path(), test::provenance(), particles, 3.5);
    EXPECT_EQ(writer.frame_count(), 4u);
    EXPECT_EQ(verify_frames(folder / "results.h5"), 4u);
    EXPECT_EQ(writer.frames().back().step, 30);
    write_frames(writer, particles, 3, 8);  // the one at 3 s is there already
    EXPECT_EQ(verify_frames(folder / "results.h5"), 9u);
    writer.finish();
    EXPECT_EQ(verify_frames(folder / "results.h5"), 9u);
  }
}

TEST(Results, ResumeBeforeTheFirstFrame) {
  const ScratchFolder folder;
  auto particles = row_of_particles(3);
  {
    ResultsWriter writer(folder.path(), test::provenance(), particles);
    write_frames(writer, particles, 1, 2);
    writer.finish();
  }
  ResultsWriter writer(folder.path(), test::provenance(), particles, 0.5);
  EXPECT_EQ(writer.frame_count(), 0u);
  EXPECT_FALSE(std::filesystem::exists(folder / "results.h5"));
  write_frames(writer, particles, 1, 1);
  EXPECT_EQ(verify_frames(folder / "results.h5"), 1u);
}

TEST(Results, ResumeWithOtherFieldsIsRefused) {
  const ScratchFolder folder;
  auto particles = row_of_particles(3);
  {
    ResultsWriter writer(folder.path(), test::provenance(), particles);
    write_frames(writer, particles, 0, 1);
  }
  Particles other(2);
  other.resize(3);
  EXPECT_THROW(ResultsWriter(folder.path(), test::provenance(), other, 5.0), std::runtime_error);
  EXPECT_EQ(verify_frames(folder / "results.h5"), 2u);  // nothing is lost
}

TEST(Results, FreshResultsReplaceOlderOnes) {
  const ScratchFolder folder;
  auto particles = row_of_particles(3);
  ResultsWriter older(folder.path(), test::provenance(), particles);
  write_frames(older, particles, 0, 5);
  ResultsWriter writer(folder.path(), test::provenance(), particles);
  write_frames(writer, particles, 0, 1);
  EXPECT_EQ(verify_frames(folder / "results.h5"), 2u);
}

TEST(Results, EarlierTimeIsRefused) {
  const ScratchFolder folder;
  auto particles = row_of_particles(3);
  ResultsWriter writer(folder.path(), test::provenance(), particles);
  writer.add_frame(particles, 1, 1);
  EXPECT_THROW(writer.add_frame(particles, 0.5, 2), std::invalid_argument);
}

/// Writes, finishes and resumes, four frames more in each round.
void write_rounds(const std::filesystem::path& folder, int rounds) {
  for (int round = 0; round < rounds; ++round) {
    auto particles = row_of_particles(500);
    ResultsWriter writer = round == 0 ? ResultsWriter(folder, test::provenance(), particles)
                                      : ResultsWriter(folder, test::provenance(), particles, 4.0 * round - 1.5);
    write_frames(writer, particles, 4 * round, 4 * round + 3);
    writer.finish();
  }
}

/// A child that writes without end is killed at random moments, in its first rounds and the finishing between them. How
/// long a round takes on this machine, and with sanitizers, is measured.
TEST(Results, KilledRunLeavesReadableResults) {
  std::srand(1);
  const auto start = std::chrono::steady_clock::now();
  write_rounds(ScratchFolder().path(), 2);
  const std::chrono::duration<double> longest = std::chrono::steady_clock::now() - start;
  std::size_t most_frames = 0;
  for (int attempt = 0; attempt < 20; ++attempt) {
    const ScratchFolder folder;
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) write_rounds(folder.path(), std::numeric_limits<int>::max());
    while (!std::filesystem::exists(folder / "results.h5")) ::usleep(100);
    std::this_thread::sleep_for(2 * longest * std::rand() / RAND_MAX);
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    const std::size_t frames = verify_frames(folder / "results.h5");
    EXPECT_GT(frames, 0u);
    most_frames = std::max(most_frames, frames);
    auto particles = row_of_particles(500);
    ResultsWriter resumed(folder.path(), test::provenance(), particles, 1e9);
    EXPECT_GE(resumed.frame_count(), frames);  // a frame may be complete before results.h5 presents it
    EXPECT_EQ(verify_frames(folder / "results.h5"), resumed.frame_count());
  }
  EXPECT_GT(most_frames, 4u);  // otherwise nothing but the beginning was tested
}

TEST(Xdmf, EveryFrameRefersToItsRows) {
  const ScratchFolder folder;
  auto particles = row_of_particles(7);
  ResultsWriter writer(folder.path(), test::provenance(), particles);
  write_frames(writer, particles, 0, 2, true);
  const std::string text = test::content(folder / "results.xdmf");
  EXPECT_NE(text.find("<Time Value=\"2\"/>"), std::string::npos);
  EXPECT_NE(text.find("NumberOfElements=\"5\""), std::string::npos);
  EXPECT_NE(text.find("13 0 1 1 5 3"), std::string::npos);  // the third frame begins after 7 + 6 rows
  EXPECT_NE(text.find("results.h5:/VTKHDF/PointData/stress"), std::string::npos);
}

}  // namespace
}  // namespace sluice
