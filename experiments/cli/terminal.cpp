#include "experiments/cli/terminal.hpp"

#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <string_view>

namespace modcal {
namespace {

constexpr std::string_view kRed = "\033[1;31m", kYellow = "\033[1;33m", kEnd = "\033[0m";

// Marks a word that begins the line or follows the place of a mistake, "a.yaml:3:7: error: …".
bool mark(std::string& line, std::string_view word, std::string_view color) {
  const std::size_t found = line.find(word);
  if (found == std::string::npos) return false;
  const bool after_place = found >= 2 && line.compare(found - 2, 2, ": ") == 0;
  if (found != 0 && !after_place) return false;
  line.insert(found + word.size(), kEnd);
  line.insert(found, color);
  return true;
}

bool is_caret(std::string_view line) {
  const std::size_t first = line.find_first_not_of(' ');
  return first != std::string_view::npos && line.substr(first) == "^";
}

// A line is rewritten only where the terminal can clear it.
bool can_rewrite() {
  const char* terminal = std::getenv("TERM");
  return isatty(STDERR_FILENO) != 0 && terminal != nullptr && std::string_view(terminal) != "dumb";
}

std::atomic<bool> flag{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler sets it");

void on_signal(int number) {
  flag.store(true, std::memory_order_relaxed);
  std::signal(number, SIG_DFL);
}

}  // namespace

bool messages_have_colors() {
  const char* refused = std::getenv("NO_COLOR");
  const char* terminal = std::getenv("TERM");
  return isatty(STDERR_FILENO) != 0 && (refused == nullptr || *refused == '\0') &&
         terminal != nullptr && std::string_view(terminal) != "dumb";
}

std::string with_color_codes(const std::string& text) {
  std::string result;
  std::string_view color = kRed;  // of the caret below the last message
  for (std::size_t start = 0; start < text.size();) {
    const std::size_t end = std::min(text.find('\n', start), text.size());
    std::string line = text.substr(start, end - start);
    if (mark(line, "error:", kRed)) {
      color = kRed;
    } else if (mark(line, "warning:", kYellow)) {
      color = kYellow;
    } else if (is_caret(line)) {
      line.insert(0, color);
      line += kEnd;
    }
    result += line;
    if (end < text.size()) result += '\n';
    start = end + 1;
  }
  return result;
}

std::string colored(const std::string& text) {
  return messages_have_colors() ? with_color_codes(text) : text;
}

Progress::Progress(std::string what)
    : what_(std::move(what)), terminal_(can_rewrite()), start_(Clock::now()), last_(start_) {}

Progress::~Progress() {
  if (shown_ && terminal_) std::fputs("\r\033[K", stderr);
}

void Progress::report(double share) {
  const std::lock_guard lock(mutex_);
  const Clock::time_point now = Clock::now();
  const auto pause = terminal_ ? std::chrono::milliseconds(100) : std::chrono::milliseconds(5000);
  if (now - last_ < pause || share <= 0.0) return;
  last_ = now;
  const double elapsed = std::chrono::duration<double>(now - start_).count();
  const std::string line = fmt::format("{}: {:.0f} %, {:.0f} s left", what_, 100.0 * share,
                                       elapsed * (1.0 - share) / share);
  if (terminal_) {
    fmt::print(stderr, "\r\033[K{}", line);
  } else {
    fmt::print(stderr, "{}\n", line);
  }
  std::fflush(stderr);
  shown_ = true;
}

void catch_interrupts() {
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
}

StopToken interrupt_token() { return StopToken(flag); }

bool interrupted() { return interrupt_token().requested(); }

}  // namespace modcal
