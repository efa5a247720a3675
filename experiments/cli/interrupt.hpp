// Ctrl-C and termination, as a wish that the work polls.
#pragma once

#include "libsim/base/task_loop.hpp"

namespace modcal {

/// From now on SIGINT and SIGTERM request a stop; a second one ends the process at once.
void catch_interrupts();
StopToken interrupt_token();
bool interrupted();

}  // namespace modcal
