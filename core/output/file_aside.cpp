#include "core/output/file_aside.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <utility>

namespace sluice {

namespace {
void wait_for_disk(const std::filesystem::path& path, int flags) {
  const int file = ::open(path.c_str(), flags);
  if (file < 0) throw std::runtime_error(path.string() + ": cannot be opened: " + std::strerror(errno));
  const int status = ::fsync(file);
  const int reason = errno;
  ::close(file);
  if (status != 0) throw std::runtime_error(path.string() + ": cannot be written: " + std::strerror(reason));
}
}  // namespace

FileAside::FileAside(std::filesystem::path target) : target_(std::move(target)), aside_(target_.string() + ".part") {}

FileAside::~FileAside() {
  if (committed_) return;
  std::error_code ignored;
  std::filesystem::remove(aside_, ignored);
}

void FileAside::commit(Durability durability) {
  if (durability == Durability::power) wait_for_disk(aside_, O_RDONLY);
  std::error_code error;
  std::filesystem::rename(aside_, target_, error);
  if (error) throw std::runtime_error(target_.string() + ": cannot be replaced: " + error.message());
  committed_ = true;
  if (durability == Durability::power) {
    const auto folder = target_.parent_path();
    wait_for_disk(folder.empty() ? "." : folder, O_RDONLY | O_DIRECTORY);
  }
}

void replace_text_file(const std::filesystem::path& target, const std::string& text) {
  FileAside aside(target);
  std::ofstream file(aside.path(), std::ios::binary);
  file << text;
  file.close();
  if (!file) throw std::runtime_error(target.string() + ": cannot be written");
  aside.commit();
}

void make_output_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error || !std::filesystem::is_directory(folder))
    throw std::runtime_error(fmt::format("the output folder {} cannot be made: {}", folder.string(),
                                         error ? error.message() : "there is a file of this name"));
}

}  // namespace sluice
