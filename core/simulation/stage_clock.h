/// StageClock: where the time of a run goes, stage by stage.
#pragma once

#include <array>
#include <chrono>
#include <map>
#include <string>

namespace sluice {

/// The stages of a step, in the textbook's words.
enum class Stage { sort, scatter, nodes, stress, gather, pressure_assembly, pressure_solve, output, count };

class StageClock {
 public:
  /// Counts the time until it goes out of scope to `stage`.
  class Scope {
   public:
    Scope(StageClock& clock, Stage stage) : clock_(clock), stage_(stage), start_(now()) {}
    ~Scope() {
      clock_.seconds_[static_cast<std::size_t>(stage_)] += std::chrono::duration<double>(now() - start_).count();
    }
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;

   private:
    static std::chrono::steady_clock::time_point now() { return std::chrono::steady_clock::now(); }
    StageClock& clock_;
    Stage stage_;
    std::chrono::steady_clock::time_point start_;
  };

  Scope time(Stage stage) { return {*this, stage}; }
  std::map<std::string, double> seconds() const {
    static constexpr std::array names = {"sort",   "scatter",           "nodes",          "stress",
                                         "gather", "pressure_assembly", "pressure_solve", "output"};
    std::map<std::string, double> table;
    for (std::size_t s = 0; s < names.size(); ++s) table[names[s]] = seconds_[s];
    return table;
  }

 private:
  std::array<double, static_cast<std::size_t>(Stage::count)> seconds_{};
};

}  // namespace sluice
