/// CsvTable: a table that grows by one row at a time, such as history.csv.
///
/// The header names columns with their units (`time_s`). Numbers are written with the fewest digits that read back to
/// the same double; a text cell with a comma or quote is quoted. Every row reaches the operating system at once, so
/// that a killed run loses none.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace sluice {

class CsvTable {
 public:
  using Cell = std::variant<double, std::int64_t, std::string>;

  /// Begins a new table, replacing an old one.
  CsvTable(std::filesystem::path path, std::vector<std::string> columns);
  /// Continues the table of an interrupted run: keeps the rows whose `time_column` is at most `time` [s] and drops the
  /// others, and a last row that was cut. A missing file begins a new table. Throws std::runtime_error if the file has
  /// other columns.
  CsvTable(std::filesystem::path path, std::vector<std::string> columns, const std::string& time_column, double time);

  /// `cells.size()` is the number of columns.
  void append(const std::vector<Cell>& cells);

 private:
  std::string header() const;
  void keep_rows_until(std::size_t time_column, double time) const;
  void open_at_end();
  void write(const std::string& line);

  std::filesystem::path path_;
  std::vector<std::string> columns_;
  std::ofstream file_;
};

/// A text as a cell: in quotes where it holds a comma, a quote or a new line.
std::string csv_text(const std::string& text);
/// The cells of a line, quotes resolved.
std::vector<std::string> csv_cells(std::string_view line);

}  // namespace sluice
