// How far a command is, for who waits for it.
#include <fmt/format.h>

#include <cstdio>

#include "experiments/cli/command.hpp"
#include "libsim/base/utf8.hpp"

namespace modcal {
namespace {

// What ends within a second has nothing to tell.
constexpr std::chrono::milliseconds kFirst(1000), kNext(500);
constexpr std::chrono::milliseconds kPauseOnTerminal(100), kPauseElsewhere(5000);

thread_local Progress* innermost = nullptr;

}  // namespace

Progress::Pause::Pause() {
  if (innermost == nullptr) return;
  lock_ = std::unique_lock(innermost->mutex_);
  innermost->clear();
}

Progress::Progress(std::string_view what, Of work)
    : what_(printable(what)),
      work_(work),
      terminal_(can_rewrite()),
      start_(Clock::now()),
      last_(start_),
      outer_(std::exchange(innermost, this)) {
  if (outer_ != nullptr) outer_->cover(true);
  if (!terminal_ || caller_ != nullptr || answer_style().quiet) return;
  beat_ = std::jthread([this](const std::stop_token& stop) { beat(stop); });
}

Progress::~Progress() {
  if (beat_.joinable()) {
    beat_.request_stop();
    beat_.join();
  }
  clear();
  innermost = outer_;
  if (outer_ != nullptr) outer_->cover(false);
}

void Progress::clear() {
  if (std::exchange(shown_, false) && terminal_) std::fputs("\r\033[K", stderr);
}

void Progress::cover(bool is_covered) {
  const std::lock_guard lock(mutex_);
  clear();
  covered_ = is_covered;
}

void Progress::beat(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  auto pause = kFirst;
  while (!ended_.wait_for(lock, stop, pause, [&stop] { return stop.stop_requested(); })) {
    draw(Clock::now());
    pause = kNext;
  }
}

void Progress::draw(Clock::time_point now) {
  if (covered_) return;
  last_ = now;
  const double elapsed = std::chrono::duration<double>(now - start_).count();
  const std::string line = share_ > 0.0
                               ? fmt::format("{}: {:.0f} %, {:.0f} s left", what_, 100.0 * share_,
                                             elapsed * (1.0 - share_) / share_)
                               : fmt::format("{}: {:.0f} s", what_, elapsed);
  std::fputs((terminal_ ? "\r\033[K" + line : line + "\n").c_str(), stderr);
  shown_ = true;
}

void Progress::report(double share) {
  if (caller_ != nullptr) return caller_->progress(share);
  const std::lock_guard lock(mutex_);
  share_ = share;
  const Clock::time_point now = Clock::now();
  const auto pause = terminal_ ? kPauseOnTerminal : kPauseElsewhere;
  const bool told = terminal_ || work_ == Of::kList;
  if (!told || answer_style().quiet || now - last_ < pause || share <= 0.0) return;
  draw(now);
}

}  // namespace modcal
