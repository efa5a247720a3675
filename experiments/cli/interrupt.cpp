#include "experiments/cli/interrupt.hpp"

#include <csignal>

namespace modcal {
namespace {

std::atomic<bool> flag{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler sets it");

void on_signal(int number) {
  flag.store(true, std::memory_order_relaxed);
  std::signal(number, SIG_DFL);
}

}  // namespace

void catch_interrupts() {
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
}

StopToken interrupt_token() { return StopToken(flag); }

bool interrupted() { return interrupt_token().requested(); }

}  // namespace modcal
