#include "core/transfer/transfer_scheme.h"

namespace sluice {
namespace {

const bool registered = transfer_registry().add("apic",
                                                {"Affine particle-in-cell: particles carry an affine velocity field; "
                                                 "keeps linear and angular momentum. Jiang et al. "
                                                 "(2015), docs/theory.md eq. (20).",
                                                 {}},
                                                TransferScheme{.affine = true});

}  // namespace
}  // namespace sluice
