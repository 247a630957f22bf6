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

/// Keeps other studies out of a folder. Processes that this one starts inherit the lock: it ends with the last of them.
class FolderLock {
 public:
  /// Waits a moment, for a run whose study was killed dies soon. Throws std::runtime_error if the folder stays locked;
  /// on a file system without locks nothing is refused.
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int descriptor_;
};

class Ledger {
 public:
  /// Reads what is there. A last row that was cut is dropped. Throws std::runtime_error for a file of another kind, and
  /// where another study, or a run that one left behind, works in the folder: they would write over each other's runs.
  Ledger(std::filesystem::path file, bool start_anew);
  void append(const Entry& entry);
  const std::vector<Entry>& entries() const { return entries_; }
  const Entry* find(const std::string& identity, int repetition) const;

 private:
  void read();
  std::filesystem::path file_;
  FolderLock lock_;
  std::vector<Entry> entries_;
  std::ofstream out_;
};

}  // namespace sluice::chart
