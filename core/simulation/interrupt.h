/// Interruption by the user: Ctrl-C and SIGTERM end a run in order, with a checkpoint.
#pragma once

namespace sluice {

/// From now on SIGINT and SIGTERM are noted instead of ending the program; a second one ends it at once.
void watch_for_interruption();
bool interrupted();

}  // namespace sluice
