#include "experiments/cli/command.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string_view>
#include <system_error>

#include "experiments/memory.hpp"
#include "experiments/report/encoding.hpp"
#include "libsim/base/files.hpp"
#include "libsim/base/utf8.hpp"
#include "libsim/base/words.hpp"
#include "libsim/records/formats.hpp"

namespace modcal {
namespace {

std::atomic<bool> flag{false}, is_polled{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler sets it");

void on_signal(int number) {
  if (!is_polled.load(std::memory_order_relaxed)) {
    constexpr std::string_view kSaid = "\ninterrupted\n";
    static_cast<void>(write(STDERR_FILENO, kSaid.data(), kSaid.size()) < 0);
    remove_parts();
    _exit(static_cast<int>(ExitCode::kInterrupted));
  }
  flag.store(true, std::memory_order_relaxed);
  std::signal(number, SIG_DFL);
}

ExitCode refused(ExitCode code, std::string reason) {
  complain({.text = std::move(reason)});
  return code;
}

// What was asked of the command, for the message that memory does not suffice.
std::string& request() {
  static std::string text = "this command";
  return text;
}

std::string too_large() {
  return fmt::format(
      "{}: the memory that there is ({}) does not suffice; shorten the record, lower the sample "
      "rate or take fewer --threads (modcal plan tells what a run needs)",
      request(), bytes_text(machine_memory()));
}

ExitCode outcome_of(const Action& action) {
  try {
    return action();
  } catch (const InvalidInput& error) {
    complain(complaint_of(error));
    return ExitCode::kInvalidInput;
  } catch (const LostOutput& error) {
    return refused(ExitCode::kOutputLost, error.what());
  } catch (const std::bad_alloc&) {
    return refused(ExitCode::kInvalidInput, too_large());
  } catch (const std::length_error&) {
    return refused(ExitCode::kInvalidInput, too_large());
  } catch (const std::system_error& error) {
    // A folder that may not be read, no more threads: what the machine refuses.
    return refused(ExitCode::kInvalidInput, error.what());
  } catch (const Interrupted&) {
    return ExitCode::kInterrupted;
  } catch (const std::exception& error) {
    complain({.grade = Complaint::Grade::kInternalError,
              .text = error.what(),
              .source = "Please report it with the file and the command.\n"});
    return ExitCode::kInternal;
  }
}

}  // namespace

ExitCode guarded(const Action& action) { return finish_answer(outcome_of(action)); }

bool prepare_streams(int argc, char** argv) {
  if (argc > 1) request() = fmt::format("modcal {}", fmt::join(argv + 1, argv + argc, " "));
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(stream, F_GETFD) >= 0 || errno != EBADF) continue;
    // The wrong way round: what is said there fails as it would without.
    static_cast<void>(open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY) < 0);
  }
  std::signal(SIGPIPE, SIG_IGN);
  for (int i = 1; i < argc; ++i) {
    if (first_not_utf8(argv[i]) == std::string_view::npos) continue;
    complain({.text = fmt::format("\"{}\" is not UTF-8 text: give files and folders names in UTF-8",
                                  argv[i])});
    return false;
  }
  return true;
}

std::string stem_of(const std::filesystem::path& file) {
  const std::string stem = file.stem().string();
  // "...yaml" would be the folder above.
  return stem.find_first_not_of('.') == std::string::npos ? file.filename().string() : stem;
}

std::string shell_word(const std::string& text) {
  const std::string_view harmless =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._-/=+:,%";
  if (!text.empty() && text.find_first_not_of(harmless) == std::string::npos) return text;
  return report::quoted(text, '\'', "'\\''");
}

void declare_style(CLI::App& command) {
  command.add_flag("--json", answer_style().json,
                   "the answer, or the error, as one JSON object on standard output");
  command.add_flag("-q,--quiet", answer_style().quiet, "no progress, no remarks");
}

void ExperimentArguments::declare_file(CLI::App& command) {
  command.add_option("file", file, "YAML file")->required()->check(complaint_about_name);
  command.add_option("--set", assignments, "key.path=value, overrides the file")
      ->allow_extra_args(false);
  command
      .add_option("--memory", memory,
                  "most memory that a run may need, such as 8GB; default that of the machine")
      ->transform(CLI::AsSizeValue(true))
      ->transform(require_size);  // which is asked first
}

void ExperimentArguments::declare_out(CLI::App& command, const std::string& seen_by) {
  command
      .add_option("--out", out,
                  fmt::format("folder of the results{}{}; default out/<name of the file>",
                              seen_by.empty() ? "" : ", seen by all ", seen_by))
      ->check(complaint_about_name);
}

std::filesystem::path ExperimentArguments::folder() const {
  return out.empty() ? std::filesystem::path("out") / stem_of(file) : std::filesystem::path(out);
}

std::string ExperimentArguments::assignment_words() const {
  std::string words;
  for (const std::string& assignment : assignments) words += " --set " + shell_word(assignment);
  return words;
}

std::string ExperimentArguments::command() const {
  return fmt::format("modcal run {} --out {}{}{}{}", shell_word(file),
                     shell_word(folder().string()), assignment_words(),
                     threads > 0 ? fmt::format(" --threads {}", threads) : std::string(),
                     memory > 0 ? fmt::format(" --memory {}", memory) : std::string());
}

void declare_threads(CLI::App& command, int& threads, const char* meaning) {
  command.add_option("--threads", threads, meaning)->check(CLI::Range(1, 4096));
}

void require_no_record(const std::filesystem::path& file) {
  std::error_code unreadable;
  if (!std::filesystem::is_regular_file(file, unreadable)) return;
  const std::string extension = lower_case(file.extension().string());
  // A text may be either.
  if (extension == ".txt" && content_of_file(file).find("kind:") != std::string::npos) return;
  for (const RecordFormat& format : record_formats()) {
    MODCAL_REQUIRE(std::ranges::count(format.extensions, extension) == 0,
                   "{}: this looks like a record ({}) and not like an experiment: see what it "
                   "holds with `modcal inspect {}`, and write an experiment on it with `modcal new "
                   "calibrate {}`, or `modcal new invert ...`",
                   file.string(), format.meaning, shell_word(file.string()),
                   shell_word(file.string()));
  }
}

std::optional<LoadedExperiment> load_and_print_mistakes(const std::filesystem::path& file,
                                                        const std::vector<std::string>& assignments,
                                                        const Means& means) {
  require_no_record(file);
  std::optional<LoadedExperiment> loaded = load_experiment(file, assignments, means);
  complain(complaints_of(loaded->document, loaded->mistakes));
  if (!loaded->has_errors()) return loaded;
  add_to_json("mistakes", mistakes_json(*loaded));
  return std::nullopt;
}

nlohmann::ordered_json mistakes_json(const LoadedExperiment& loaded) {
  auto list = nlohmann::ordered_json::array();
  for (const Mistake& mistake : loaded.mistakes) {
    const SourcePosition& at = mistake.position;
    list.push_back({{"severity", mistake.warning ? "warning" : "error"},
                    {"place", at.origin.empty() ? loaded.document.file : at.origin},
                    {"line", at.line},
                    {"column", at.column},
                    {"text", mistake.text}});
  }
  return list;
}

void catch_interrupts() {
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
}

StopToken interrupt_token() {
  if (const Caller* caller = Caller::here()) return StopToken(caller->stop);
  is_polled.store(true, std::memory_order_relaxed);
  return StopToken(flag);
}

bool interrupted() {
  if (const Caller* caller = Caller::here()) return caller->stop.load(std::memory_order_relaxed);
  return flag.load(std::memory_order_relaxed);
}

}  // namespace modcal
