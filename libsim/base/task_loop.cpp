#include "libsim/base/task_loop.hpp"

#include <tbb/parallel_for.h>

#include <atomic>
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
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t index) {
    if (stop.requested() || failure.is_before(index)) return;
    try {
      task(index);
    } catch (...) {
      failure.keep(index, std::current_exception());
    }
  });
  stop.throw_if_requested();
  failure.rethrow();
}

}  // namespace modcal
