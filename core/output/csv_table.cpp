#include "core/output/csv_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <charconv>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "core/output/file_aside.h"

namespace sluice {

namespace {

std::string cell_text(const CsvTable::Cell& cell) {
  if (const auto* text = std::get_if<std::string>(&cell)) return csv_text(*text);
  if (const auto* integer = std::get_if<std::int64_t>(&cell)) return std::to_string(*integer);
  return fmt::format("{}", std::get<double>(cell));
}

/// The cell at `index`; NaN if it is not a number.
double number_at(std::string_view line, std::size_t index) {
  const auto cells = csv_cells(line);
  double value = std::numeric_limits<double>::quiet_NaN();
  if (index >= cells.size()) return value;
  const std::string& cell = cells[index];
  std::from_chars(cell.data(), cell.data() + cell.size(), value);
  return value;
}

}  // namespace

std::string csv_text(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted.append(c == '"' ? 2 : 1, c);
  return quoted + '"';
}

std::vector<std::string> csv_cells(std::string_view line) {
  std::vector<std::string> cells(1);
  bool inside = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (c == '"' && inside && i + 1 < line.size() && line[i + 1] == '"')
      cells.back() += line[++i];
    else if (c == '"')
      inside = !inside;
    else if (c == ',' && !inside)
      cells.emplace_back();
    else
      cells.back() += c;
  }
  return cells;
}

CsvTable::CsvTable(std::filesystem::path path, std::vector<std::string> columns)
    : path_(std::move(path)), columns_(std::move(columns)) {
  replace_text_file(path_, header());
  open_at_end();
}

CsvTable::CsvTable(std::filesystem::path path, std::vector<std::string> columns, const std::string& time_column,
                   double time)
    : path_(std::move(path)), columns_(std::move(columns)) {
  const auto found = std::find(columns_.begin(), columns_.end(), time_column);
  assert(found != columns_.end());
  if (std::filesystem::exists(path_))
    keep_rows_until(static_cast<std::size_t>(found - columns_.begin()), time);
  else
    replace_text_file(path_, header());
  open_at_end();
}

std::string CsvTable::header() const {
  std::string line;
  for (const auto& column : columns_) line += (line.empty() ? "" : ",") + csv_text(column);
  return line + '\n';
}

void CsvTable::keep_rows_until(std::size_t time_column, double time) const {
  std::ifstream file(path_, std::ios::binary);
  std::stringstream content;
  content << file.rdbuf();
  const std::string text = content.str();
  std::string kept = header();
  if (text.compare(0, kept.size(), kept) != 0)
    throw std::runtime_error(path_.string() + ": cannot be continued: its first line is \"" +
                             text.substr(0, text.find('\n')) + "\", and this run writes \"" +
                             kept.substr(0, kept.size() - 1) + "\"");
  for (std::size_t begin = kept.size(), end; (end = text.find('\n', begin)) != std::string::npos; begin = end + 1) {
    const std::string_view line(text.data() + begin, end - begin);
    if (number_at(line, time_column) <= time) kept.append(line).push_back('\n');
  }
  replace_text_file(path_, kept);
}

void CsvTable::open_at_end() {
  file_.open(path_, std::ios::binary | std::ios::app);
  if (!file_) throw std::runtime_error(path_.string() + ": cannot be opened");
}

void CsvTable::write(const std::string& line) {
  file_ << line << std::flush;
  if (!file_) throw std::runtime_error(path_.string() + ": cannot be written");
}

void CsvTable::append(const std::vector<Cell>& cells) {
  assert(cells.size() == columns_.size());
  std::string line;
  for (std::size_t i = 0; i < cells.size(); ++i) line += (i == 0 ? "" : ",") + cell_text(cells[i]);
  write(line + '\n');
}

}  // namespace sluice
