/// Command: a subcommand of `sluice` that lives outside of the core. It registers itself, as materials do, so that
/// `main` need not know it.
#pragma once

#include <functional>

#include "core/case/registry.h"

namespace CLI {
class App;
}

namespace sluice {

/// Declares the arguments on the subcommand, and returns what runs it once they are read: that returns the exit code.
using Command = std::function<std::function<int()>(CLI::App& app)>;
Registry<Command>& command_registry();

}  // namespace sluice
