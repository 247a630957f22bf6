#include "core/output/provenance.h"

#include <fmt/chrono.h>
#include <unistd.h>

#include <array>
#include <ctime>

namespace sluice {

Provenance Provenance::of_this_process() {
  Provenance result;
#ifdef __clang__
  result.compiler = __VERSION__;  // Clang names itself in it
#else
  result.compiler = "GCC " __VERSION__;
#endif
  std::array<char, 256> host{};
  if (::gethostname(host.data(), host.size() - 1) == 0) result.host = host.data();
  result.start_time = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
  return result;
}

}  // namespace sluice
