#include "tests/regression/program.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <stdexcept>
#include <utility>

namespace sluice::test {

namespace {

std::string content(std::FILE* file) {
  std::string text;
  std::rewind(file);
  for (int c; (c = std::fgetc(file)) != EOF;) text.push_back(static_cast<char>(c));
  return text;
}

}  // namespace

Process::Process(std::vector<std::string> words, const std::filesystem::path& folder)
    : out_(std::tmpfile(), std::fclose), err_(std::tmpfile(), std::fclose) {
  if (!out_ || !err_) throw std::runtime_error("no temporary file for the output of a process");
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const int out = fileno(out_.get()), err = fileno(err_.get());
  id_ = fork();
  if (id_ < 0) throw std::runtime_error("a process could not be started");
  if (id_ > 0) return;
  const int nothing = open("/dev/null", O_RDONLY);
  if (chdir(folder.c_str()) == 0 && dup2(nothing, STDIN_FILENO) >= 0 && dup2(out, STDOUT_FILENO) >= 0 &&
      dup2(err, STDERR_FILENO) >= 0)
    execv(arguments[0], arguments.data());
  _exit(127);
}

Process::~Process() {
  if (!running()) return;
  signal(SIGKILL);
  waitpid(id_, &status_, 0);
}

void Process::signal(int number) const { kill(id_, number); }

bool Process::running() {
  if (!ended_) ended_ = waitpid(id_, &status_, WNOHANG) == id_;
  return !ended_;
}

Ending Process::wait() {
  if (!ended_) waitpid(id_, &status_, 0);
  ended_ = true;
  const int code = WIFEXITED(status_) ? WEXITSTATUS(status_) : -WTERMSIG(status_);
  return {code, content(out_.get()), content(err_.get())};
}

std::vector<std::string> sluice_words(const std::vector<std::string>& arguments) {
  std::vector<std::string> words = {SLUICE_PROGRAM};
  words.insert(words.end(), arguments.begin(), arguments.end());
  return words;
}

Ending run_sluice(const std::vector<std::string>& arguments, const std::filesystem::path& folder) {
  return Process(sluice_words(arguments), folder).wait();
}

namespace {

testing::AssertionResult verdict(bool good, const std::string& text, const std::string& what) {
  return good ? testing::AssertionSuccess() : testing::AssertionFailure() << what << " in:\n" << text;
}

}  // namespace

testing::AssertionResult holds(const std::string& text, const std::string& word) {
  return verdict(text.find(word) != std::string::npos, text, "no \"" + word + "\"");
}

testing::AssertionResult begins(const std::string& text, const std::string& word) {
  return verdict(text.compare(0, word.size(), word) == 0, text, "no \"" + word + "\" at the beginning");
}

}  // namespace sluice::test
