#include "core/transfer/transfer_scheme.h"

namespace sluice {
namespace {

const bool registered = transfer_registry().add("tpic",
                                                {"Taylor particle-in-cell: particles carry the gradient of the "
                                                 "velocity as their affine field. Nakamura et al. (2023), "
                                                 "docs/theory.md eq. (20a).",
                                                 {}},
                                                TransferScheme{.affine = true, .gradient = true});

}  // namespace
}  // namespace sluice
