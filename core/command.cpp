#include "core/command.h"

namespace sluice {

Registry<Command>& command_registry() {
  static Registry<Command> registry("command", "");  // no plural: nothing that a case file could name
  return registry;
}

}  // namespace sluice
