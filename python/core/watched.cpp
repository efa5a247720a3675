#include "python/core/watched.hpp"

#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>

#include "libsim/base/stop_scope.hpp"
#include "libsim/base/task_loop.hpp"

namespace modcal::python {
namespace {

// The work's thread tells how far it is; the waiting one listens.
class Work {
 public:
  explicit Work(const std::function<void(const Watch&)>& work)
      : thread_([this, &work] { run(work); }) {}
  ~Work() {
    stop_ = true;
    thread_.join();
  }
  Work(const Work&) = delete;
  Work& operator=(const Work&) = delete;

  bool wait(std::chrono::milliseconds time) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, time, [this] { return ended_; });
  }
  void stop() { stop_ = true; }
  double share() const { return share_; }
  void rethrow() const {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  void run(const std::function<void(const Watch&)>& work) {
    try {
      const StopToken token(stop_);
      const StopScope listening(token);
      work({stop_, [this](double share) { share_ = share; }});
    } catch (...) {
      error_ = std::current_exception();
    }
    const std::lock_guard lock(mutex_);
    ended_ = true;
    changed_.notify_one();
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  bool ended_ = false;
  std::atomic<bool> stop_ = false;
  std::atomic<double> share_ = 0.0;
  std::exception_ptr error_;
  std::thread thread_;  // the last: it uses the others
};

}  // namespace

void do_watched(const py::object& progress, const std::function<void(const Watch&)>& work) {
  constexpr std::chrono::milliseconds kPause{50};
  std::exception_ptr raised;
  std::exception_ptr thrown;
  {
    const py::gil_scoped_release unlocked;
    Work running(work);
    while (!running.wait(kPause)) {
      if (raised) continue;
      const py::gil_scoped_acquire locked;
      try {
        if (PyErr_CheckSignals() != 0) throw py::error_already_set();
        if (!progress.is_none()) progress(running.share());
      } catch (...) {
        raised = std::current_exception();
        running.stop();
      }
    }
    try {
      running.rethrow();
    } catch (...) {
      thrown = std::current_exception();
    }
  }
  if (raised) std::rethrow_exception(raised);
  if (thrown) std::rethrow_exception(thrown);
  if (!progress.is_none()) progress(1.0);
}

}  // namespace modcal::python
