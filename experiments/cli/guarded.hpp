#pragma once

#include "experiments/cli/command.hpp"

namespace modcal {

/// What `action` returns; an exception becomes one message on stderr and its exit code.
ExitCode guarded(const Action& action);

}  // namespace modcal
