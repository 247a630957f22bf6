#include "core/chart/measured_run.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <thread>

#include "core/simulation/interrupt.h"
#include "core/simulation/run.h"

namespace sluice::chart {

namespace {

namespace fs = std::filesystem;

std::vector<std::string> words_of(const RunRequest& request) {
  std::vector<std::string> words = {fs::read_symlink("/proc/self/exe").string(),
                                    "run",
                                    request.case_file,
                                    "--output",
                                    request.folder.string(),
                                    "--force",
                                    "--quiet",
                                    "--threads",
                                    std::to_string(request.threads)};
  for (const Override& setting : request.settings) {
    words.emplace_back("--set");
    words.push_back(setting.key + "=" + setting.value);
  }
  return words;
}

/// Becomes the run. Does not return.
[[noreturn]] void become(const std::vector<std::string>& words, const fs::path& log, double cpu_limit, pid_t study) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);    // a study that is killed leaves no run behind
  if (getppid() != study) _exit(127);  // it was killed before this process could be told
  const auto seconds = static_cast<rlim_t>(std::ceil(cpu_limit));
  const rlimit limit{seconds, seconds + 5};
  setrlimit(RLIMIT_CPU, &limit);
  const int file = open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  if (file >= 0) {
    dup2(file, STDOUT_FILENO);
    dup2(file, STDERR_FILENO);
  }
  std::vector<char*> pointers;
  for (const auto& word : words) pointers.push_back(const_cast<char*>(word.c_str()));
  pointers.push_back(nullptr);
  execv(pointers[0], pointers.data());
  _exit(127);
}

/// Waits; passes an interruption on.
int wait_for(pid_t child, rusage& usage) {
  int status = 0;
  bool told = false;
  while (wait4(child, &status, WNOHANG, &usage) == 0) {
    if (interrupted() && !told) told = kill(child, SIGTERM) == 0;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return status;
}

double seconds_of(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

/// The first line of what the run said is wrong.
std::string message_in(const fs::path& log) {
  std::ifstream in(log);
  for (std::string line; std::getline(in, line);)
    if (line.starts_with("error: ")) return line.substr(7);
  return "";
}

/// Why the process ended before its time, in words; "" if it did not.
std::string failure_of(int status) {
  if (WIFSIGNALED(status))
    return WTERMSIG(status) == SIGXCPU ? "CPU limit" : fmt::format("killed by signal {}", WTERMSIG(status));
  switch (WEXITSTATUS(status)) {
    case exit_code::done:
      return "";
    case exit_code::bad_input:
      return "refused";
    case exit_code::bad_physics:
      return "physics failed";
    default:
      return "run failed";
  }
}

void read_summary(const fs::path& file, RunReport& report) {
  std::ifstream in(file);
  if (!in) return;
  const auto json = nlohmann::json::parse(in, nullptr, false);
  const auto number = [&](const char* key) {
    const auto found = json.find(key);
    return found != json.end() && found->is_number() ? found->get<double>() : 0.0;
  };
  report.steps = number("steps");
  report.particles = number("particles");
  report.particle_steps = number("particle_steps");
  if (json.contains("step_cpu_seconds")) report.cpu_seconds = number("step_cpu_seconds");
  report.peak_memory = number("peak_memory_bytes");
  report.factorizations = number("pressure_factorizations");
  report.iterations = number("pressure_iterations");
}

}  // namespace

RunReport measured_run(const RunRequest& request) {
  const std::vector<std::string> words = words_of(request);
  fs::create_directories(request.folder.parent_path());
  const fs::path log = request.folder.string() + ".log";
  fs::remove(request.folder / "summary.json");  // of an earlier run
  const pid_t study = getpid();
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("a run could not be started: no process");
  if (child == 0) become(words, log, request.cpu_limit, study);
  rusage usage{};
  const int status = wait_for(child, usage);
  RunReport report;
  report.interrupted = interrupted() || (WIFEXITED(status) && WEXITSTATUS(status) == exit_code::interrupted);
  report.failure = failure_of(status);
  report.message = message_in(log);
  report.process_cpu = report.cpu_seconds = seconds_of(usage.ru_utime) + seconds_of(usage.ru_stime);
  read_summary(request.folder / "summary.json", report);
  return report;
}

}  // namespace sluice::chart
