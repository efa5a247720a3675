#include "experiments/cli/guarded.hpp"

#include <fmt/format.h>

#include <cstdio>

#include "experiments/cli/interrupt.hpp"
#include "experiments/cli/message_colors.hpp"
#include "libsim/base/error.hpp"

namespace modcal {

ExitCode guarded(const Action& action) {
  try {
    return action();
  } catch (const InvalidInput& error) {
    fmt::print(stderr, "{} {}\n", colored("error:"), error.what());
    return ExitCode::kInvalidInput;
  } catch (const Interrupted&) {
    return ExitCode::kInterrupted;
  } catch (const std::exception& error) {
    fmt::print(stderr, "internal error: {}\nPlease report it with the file and the command.\n",
               error.what());
    return ExitCode::kInternal;
  }
}

}  // namespace modcal
