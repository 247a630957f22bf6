/// Ledger: every run of a study as a row of runs.csv, written when the run ends. What stands there is not run again.
#pragma once

#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "core/chart/measured_run.h"

namespace sluice::chart {

/// One run of one variant.
struct Entry {
  std::string identity;  ///< of the case with all settings, the error and the limits
  std::string variant;
  int repetition = 1;
  std::string version;  ///< of the program
  double error = 0;     ///< NaN where there is none
  RunReport report;
};

class Ledger {
 public:
  /// Reads what is there. A last row that was cut is dropped. Throws std::runtime_error for a file of another kind, and
  /// where another study, or a run that one left behind, works in the folder.
  Ledger(std::filesystem::path file, bool start_anew);
  ~Ledger();
  Ledger(const Ledger&) = delete;
  Ledger& operator=(const Ledger&) = delete;
  void append(const Entry& entry);
  const std::vector<Entry>& entries() const { return entries_; }
  const Entry* find(const std::string& identity, int repetition) const;

 private:
  void read();
  void lock_folder();
  std::filesystem::path file_;
  int folder_ = -1;  ///< descriptor of the locked folder; the runs inherit it, so the lock ends with the last of them
  std::vector<Entry> entries_;
  std::ofstream out_;
};

}  // namespace sluice::chart
