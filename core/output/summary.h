/// Summary: how a run ended and what it cost, as DIR/summary.json.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace sluice {

struct Summary {
  std::string exit_reason;  ///< for example "end_time_reached", "interrupted"
  std::string version;
  double time = 0;  ///< simulated [s]
  std::int64_t steps = 0;
  std::int64_t particles = 0;
  int threads = 1;
  double wall_seconds = 0;
  double particle_steps_per_second = 0;
  std::map<std::string, double> stage_seconds;
  std::map<std::string, double> observations;                ///< final values, by name in the case file, SI units
  std::map<std::string, double> extra;                       ///< further numbers, written beside the others
  std::vector<std::pair<std::string, std::string>> verdict;  ///< of an advisor that decided, in words and numbers
};

/// Writes the file aside and moves it into place. A number that is not finite becomes null. Throws std::runtime_error.
void write_summary(const std::filesystem::path& path, const Summary& summary);

}  // namespace sluice
