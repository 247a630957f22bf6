/// Provenance: where results come from, stored in results.h5 under /Sluice.
#pragma once

#include <string>
#include <vector>

#include "core/case/case.h"

namespace sluice {

struct Provenance {
  std::string case_text;      ///< the case file, verbatim
  std::string resolved_case;  ///< with all defaults filled in
  std::string title;
  std::string version;
  std::string compiler;
  std::string host;
  std::string start_time;  ///< ISO 8601
  int threads = 1;
  GridCase grid;

  /// Fills compiler, host and start time of this process.
  static Provenance of_this_process();
};

}  // namespace sluice
