#include "core/case/registry.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace sluice {

Catalogue::Catalogue(std::string kind, std::string plural) : kind_(std::move(kind)), plural_(std::move(plural)) {
  if (!plural_.empty()) all().emplace(plural_, this);
}

Catalogue::~Catalogue() {
  const auto found = all().find(plural_);
  if (found != all().end() && found->second == this) all().erase(found);
}

std::vector<std::string> Catalogue::names() const {
  std::vector<std::string> names;
  for (const auto& [name, entry] : entries_) names.push_back(name);
  return names;
}

void Catalogue::require(const std::string& name, const Place& where) const {
  if (entries_.count(name) != 0) return;
  throw CaseError(where, fmt::format("unknown {} '{}'; {}", kind_, name, allowed_words(name, names())));
}

std::map<std::string, Catalogue*>& Catalogue::all() {
  static std::map<std::string, Catalogue*> catalogues;
  return catalogues;
}

}  // namespace sluice
