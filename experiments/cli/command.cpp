#include "experiments/cli/command.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <regex>
#include <string_view>

#include "experiments/report/encoding.hpp"

namespace modcal {
namespace {

// A terminal that understands codes: it can clear a line and color a text.
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

ExitCode guarded(const Action& action) {
  try {
    return action();
  } catch (const InvalidInput& error) {
    fmt::print(stderr, "{} {}\n", colored("error:"), error.what());
    return ExitCode::kInvalidInput;
  } catch (const Interrupted&) {
    return ExitCode::kInterrupted;
  } catch (const std::exception& error) {
    fmt::print(stderr, "internal error: {}\nPlease report it with the file and the command.\n",
               error.what());
    return ExitCode::kInternal;
  }
}

std::string shell_word(const std::string& text) {
  const std::string_view harmless =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._-/=+:,%";
  if (!text.empty() && text.find_first_not_of(harmless) == std::string::npos) return text;
  return report::quoted(text, '\'', "'\\''");
}

void ExperimentArguments::declare_file(CLI::App& command) {
  command.add_option("file", file, "YAML file")->required();
  command.add_option("--set", assignments, "key.path=value, overrides the file")
      ->allow_extra_args(false);
}

void ExperimentArguments::declare_out(CLI::App& command, const std::string& seen_by) {
  command.add_option("--out", out,
                     fmt::format("folder of the results{}{}; default out/<name of the file>",
                                 seen_by.empty() ? "" : ", seen by all ", seen_by));
}

std::filesystem::path ExperimentArguments::folder() const {
  return out.empty() ? std::filesystem::path("out") / std::filesystem::path(file).stem()
                     : std::filesystem::path(out);
}

std::string ExperimentArguments::assignment_words() const {
  std::string words;
  for (const std::string& assignment : assignments) words += " --set " + shell_word(assignment);
  return words;
}

std::string ExperimentArguments::command() const {
  return fmt::format("modcal run {} --out {}{}{}", shell_word(file), shell_word(folder().string()),
                     assignment_words(),
                     threads > 0 ? fmt::format(" --threads {}", threads) : std::string());
}

void declare_threads(CLI::App& command, int& threads, const char* meaning) {
  command.add_option("--threads", threads, meaning)->check(CLI::Range(1, 4096));
}

std::optional<LoadedExperiment> load_and_print_mistakes(
    const std::filesystem::path& file, const std::vector<std::string>& assignments) {
  std::optional<LoadedExperiment> loaded = load_experiment(file, assignments);
  fmt::print(stderr, "{}", colored(format_mistakes(loaded->document, loaded->mistakes)));
  if (loaded->has_errors()) loaded.reset();
  return loaded;
}

void print_json(const nlohmann::ordered_json& object) {
  fmt::print("{}\n", object.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
}

std::string colored(const std::string& text) {
  const char* refused = std::getenv("NO_COLOR");
  if (!can_rewrite() || (refused != nullptr && *refused != '\0')) return text;
  // A word that begins a line or follows the place of a mistake, "a.yaml:3:7: error: …".
  static const std::regex kError("(^|\n|: )(error:)"), kWarning("(^|\n|: )(warning:)");
  static const std::regex kCaret("(\n *)(\\^)(?=\n)");
  const std::string red = std::regex_replace(text, kError, "$1\033[1;31m$2\033[0m");
  const std::string both = std::regex_replace(red, kWarning, "$1\033[1;33m$2\033[0m");
  return std::regex_replace(both, kCaret, "$1\033[1m$2\033[0m");
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
