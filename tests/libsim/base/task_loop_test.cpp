#include "libsim/base/task_loop.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include "libsim/base/stop_scope.hpp"

namespace modcal::task_loop_test {
namespace {

// Runs `work` with so many threads, more than the machine has if need be.
template <typename Work>
void with_threads(int threads, const Work& work) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(threads));
  tbb::task_arena(threads).execute(work);
}

TEST(ForEachTask, RunsEveryTaskOnce) {
  for (const int threads : {1, 2, 3}) {
    std::vector<int> runs(1000, 0);
    with_threads(threads, [&] { for_each_task(runs.size(), [&](std::size_t i) { ++runs[i]; }); });
    EXPECT_EQ(std::count(runs.begin(), runs.end(), 1), 1000);
  }
}

// A thread that waits for the loop inside a task begins no other task of the outer loop.
TEST(ForEachTask, ATaskWithALoopOfItsOwnIsNotPutOff) {
  with_threads(4, [] {
    thread_local int depth = 0;
    std::atomic<int> deepest{0};
    for_each_task(32, [&](std::size_t) {
      ++depth;
      int seen = deepest;
      while (depth > seen && !deepest.compare_exchange_weak(seen, depth)) {
      }
      for_each_task(8, [](std::size_t i) {
        std::this_thread::sleep_for(std::chrono::microseconds(i % 2 == 0 ? 300 : 10));
      });
      --depth;
    });
    EXPECT_EQ(deepest, 1);
  });
}

TEST(ForEachTask, ThrowsTheFirstFailureOfTheListWhateverTheThreads) {
  for (const int threads : {1, 2, 3}) {
    std::atomic<int> before{0};
    const auto task = [&before](std::size_t i) {
      // The earliest failure is the slowest, so that later ones are there first.
      if (i == 40) std::this_thread::sleep_for(std::chrono::milliseconds(30));
      if (i >= 40 && i % 3 == 1) throw std::runtime_error("task " + std::to_string(i));
      if (i < 40) ++before;
    };
    with_threads(threads, [&] {
      try {
        for_each_task(300, task);
        ADD_FAILURE() << "no exception with " << threads << " threads";
      } catch (const std::runtime_error& error) {
        EXPECT_STREQ(error.what(), "task 40");
      }
    });
    EXPECT_EQ(before, 40);
  }
}

TEST(ForEachTask, BeginsNoTaskOnceItShallStop) {
  for (const int threads : {1, 2, 3}) {
    std::atomic<bool> wish{false};
    std::atomic<int> begun{0}, begun_after{0};
    const auto task = [&](std::size_t) {
      if (wish) ++begun_after;
      if (++begun >= 10) wish = true;
    };
    with_threads(threads,
                 [&] { EXPECT_THROW(for_each_task(100000, task, StopToken(wish)), Interrupted); });
    // Every thread may have polled just before the wish.
    EXPECT_LE(begun_after, threads);
  }
}

// What is called from everywhere stops by the wish of its thread, on the threads of a loop, too.
TEST(StopScope, IsHeardInEveryThreadOfTheLoop) {
  std::atomic<bool> wish{false}, other{false};
  const StopToken token(wish), inner(other);
  EXPECT_NO_THROW(throw_if_stopped());
  {
    const StopScope listening(token);
    EXPECT_NO_THROW(throw_if_stopped());
    std::atomic<int> stopped{0};
    const auto task = [&](std::size_t) {
      const StopScope nested(inner);
      wish = true;
      try {
        throw_if_stopped();
      } catch (const Interrupted&) {
        ++stopped;
        throw;
      }
    };
    for (const int threads : {1, 3}) {
      wish = false;
      stopped = 0;
      with_threads(threads, [&] { EXPECT_THROW(for_each_task(100, task), Interrupted); });
      EXPECT_GE(stopped, 1);
      EXPECT_LE(stopped, threads);
    }
    std::thread([] { EXPECT_NO_THROW(throw_if_stopped()); }).join();
  }
  EXPECT_TRUE(wish);
  EXPECT_NO_THROW(throw_if_stopped());
}

}  // namespace
}  // namespace modcal::task_loop_test
