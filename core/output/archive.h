/// Archive: everything that is needed to continue a run, by name; and the rolling pair of files that holds it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/particles/particles.h"

namespace sluice {

/// Names may hold any character but '/'.
struct Archive {
  std::map<std::string, std::vector<double>> reals;
  std::map<std::string, std::vector<std::int64_t>> integers;
  std::map<std::string, std::string> texts;
};

/// 64-bit checksum over names and values.
std::uint64_t checksum(const Archive& archive);

/// Writes an HDF5 file aside, waits for the disk, and moves it into place. Throws std::runtime_error.
void save_archive(const std::filesystem::path& path, const Archive& archive);

/// Throws std::runtime_error that names the file and what is wrong: missing, truncated, another version, wrong
/// checksum.
Archive load_archive(const std::filesystem::path& path);

/// Puts ids, materials, material names and all state columns under names that begin with "particles.".
void store_particles(const Particles& particles, Archive& archive);

/// The inverse. `particles` has its columns declared; it is resized. Throws std::runtime_error, which names the column,
/// if the archive has not exactly these columns with these numbers of components.
void restore_particles(const Archive& archive, Particles& particles);

struct Checkpoint {
  Archive archive;
  double time = 0;  ///< [s]
  std::int64_t step = 0;
  std::filesystem::path file;
  std::vector<std::string> warnings;  ///< one for every file that may be newer and could not be used
};

/// Two files in a folder, checkpoint_0.h5 and checkpoint_1.h5; the older, or a broken one, is written over.
class CheckpointStore {
 public:
  /// `folder` exists. Numbering goes on from the files that are there.
  explicit CheckpointStore(std::filesystem::path folder);

  void save(Archive archive, double time, std::int64_t step);
  /// The newest file that is intact. Throws std::runtime_error, with a line for every file that is there, if there is
  /// none.
  Checkpoint load_latest();
  bool any() const;  ///< there is a file, intact or not
  void clear();      ///< removes the files, for a run that begins anew in this folder

 private:
  std::filesystem::path file(int slot) const;

  std::filesystem::path folder_;
  std::int64_t sequence_ = 0;  // of the newest file; survives a resume from an older one, where steps and times do not
  int next_slot_ = 0;
};

}  // namespace sluice
