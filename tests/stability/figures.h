/// Tables behind the figures of docs/stability. `docs/stability/regenerate` sets SLUICE_FIGURES to a folder, and tests
/// then compute whole maps and write them there; without it they check a few places of them.
#pragma once

#include <fmt/format.h>
#include <fmt/os.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <optional>
#include <string>

namespace sluice {

/// The folder for the tables, or none.
inline const char* figures_folder() { return std::getenv("SLUICE_FIGURES"); }

/// A table of comma-separated values, a header first. Nothing is written where no figures are asked for.
class FigureTable {
 public:
  FigureTable(const std::string& name, const std::string& header) {
    if (const char* const folder = figures_folder())
      file_.emplace(fmt::output_file(fmt::format("{}/{}.csv", folder, name)));
    if (file_) file_->print("{}\n", header);
  }
  template <class... Values>
  void row(const Values&... values) {
    std::string line;
    ((line += fmt::format("{}{}", line.empty() ? "" : ",", values)), ...);
    if (file_) file_->print("{}\n", line);
  }

 private:
  std::optional<fmt::ostream> file_;
};

}  // namespace sluice
