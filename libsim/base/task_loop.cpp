#include "libsim/base/task_loop.hpp"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <exception>
#include <mutex>

namespace modcal {
namespace {

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

}  // namespace

void for_each_task(std::size_t count, const std::function<void(std::size_t)>& task,
                   const StopToken& stop) {
  FirstFailure failure(count);
  const auto guarded = [&](std::size_t index) {
    if (stop.requested() || failure.is_before(index)) return;
    try {
      task(index);
    } catch (...) {
      failure.keep(index, std::current_exception());
    }
  };
  // Isolated: a thread that waits for a loop inside a task would otherwise begin another task of
  // the outer loop, and come back when that one, and all it began, has ended.
  tbb::this_task_arena::isolate([&] { tbb::parallel_for(std::size_t{0}, count, guarded); });
  stop.throw_if_requested();
  failure.rethrow();
}

}  // namespace modcal
