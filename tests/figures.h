/// Tables behind the figures of docs/stability. `docs/stability/regenerate` sets SLUICE_FIGURES to a folder, and tests
/// then compute whole maps and write them there; without it they check a few places of them.
#pragma once

#include <fmt/format.h>

#include <cstdlib>
#include <fstream>
#include <string>

namespace sluice {

/// The folder for the tables, or none.
inline const char* figures_folder() { return std::getenv("SLUICE_FIGURES"); }

/// A table of comma-separated values, to which several tests may add rows; the first one writes the header. Nothing is
/// written where no figures are asked for.
class FigureTable {
 public:
  FigureTable(const std::string& name, const std::string& header) {
    if (figures_folder() == nullptr) return;
    file_.open(fmt::format("{}/{}.csv", figures_folder(), name), std::ios::app);
    if (file_.tellp() == 0) file_ << header << '\n';
  }
  template <class... Values>
  void row(const Values&... values) {
    std::string line;
    ((line += fmt::format("{}{}", line.empty() ? "" : ",", text(values))), ...);
    if (file_.is_open()) file_ << line << std::endl;
  }

 private:
  template <class Value>
  static std::string text(const Value& value) {
    if constexpr (std::is_floating_point_v<Value>) return fmt::format("{:.10g}", value);
    return fmt::format("{}", value);
  }
  std::ofstream file_;
};

}  // namespace sluice
