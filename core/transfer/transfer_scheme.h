/// TransferScheme: how velocity travels between particles and nodes.
#pragma once

#include "core/case/registry.h"

namespace sluice {

/// The traits by which the transfer kernels differ. A scheme is registered under the name that a case file uses.
struct TransferScheme {
  bool affine = false;    ///< particles carry an affine velocity field (APIC)
  bool gradient = false;  ///< which is the gradient of the velocity (TPIC); with `affine`
  bool filtered = false;  ///< velocities keep what the grid can see, by further mappings (XPIC): see VelocityFilter
};

Registry<TransferScheme>& transfer_registry();

}  // namespace sluice
