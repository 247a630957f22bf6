/// The program under test, started as a user starts it: a process of its own, its words and its exit code.
#pragma once

#include <gtest/gtest.h>
#include <sys/types.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace sluice::test {

/// How a process ended.
struct Ending {
  int code = 0;     ///< exit code; minus the signal where a signal ended the process
  std::string out;  ///< what it wrote to stdout
  std::string err;  ///< what it wrote to stderr
};

class Process {
 public:
  /// Starts `words`, the first of which is the program's path, in `folder`. Throws std::runtime_error.
  Process(std::vector<std::string> words, const std::filesystem::path& folder);
  ~Process();  ///< kills what still runs
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  void signal(int number) const;
  bool running();
  Ending wait();

 private:
  using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

  pid_t id_ = 0;
  int status_ = 0;
  bool ended_ = false;
  File out_, err_;
};

/// `sluice` with these arguments.
std::vector<std::string> sluice_words(const std::vector<std::string>& arguments);

/// Runs `sluice` with these arguments in a folder to its end.
Ending run_sluice(const std::vector<std::string>& arguments, const std::filesystem::path& folder);

/// Whether `word` stands in what a process wrote, or at its beginning; a failure shows all of it.
testing::AssertionResult holds(const std::string& text, const std::string& word);
testing::AssertionResult begins(const std::string& text, const std::string& word);

}  // namespace sluice::test
