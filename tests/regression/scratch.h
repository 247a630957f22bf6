/// A folder for one test, and small cases that stand in it.
#pragma once

#include <filesystem>
#include <string>

namespace sluice::test {

/// A folder, whose name holds a blank, that exists as long as the object.
class Scratch {
 public:
  Scratch();
  ~Scratch();
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  void write(const std::string& name, const std::string& text) const;

 private:
  std::filesystem::path path_;
};

/// Collapse of a column of sand in plane strain: 256 particles, some 360 steps in 1 s.
extern const std::string column;

/// A block of two materials that falls in 3-D.
extern const std::string block;

/// `text` with its first `from` replaced; asserts that there is one.
std::string with(std::string text, const std::string& from, const std::string& to);

}  // namespace sluice::test
