#include "core/transfer/transfer_scheme.h"

namespace sluice {
namespace {

const bool registered = transfer_registry().add(
    "flip",
    {"Blend of FLIP (particles add the nodes' change of velocity) and PIC (they take the nodes' velocity); "
     "scheme.flip_fraction sets the share of FLIP. Brackbill & Ruppel (1986), docs/theory.md eq. (19).",
     {}},
    TransferScheme{});

}  // namespace
}  // namespace sluice
