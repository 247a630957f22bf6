/// FileAside: a file that is written beside its place and moved there when complete, so that a reader, or a kill at any
/// moment, meets either the old file or the new one, never a part of one.
#pragma once

#include <filesystem>
#include <string>

namespace sluice {

class FileAside {
 public:
  enum class Durability {
    process,  ///< survives the death of this process
    power     ///< survives the death of the machine too: waits for the disk
  };

  explicit FileAside(std::filesystem::path target);
  /// Removes the unfinished file unless `commit` was called.
  ~FileAside();
  FileAside(const FileAside&) = delete;
  FileAside& operator=(const FileAside&) = delete;

  /// Where to write; close the file before `commit`.
  const std::filesystem::path& path() const { return aside_; }
  /// Moves the file to its place. Throws std::runtime_error naming the file.
  void commit(Durability durability = Durability::process);

 private:
  std::filesystem::path target_, aside_;
  bool committed_ = false;
};

/// Writes a whole text file in this way. Throws std::runtime_error naming the file.
void replace_text_file(const std::filesystem::path& target, const std::string& text);

/// Makes the folder of an output, and those above it. Throws std::runtime_error naming it.
void make_output_folder(const std::filesystem::path& folder);

}  // namespace sluice
