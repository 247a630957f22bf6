#include "core/transfer/transfer_scheme.h"

namespace sluice {

Registry<TransferScheme>& transfer_registry() {
  static Registry<TransferScheme> registry("transfer scheme", "transfers");
  return registry;
}

}  // namespace sluice
