/// Progress: what a run tells the terminal.
#pragma once

#include <chrono>
#include <string>

#include "core/simulation/simulation.h"

namespace sluice {

/// One line, redrawn on a terminal a few times a second, written now and then where there is none: time, step, dt and
/// what limits it, speed, time left.
class Progress {
 public:
  Progress(bool quiet, double start_time, double end_time);
  void show(const Simulation& simulation, const StepInfo& info);
  /// Ends the redrawn line, so that other output can follow.
  void end_line();

 private:
  using Clock = std::chrono::steady_clock;
  bool quiet_, terminal_, line_open_ = false;
  double start_time_, end_time_;
  Clock::time_point started_, shown_;
};

/// "4 min 05 s", "12 s", "3 h 10 min"
std::string duration_text(double seconds);

}  // namespace sluice
