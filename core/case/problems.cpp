#include "core/case/problems.h"

#include <algorithm>
#include <tuple>

namespace sluice {

void Problems::add(const Place& place, const std::string& message) { add(place, CaseError(place, message)); }

void Problems::add(const Place& place, const CaseError& error) {
  const std::string line = error.what();
  // The same node may be read twice, for example through an alias.
  for (const Found& found : found_)
    if (found.line == line) return;
  found_.push_back({place, line});
}

void Problems::throw_if_any() const {
  if (found_.empty()) return;
  auto sorted = found_;
  std::stable_sort(sorted.begin(), sorted.end(), [](const Found& a, const Found& b) {
    return std::tie(a.place.file, a.place.line, a.place.column) < std::tie(b.place.file, b.place.line, b.place.column);
  });
  std::string lines;
  for (const Found& found : sorted) lines += (lines.empty() ? "" : "\n") + found.line;
  throw CaseError(lines);
}

}  // namespace sluice
