/// MeasuredRun: `sluice run` as a process of its own, and what it took. A run that crashes takes nothing else with it,
/// and its CPU time and memory are those of the run alone.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/case/case.h"

namespace sluice::chart {

struct RunRequest {
  std::string case_file;
  std::vector<Override> settings;
  std::filesystem::path folder;  ///< is overwritten
  int threads = 1;
  double cpu_limit = 600;  ///< [s]
};

struct RunReport {
  bool interrupted = false;  ///< by the user: not a result
  std::string failure;       ///< "" if it reached the end time; else a class of failures, in words
  std::string message;       ///< the first line of its error
  double cpu_seconds = 0;    ///< of the steps, without start and output; of the process where it could not say
  double process_cpu = 0;    ///< [s] user and system, all threads
  double peak_memory = 0;    ///< bytes resident; 0 if the run could not say
  double steps = 0, particles = 0, particle_steps = 0;
  double factorizations = 0, iterations = 0;  ///< of the linear solver, over the run
};

/// Runs it to its end, its limit, or the user's interruption. Throws std::runtime_error if it cannot be started.
RunReport measured_run(const RunRequest& request);

}  // namespace sluice::chart
