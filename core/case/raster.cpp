#include "core/case/raster.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <sstream>
#include <string_view>

namespace sluice {

Raster::Raster(std::string file, int columns, int rows, std::array<double, 2> corner, double cell,
               std::vector<double> heights)
    : file_(std::move(file)),
      columns_(columns),
      rows_(rows),
      corner_(corner),
      cell_(cell),
      heights_(std::move(heights)),
      extremes_{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()} {
  for (const double h : heights_) {
    if (std::isnan(h)) continue;
    extremes_[0] = std::min(extremes_[0], h);
    extremes_[1] = std::max(extremes_[1], h);
  }
}

std::array<std::array<double, 2>, 2> Raster::extent() const {
  return {corner_, {corner_[0] + columns_ * cell_, corner_[1] + rows_ * cell_}};
}

std::optional<Raster::Cell> Raster::around(double x, double y) const {
  const double i = (x - corner_[0]) / cell_, j = (y - corner_[1]) / cell_;
  // False for NaN, too.
  if (!(i >= 0 && i <= columns_ && j >= 0 && j <= rows_)) return {};
  const double from_i = std::clamp(i - 0.5, 0.0, columns_ - 1.0), from_j = std::clamp(j - 0.5, 0.0, rows_ - 1.0);
  const int i0 = std::min(static_cast<int>(from_i), std::max(columns_ - 2, 0)), i1 = std::min(i0 + 1, columns_ - 1);
  const int j0 = std::min(static_cast<int>(from_j), std::max(rows_ - 2, 0)), j1 = std::min(j0 + 1, rows_ - 1);
  const auto at = [&](int column, int row) {
    return heights_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                    static_cast<std::size_t>(column)];
  };
  return Cell{{at(i0, j0), at(i1, j0), at(i0, j1), at(i1, j1)}, from_i - i0, from_j - j0};
}

std::optional<double> Raster::height(double x, double y) const {
  const auto cell = around(x, y);
  if (!cell) return {};
  const std::array<double, 4> weight{(1 - cell->u) * (1 - cell->v), cell->u * (1 - cell->v), (1 - cell->u) * cell->v,
                                     cell->u * cell->v};
  double sum = 0;
  for (std::size_t k = 0; k < 4; ++k)
    if (weight[k] > 0) sum += weight[k] * cell->height[k];
  if (std::isnan(sum)) return {};
  return sum;
}

std::array<double, 2> Raster::slope(double x, double y) const {
  const auto cell = around(x, y);
  if (!cell) return {0, 0};
  const auto& h = cell->height;
  const double along_x = ((1 - cell->v) * (h[1] - h[0]) + cell->v * (h[3] - h[2])) / cell_;
  const double along_y = ((1 - cell->u) * (h[2] - h[0]) + cell->u * (h[3] - h[1])) / cell_;
  return {std::isnan(along_x) ? 0 : along_x, std::isnan(along_y) ? 0 : along_y};
}

namespace {

const std::vector<std::string> header_words{"ncols",     "nrows",     "xllcorner", "xllcenter",
                                            "yllcorner", "yllcenter", "cellsize",  "nodata_value"};

/// Reads the file word by word, and knows the line and column of each word.
class Words {
 public:
  explicit Words(const std::string& file) : file_(file) {
    std::ifstream stream(file, std::ios::binary);
    if (!stream) throw CaseError(Place{file, 0, 0}, "cannot be read");
    std::ostringstream all;
    all << stream.rdbuf();
    text_ = std::move(all).str();
  }

  /// The next word; empty at the end.
  std::string_view next() {
    while (at_ < text_.size() && is_blank(text_[at_])) {
      if (text_[at_] == '\n') ++line_, line_begin_ = at_ + 1;
      ++at_;
    }
    begin_ = at_;
    while (at_ < text_.size() && !is_blank(text_[at_])) ++at_;
    return std::string_view(text_).substr(begin_, at_ - begin_);
  }
  /// Steps back before the last word.
  void back() { at_ = begin_; }
  /// Of the last word.
  Place place() const { return {file_, line_, static_cast<int>(begin_ - line_begin_) + 1}; }

  double number(const std::string& what) {
    const std::string_view word = next();
    double value = 0;
    const char* const first = word.data() + (word.starts_with('+') ? 1 : 0);
    const auto [end, error] = std::from_chars(first, word.data() + word.size(), value);
    if (!word.empty() && error == std::errc() && end == word.data() + word.size() && std::isfinite(value)) return value;
    throw CaseError(place(), fmt::format("{}: found {}; expected a number", what,
                                         word.empty() ? "the end of the file" : "'" + std::string(word) + "'"));
  }

 private:
  static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

  std::string file_, text_;
  std::size_t at_ = 0, begin_ = 0, line_begin_ = 0;
  int line_ = 1;
};

std::string lower(std::string_view word) {
  std::string text(word);
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

struct Header {
  std::map<std::string, double> values;
  std::map<std::string, Place> places;
  bool has(const std::string& word) const { return values.contains(word); }
};

/// Up to the first word that begins like a number.
Header read_header(Words& words) {
  Header header;
  for (;;) {
    const std::string_view word = words.next();
    const bool letter = !word.empty() && std::isalpha(static_cast<unsigned char>(word.front()));
    const std::string key = lower(word);
    if (!letter || key == "nan") break;
    const Place place = words.place();
    if (std::ranges::find(header_words, key) == header_words.end())
      throw CaseError(place, fmt::format("unknown word '{}' in the header of the raster; {}", word,
                                         allowed_words(key, header_words)));
    if (header.has(key)) throw CaseError(place, fmt::format("'{}' stands twice in the header of the raster", word));
    header.values[key] = words.number(std::string(word));
    header.places[key] = place;
  }
  words.back();
  return header;
}

double required(const Header& header, const std::string& file, const std::string& word) {
  if (header.has(word)) return header.values.at(word);
  throw CaseError(Place{file, 1, 1}, fmt::format("the header of the raster has no '{}'", word));
}

int count(const Header& header, const std::string& file, const std::string& word) {
  const double number = required(header, file, word);
  if (number >= 1 && number <= 1e5 && number == std::floor(number)) return static_cast<int>(number);
  throw CaseError(header.places.at(word),
                  fmt::format("{}: found {:g}; expected a whole number from 1 to 100000", word, number));
}

/// The lower corner along an axis: of the cell, or half a cell from its middle.
double corner(const Header& header, const std::string& file, const std::string& axis, double cell) {
  const std::string at_corner = axis + "llcorner", at_centre = axis + "llcenter";
  if (header.has(at_corner) == header.has(at_centre))
    throw CaseError(header.has(at_corner) ? header.places.at(at_centre) : Place{file, 1, 1},
                    fmt::format("the header of the raster must have either '{}' or '{}'", at_corner, at_centre));
  return header.has(at_corner) ? header.values.at(at_corner) : header.values.at(at_centre) - 0.5 * cell;
}

}  // namespace

Raster read_raster(const std::string& file) {
  Words words(file);
  const Header header = read_header(words);
  const int columns = count(header, file, "ncols"), rows = count(header, file, "nrows");
  const double cell = required(header, file, "cellsize");
  if (cell <= 0) throw CaseError(header.places.at("cellsize"), fmt::format("cellsize: {:g} is not above 0", cell));
  const std::array<double, 2> low{corner(header, file, "x", cell), corner(header, file, "y", cell)};
  const double missing = header.has("nodata_value") ? header.values.at("nodata_value") : -9999;

  const auto stride = static_cast<std::size_t>(columns), lines = static_cast<std::size_t>(rows);
  std::vector<double> heights(stride * lines);
  for (std::size_t k = 0; k < heights.size(); ++k) {
    if (words.next().empty())
      throw CaseError(words.place(),
                      fmt::format("the raster ends after {} values; ncols times nrows is {}", k, heights.size()));
    words.back();
    const double value = words.number(fmt::format("value {} of row {}", k % stride + 1, k / stride + 1));
    // The file begins in the north.
    heights[(lines - 1 - k / stride) * stride + k % stride] =
        value == missing ? std::numeric_limits<double>::quiet_NaN() : value;
  }
  if (!words.next().empty())
    throw CaseError(words.place(),
                    fmt::format("the raster has more values than ncols times nrows, {}", heights.size()));
  if (std::ranges::all_of(heights, [](double h) { return std::isnan(h); }))
    throw CaseError(Place{file, 0, 0}, fmt::format("all values of the raster are NODATA, {:g}", missing));
  return {file, columns, rows, low, cell, std::move(heights)};
}

}  // namespace sluice
