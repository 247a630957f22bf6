#include "core/version.h"

#include "sluice_version.h"

namespace sluice {

std::string_view version() { return SLUICE_VERSION; }
std::string_view commit() { return SLUICE_COMMIT; }
std::string_view compiler() { return SLUICE_COMPILER; }
std::string_view build_type() { return SLUICE_BUILD_TYPE; }

std::string version_text() {
  std::string text(version());
  if (!commit().empty()) text += " (" + std::string(commit()) + ")";
  return text;
}

}  // namespace sluice
