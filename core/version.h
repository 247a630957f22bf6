/// Which program this is: written into results, so that a number can be traced to the code that made it.
#pragma once

#include <string>
#include <string_view>

namespace sluice {

std::string_view version();     ///< "0.1.0"
std::string_view commit();      ///< abbreviated git hash at configuration; "" outside a git checkout
std::string_view compiler();    ///< "GNU 12.2.0"
std::string_view build_type();  ///< "Release" or "Debug"

std::string version_text();  ///< "0.1.0 (1a2b3c4d5e6f)"

}  // namespace sluice
