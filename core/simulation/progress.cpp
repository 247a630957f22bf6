#include "core/simulation/progress.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace sluice {

namespace {

/// A line that is longer than the terminal is wide would not be redrawn but begun anew each time.
std::size_t terminal_width() {
  winsize size{};
  return ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1 ? size.ws_col : 80;
}

/// The leading parts of a line, between bars, that have room.
std::string fitted(const std::string& line, std::size_t width) {
  if (line.size() <= width) return line;
  const auto bar = line.rfind(" | ", width);
  return line.substr(0, bar == std::string::npos ? width : bar);
}

}  // namespace

std::string duration_text(double seconds) {
  if (!std::isfinite(seconds)) return "?";
  const auto s = static_cast<long long>(std::llround(seconds));
  if (s < 60) return fmt::format("{} s", s);
  if (s < 3600) return fmt::format("{} min {:02} s", s / 60, s % 60);
  return fmt::format("{} h {:02} min", s / 3600, s / 60 % 60);
}

Progress::Progress(bool quiet, double start_time, double end_time)
    : quiet_(quiet),
      terminal_(isatty(STDOUT_FILENO) == 1),
      start_time_(start_time),
      end_time_(end_time),
      started_(Clock::now()),
      shown_(Clock::now()) {}

void Progress::show(const Simulation& simulation, const StepInfo& info) {
  if (quiet_) return;
  const auto now = Clock::now();
  const double interval = terminal_ ? 0.2 : 10;
  if (std::chrono::duration<double>(now - shown_).count() < interval) return;
  shown_ = now;
  const double elapsed = std::chrono::duration<double>(now - started_).count();
  const double done = simulation.time() - start_time_;
  const double left = done > 0 ? elapsed * (end_time_ - simulation.time()) / done : INFINITY;
  const std::string line =
      fmt::format("{:8.3f} of {:g} s | {} left | dt {:.3g} s ({}) | step {} | max {:.3g} m/s", simulation.time(),
                  end_time_, duration_text(left), info.dt, info.limiter, simulation.steps(), info.speed);
  if (terminal_)
    fmt::print("\r{}\x1b[K", fitted(line, terminal_width() - 1));
  else
    fmt::print("{}\n", line);
  line_open_ = terminal_;
  std::fflush(stdout);
}

void Progress::end_line() {
  if (line_open_) fmt::print("\n");
  line_open_ = false;
  std::fflush(stdout);
}

}  // namespace sluice
