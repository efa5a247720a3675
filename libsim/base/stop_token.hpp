// How long work learns that somebody wants it to end.
#pragma once

#include <atomic>

#include "libsim/base/error.hpp"

namespace modcal {

/// A wish to stop, polled by the work: between the tasks of a list, and by a simulator between the
/// samples of its record. Copies look at the same flag, which must outlive them and may be set from
/// any thread or signal handler. Without a flag nobody can ask.
class StopToken {
 public:
  StopToken() = default;
  explicit StopToken(const std::atomic<bool>& flag) : flag_(&flag) {}

  bool requested() const { return flag_ != nullptr && flag_->load(std::memory_order_relaxed); }
  void throw_if_requested() const {
    if (requested()) throw Interrupted();
  }

 private:
  const std::atomic<bool>* flag_ = nullptr;
};

}  // namespace modcal
