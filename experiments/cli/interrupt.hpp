// Ctrl-C and termination, as a flag that the work polls.
#pragma once

namespace modcal {

/// From now on SIGINT and SIGTERM set the flag; a second one ends the process at once.
void catch_interrupts();
bool interrupted();

}  // namespace modcal
