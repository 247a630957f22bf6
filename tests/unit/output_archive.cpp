#include <cmath>
#include <fstream>
#include <limits>
#include <random>

#include "core/output/archive.h"
#include "core/output/hdf5_file.h"
#include "tests/unit/output_fixture.h"

namespace sluice {
namespace {

using test::row_of_particles;
using test::ScratchFolder;

Archive sample() {
  Archive archive;
  archive.reals["pressure"] = {1.0 / 3, -0.0, std::numeric_limits<double>::denorm_min(), 1e308};
  archive.reals["empty"] = {};
  archive.integers["id"] = {0, -5, std::numeric_limits<std::int64_t>::max()};
  archive.texts["case"] = std::string("line\nwith a null \0 byte", 22);
  archive.texts["nothing"] = "";
  return archive;
}

void flip_byte(const std::filesystem::path& path, std::streamoff at) {
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  file.seekg(at);
  const int byte = file.get();
  file.seekp(at);
  file.put(static_cast<char>(byte ^ 0x10));
}

std::string load_error(const std::filesystem::path& path) {
  try {
    load_archive(path);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(Archive, RoundTripIsExact) {
  const ScratchFolder folder;
  save_archive(folder / "a.h5", sample());
  const Archive loaded = load_archive(folder / "a.h5");
  EXPECT_EQ(loaded.reals, sample().reals);
  EXPECT_TRUE(std::signbit(loaded.reals.at("pressure")[1]));
  EXPECT_EQ(loaded.integers, sample().integers);
  EXPECT_EQ(loaded.texts, sample().texts);
  EXPECT_FALSE(std::filesystem::exists(folder / "a.h5.part"));
}

TEST(Archive, SlashInANameIsRefused) {
  const ScratchFolder folder;
  Archive archive;
  archive.reals["a/b"] = {1};
  EXPECT_THROW(save_archive(folder / "a.h5", archive), std::invalid_argument);
}

TEST(Archive, MissingTruncatedForeignAndOtherVersion) {
  const ScratchFolder folder;
  EXPECT_NE(load_error(folder / "none.h5").find("none.h5: does not exist"), std::string::npos);

  save_archive(folder / "a.h5", sample());
  std::filesystem::resize_file(folder / "a.h5", std::filesystem::file_size(folder / "a.h5") / 2);
  EXPECT_NE(load_error(folder / "a.h5").find("truncated"), std::string::npos) << load_error(folder / "a.h5");
  std::filesystem::resize_file(folder / "a.h5", 0);
  EXPECT_NE(load_error(folder / "a.h5").find("a.h5: cannot be opened"), std::string::npos);

  Hdf5File other(folder / "b.h5", Hdf5File::Mode::create);
  other.set_attribute("/", "sluice_archive_version", std::int64_t{99});
  other.close();
  EXPECT_NE(load_error(folder / "b.h5").find("version 99"), std::string::npos);
}

/// Wherever a bit flips, the archive is either refused or, where the byte is unused, read as it was.
TEST(Archive, NoDamageGoesUnnoticed) {
  const ScratchFolder folder;
  Archive archive = sample();
  archive.reals["stress"].assign(2000, -1e5);
  save_archive(folder / "a.h5", archive);
  const auto size = std::filesystem::file_size(folder / "a.h5");
  std::mt19937_64 random(7);
  int refused = 0;
  for (int i = 0; i < 300; ++i) {
    const auto at = static_cast<std::streamoff>(random() % size);
    flip_byte(folder / "a.h5", at);
    if (const auto error = load_error(folder / "a.h5"); error.empty())
      EXPECT_EQ(checksum(load_archive(folder / "a.h5")), checksum(archive)) << "byte " << at;
    else
      ++refused;
    flip_byte(folder / "a.h5", at);
  }
  EXPECT_GT(refused, 150);
  EXPECT_EQ(load_error(folder / "a.h5"), "");
}

TEST(Archive, ParticlesRoundTrip) {
  Particles particles = row_of_particles(9);
  test::set_state(particles, 0.1);
  Archive archive;
  store_particles(particles, archive);
  Particles restored = row_of_particles(0);
  restored.material_names.clear();
  restore_particles(archive, restored);
  EXPECT_EQ(restored.id, particles.id);
  EXPECT_EQ(restored.material, particles.material);
  EXPECT_EQ(restored.material_names, particles.material_names);
  for (const auto& spec : particles.columns.specs()) {
    if (spec.role != Role::state) continue;
    for (int k = 0; k < spec.components; ++k) {
      const auto a = particles.columns.values(particles.columns.find(spec.name), k);
      const auto b = restored.columns.values(restored.columns.find(spec.name), k);
      EXPECT_TRUE(std::equal(a.begin(), a.end(), b.begin(), b.end())) << spec.name;
    }
  }
}

TEST(Archive, DisagreeingColumnsAreNamed) {
  Particles particles = row_of_particles(2);
  Archive archive;
  store_particles(particles, archive);
  const auto error = [&](Particles& into) -> std::string {
    try {
      restore_particles(archive, into);
    } catch (const std::runtime_error& caught) {
      return caught.what();
    }
    return "";
  };
  Particles fewer(2);
  EXPECT_NE(error(fewer).find("'equivalent_plastic_strain'"), std::string::npos) << error(fewer);
  Particles more = row_of_particles(2);
  more.columns.declare({"pore_pressure", "Pa", 1, Role::state, "Compression positive."});
  EXPECT_NE(error(more).find("'pore_pressure'"), std::string::npos) << error(more);
  Particles deeper = row_of_particles(2, 3);
  EXPECT_NE(error(deeper).find("components"), std::string::npos) << error(deeper);
}

TEST(CheckpointStore, LatestOfTwoAndFallBack) {
  const ScratchFolder folder;
  CheckpointStore store(folder.path());
  EXPECT_FALSE(store.any());
  EXPECT_THROW(store.load_latest(), std::runtime_error);
  for (int i = 1; i <= 5; ++i) store.save(sample(), 0.5 * i, i);

  CheckpointStore later(folder.path());
  const Checkpoint latest = later.load_latest();
  EXPECT_EQ(latest.step, 5);
  EXPECT_EQ(latest.time, 2.5);
  EXPECT_TRUE(latest.warnings.empty());

  std::filesystem::resize_file(latest.file, std::filesystem::file_size(latest.file) - 100);
  CheckpointStore again(folder.path());
  const Checkpoint fallback = again.load_latest();
  EXPECT_EQ(fallback.step, 4);
  ASSERT_EQ(fallback.warnings.size(), 1u);
  EXPECT_NE(fallback.warnings[0].find(latest.file.string()), std::string::npos);

  again.save(sample(), 9, 9);  // over the broken one, not over the good one
  std::filesystem::remove(latest.file);
  EXPECT_EQ(CheckpointStore(folder.path()).load_latest().step, 4);
}

TEST(CheckpointStore, DamagedDataFallsBackAndTheDamagedFileIsReplaced) {
  const ScratchFolder folder;
  CheckpointStore store(folder.path());
  Archive archive = sample();
  archive.reals["stress"].assign(20000, 1.0);
  store.save(archive, 1, 1);
  store.save(archive, 2, 2);
  flip_byte(folder / "checkpoint_1.h5", 100000);
  CheckpointStore later(folder.path());
  const Checkpoint found = later.load_latest();
  EXPECT_EQ(found.step, 1);
  ASSERT_EQ(found.warnings.size(), 1u);
  EXPECT_NE(found.warnings[0].find("checksum"), std::string::npos) << found.warnings[0];
  later.save(archive, 1.5, 15);
  // The newest is the one written last, whatever its step; and the one it came from is still there.
  EXPECT_EQ(CheckpointStore(folder.path()).load_latest().step, 15);
  EXPECT_EQ(load_archive(folder / "checkpoint_0.h5").integers.at("checkpoint.step").at(0), 1);
}

TEST(CheckpointStore, NoneUsableNamesAll) {
  const ScratchFolder folder;
  std::ofstream(folder / "checkpoint_0.h5") << "not HDF5";
  std::ofstream(folder / "checkpoint_1.h5");
  CheckpointStore store(folder.path());
  try {
    store.load_latest();
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("checkpoint_0.h5"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("checkpoint_1.h5"), std::string::npos);
  }
  EXPECT_TRUE(store.any());
  store.clear();
  EXPECT_FALSE(store.any());
}

}  // namespace
}  // namespace sluice
