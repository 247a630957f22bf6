/// Run: a simulation with its output folder: results, history, observations, checkpoints, summary.
#pragma once

#include <filesystem>
#include <string>

#include "core/case/case.h"

namespace sluice {

struct RunOptions {
  std::filesystem::path folder;
  bool resume = false;  ///< continue from the latest checkpoint in the folder
  bool force = false;   ///< overwrite what an earlier run left in the folder
  bool quiet = false;
};

/// Exit codes of the program.
namespace exit_code {
inline constexpr int done = 0;
inline constexpr int run_failed = 1;
inline constexpr int bad_input = 2;
inline constexpr int bad_physics = 3;
inline constexpr int interrupted = 130;
}  // namespace exit_code

/// Runs the case to its end time and writes everything that the folder is to hold. Returns exit_code::done or
/// exit_code::interrupted. Throws CaseError, PhysicsError, OutflowError and std::runtime_error; before a PhysicsError
/// or OutflowError leaves, the summary is written with the reason.
int run_case(const Case& definition, const RunOptions& options);

}  // namespace sluice
