#pragma once

namespace modcal {

/// What a command tells the shell.
enum class ExitCode : int {
  kOk = 0,
  kInternal = 1,
  kUsage = 2,
  kInvalidInput = 3,
  kSomeTasksFailed = 4,
  kAcceptanceMissed = 5,
  kNothingMeasured = 6,
  kInterrupted = 130,
};

}  // namespace modcal
