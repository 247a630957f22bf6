/// Problems: everything that is wrong with a case, gathered so that one run of the program shows all of it.
#pragma once

#include <string>
#include <vector>

#include "core/case/node.h"

namespace sluice {

class Problems {
 public:
  void add(const Place& place, const std::string& message);
  /// An error that already says where it is; `place` sorts it among the others.
  void add(const Place& place, const CaseError& error);
  bool empty() const { return found_.empty(); }
  /// Throws one CaseError with one line a problem, sorted by place.
  void throw_if_any() const;

 private:
  struct Found {
    Place place;
    std::string line;
  };
  std::vector<Found> found_;
};

}  // namespace sluice
