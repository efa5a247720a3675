// Colours of messages on a terminal.
#pragma once

#include <chrono>
#include <mutex>

#include "libsim/base/task_loop.hpp"

namespace modcal {

/// The text with "error:", "warning:" and carets marked, where messages on standard error may be
/// coloured: it is a terminal that is not "dumb", and NO_COLOR is not set (no-color.org: set to
/// anything but the empty text).
std::string colored(const std::string& text);

// Progress on stderr: one line that is rewritten on a terminal, a line every few seconds elsewhere.

class Progress {
 public:
  explicit Progress(std::string what);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Share done in [0, 1]; may be called from any thread.
  void report(double share);

 private:
  using Clock = std::chrono::steady_clock;
  std::mutex mutex_;
  std::string what_;
  bool terminal_;
  bool shown_ = false;
  Clock::time_point start_;
  Clock::time_point last_;
};

// Ctrl-C and termination, as a wish that the work polls.

/// From now on SIGINT and SIGTERM request a stop; a second one ends the process at once.
void catch_interrupts();
StopToken interrupt_token();
bool interrupted();

}  // namespace modcal
