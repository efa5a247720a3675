// Independent tasks spread over threads, and how long work learns that it is to end.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>

#include "libsim/base/error.hpp"

namespace modcal {

/// A wish to stop, polled by the work: between the tasks of a list, and by a simulator between the
/// samples of its record. Copies look at the same flag, which must outlive them and may be set from
/// any thread or signal handler. Without a flag nobody can ask.
///
/// It also takes back how far the work is, where somebody wants to be told.
class StopToken {
 public:
  using Told = std::function<void(double)>;

  StopToken() = default;
  explicit StopToken(const std::atomic<bool>& flag) : flag_(&flag) {}

  /// The same wish; `told`, which must outlive the copy, gets the share done now and then.
  StopToken telling(const Told& told) const {
    StopToken copy = *this;
    copy.told_ = &told;
    return copy;
  }
  /// Called by a loop before sample `done` of `all`: tells once in 1024 samples, which costs the
  /// others nothing but a branch.
  void tell(std::size_t done, std::size_t all) const {
    if (told_ != nullptr && done % 1024 == 0) tell_share(done, all);
  }

  bool requested() const { return flag_ != nullptr && flag_->load(std::memory_order_relaxed); }
  void throw_if_requested() const {
    if (requested()) throw Interrupted();
  }

 private:
  // Apart from the loops, so that kernels have no call in them.
  void tell_share(std::size_t done, std::size_t all) const;

  const std::atomic<bool>* flag_ = nullptr;
  const Told* told_ = nullptr;
};

/// Calls task(i) once for every i in [0, count), over the threads that oneTBB is allowed
/// (tbb::global_control), in any order. What task(i) does must depend on i alone; then results that
/// are kept by i are the same bits for any number of threads.
///
/// A task may run a loop of its own: a thread that waits for it takes part in that loop alone, so
/// that a task once begun is not put off by others of its list.
///
/// Where tasks throw, the exception of the smallest such i is thrown when all tasks before it have
/// ended: the same one whatever the threads; tasks after it may be left out. Throws Interrupted
/// where `stop` was requested; tasks that had not begun are left out then.
void for_each_task(std::size_t count, const std::function<void(std::size_t)>& task,
                   const StopToken& stop = {});

}  // namespace modcal
