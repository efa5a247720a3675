#include "libsim/base/task_loop.hpp"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <exception>
#include <mutex>
#include <stdexcept>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "libsim/base/stop_scope.hpp"

namespace modcal {
namespace {

thread_local const StopScope* innermost = nullptr;

// The exception of the first task in the list that failed.
class FirstFailure {
 public:
  explicit FirstFailure(std::size_t count) : index_(count) {}

  bool is_before(std::size_t index) const { return index_.load(std::memory_order_relaxed) < index; }

  void keep(std::size_t index, std::exception_ptr error) {
    const std::lock_guard lock(mutex_);
    if (index >= index_) return;
    index_ = index;
    error_ = std::move(error);
  }

  void rethrow() const {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  std::atomic<std::size_t> index_;
  std::mutex mutex_;
  std::exception_ptr error_;
};

#ifdef __SANITIZE_THREAD__
// The sanitizer does not see how a oneTBB that is not built for it hands work over.
template <typename Task>
void spread(std::size_t count, const Task& task) {
  const std::size_t allowed =
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i = next++; i < count; i = next++) task(i);
  };
  std::vector<std::thread> others;
  for (std::size_t i = 1; i < std::min(count, allowed); ++i) others.emplace_back(work);
  work();
  for (std::thread& other : others) other.join();
}
#else
// Isolated: a thread that waits for a loop inside a task would otherwise begin another task of the
// outer loop, and come back when that one, and all it began, has ended.
template <typename Task>
void spread(std::size_t count, const Task& task) {
  try {
    tbb::this_task_arena::isolate([&] { tbb::parallel_for(std::size_t{0}, count, task); });
  } catch (const std::runtime_error& error) {
    // The tasks keep what they throw: this is of oneTBB, and of the system's limits.
    throw std::system_error(std::make_error_code(std::errc::resource_unavailable_try_again),
                            std::string("the threads of the tasks cannot be started (") +
                                error.what() + "); raise the limits (ulimit -a) or --threads 1");
  }
}
#endif

}  // namespace

void StopToken::tell_share(std::size_t done, std::size_t all) const {
  (*told_)(static_cast<double>(done) / static_cast<double>(all));
}

StopScope::StopScope(const StopToken* stop, const StopScope* outer)
    : stop_(stop), outer_(outer), before_(innermost) {
  innermost = this;
}

StopScope::~StopScope() { innermost = before_; }

const StopScope* StopScope::here() { return innermost; }

bool StopScope::requested() const {
  return (stop_ != nullptr && stop_->requested()) || (outer_ != nullptr && outer_->requested());
}

void throw_if_stopped() {
  if (innermost != nullptr && innermost->requested()) throw Interrupted();
}

void for_each_task(std::size_t count, const std::function<void(std::size_t)>& task,
                   const StopToken& stop) {
  FirstFailure failure(count);
  const StopScope wish(stop);
  const auto guarded = [&](std::size_t index) {
    if (wish.requested() || failure.is_before(index)) return;
    const StopScope handed_on(&wish);
    try {
      task(index);
    } catch (...) {
      failure.keep(index, std::current_exception());
    }
  };
  spread(count, guarded);
  throw_if_stopped();
  failure.rethrow();
}

}  // namespace modcal
