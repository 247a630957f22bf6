#include "core/transfer/transfer_scheme.h"

namespace sluice {
namespace {

const bool registered = transfer_registry().add(
    "xpic",
    {"Extended particle-in-cell: velocities lose what the grid cannot see and little else; scheme.xpic_order more "
     "mappings for the latter. Hammerquist & Nairn (2017), docs/theory.md eq. (20b).",
     {}},
    TransferScheme{.filtered = true});

}  // namespace
}  // namespace sluice
