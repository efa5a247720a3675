// One command of modcal: adds itself to the command line and says what to do when it is chosen.
#pragma once

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <stop_token>
#include <thread>

#include "experiments/loader.hpp"
#include "libsim/base/task_loop.hpp"

namespace modcal {

/// What a command tells the shell.
enum class ExitCode : int {
  kOk = 0,
  kInternal = 1,
  kUsage = 2,
  kInvalidInput = 3,
  kSomeTasksFailed = 4,
  kAcceptanceMissed = 5,
  kNothingMeasured = 6,
  kOutputLost = 7,
  kInterrupted = 130,
};

/// In words, for help and errors.
std::string_view meaning_of(ExitCode code);

/// What --json and --quiet ask of all that is said.
struct AnswerStyle {
  bool json = false;   ///< one object on standard output, an error, too
  bool quiet = false;  ///< no progress and no remarks
};
AnswerStyle& answer_style();

using Action = std::function<ExitCode()>;
/// Called with the chosen command's action while the command line is being parsed.
using Chosen = std::function<void(Action)>;

/// --json and --quiet.
void declare_style(CLI::App& command);

/// A command of the line: `declare` says what it reads, `act` what it does with that.
template <typename Arguments>
void add_command(CLI::App& app, const Chosen& chosen, const char* name, const char* meaning,
                 void (*declare)(CLI::App& command, Arguments& arguments),
                 ExitCode (*act)(const Arguments& arguments)) {
  CLI::App* command = app.add_subcommand(name, meaning);
  auto arguments = std::make_shared<Arguments>();
  declare(*command, *arguments);
  declare_style(*command);
  command->callback([=] { chosen([=] { return act(*arguments); }); });
}

void add_experiment_commands(CLI::App& app, const Chosen& chosen);
void add_plan_command(CLI::App& app, const Chosen& chosen);
void add_plugin_commands(CLI::App& app, const Chosen& chosen);
void add_record_commands(CLI::App& app, const Chosen& chosen);
void add_new_command(CLI::App& app, const Chosen& chosen);
void add_reproduce_command(CLI::App& app, const Chosen& chosen);
void add_stored_commands(CLI::App& app, const Chosen& chosen);
void add_compare_command(CLI::App& app, const Chosen& chosen);
void add_submit_command(CLI::App& app, const Chosen& chosen);
/// After all others: they are what it speaks of.
void add_tree_commands(CLI::App& app, const Chosen& chosen);

/// "modcal run FILE [OPTIONS]".
std::string usage_of(const CLI::App& app, const CLI::App& command);

/// Says what the parser of the command line stopped at: help, version, a mistake. An option that
/// the chosen command does not have is what the mistake is about, whatever else is missing.
ExitCode answer_of(const CLI::App& app, const CLI::ParseError& error);

/// What `action` returns; an exception becomes one message on stderr and its exit code. A signal
/// that comes before interrupt_token() is called ends the process at once.
ExitCode guarded(const Action& action);
/// Writes what --json asks for. Where standard output has not taken what was said, that is an
/// error, too.
ExitCode finish_answer(ExitCode code);

/// Whether the first word is no command, after a message. CLI11 would say that one is missing.
bool is_unknown_command(const CLI::App& app, int argc, const char* const* argv);

/// What the words of a command line ask for. `begin` is called where a command is chosen, before it
/// is done.
ExitCode answer_words(int argc, const char* const* argv, void (*begin)());

/// Who asks in the place of a terminal: commands of its thread say nothing elsewhere, for as long
/// as this lives.
class Caller {
 public:
  /// `stop`: in the place of Ctrl-C; `progress`: told of the share done, from any thread.
  Caller(const std::atomic<bool>& stop, std::function<void(double)> progress);
  ~Caller();
  Caller(const Caller&) = delete;
  Caller& operator=(const Caller&) = delete;
  /// Of this thread; null: there is a terminal.
  static Caller* here();

  const std::atomic<bool>& stop;
  std::function<void(double)> progress;
  std::string said;  ///< all that standard output would have got
};

/// The configs that came with the program, wherever both were moved.
std::string shipped_configs();

/// One word of a POSIX shell; single-quoted where anything in it could be special.
std::string shell_word(const std::string& text);

// What the commands that work on an experiment file have in common.

struct ExperimentArguments {
  std::string file;
  std::vector<std::string> assignments;  ///< "key.path=value"
  std::string out;                       ///< empty: out/<name of the file>
  int threads = 0;                       ///< 0: not stated
  std::uint64_t memory = 0;              ///< [B]; 0: not stated

  /// FILE, --set and --memory.
  void declare_file(CLI::App& command);
  /// --out; seen_by: who else must see the folder, empty: nobody.
  void declare_out(CLI::App& command, const std::string& seen_by = {});

  /// What a run may use.
  Means means() const { return {static_cast<double>(memory), static_cast<std::size_t>(threads)}; }
  std::filesystem::path folder() const;
  /// Assignments as words of a shell: " --set ..." for each.
  std::string assignment_words() const;
  /// The command line that makes the same results again, of the whole list.
  std::string command() const;
};

/// What is wrong with a name of a file or folder; empty: nothing. A script's unset variable gives
/// an empty one.
std::string complaint_about_name(const std::string& name);

/// A frequency such as 44.1 kHz as a number of hertz. Throws CLI::ValidationError.
std::string hertz_of(const std::string& text);
/// --sample-rate [Hz] of a file that has none.
CLI::Option& declare_rate(CLI::App& command, double& rate);

/// What a reader of records says, with that option in the place of the key of a file.
std::string with_rate_option(std::string text);

/// The text where it is a size such as 8GB. Throws CLI::ValidationError.
std::string require_size(std::string text);

/// --threads with its range.
void declare_threads(CLI::App& command, int& threads, const char* meaning);

/// Throws InvalidInput where the name of a file is one of recorded files.
void require_no_record(const std::filesystem::path& file);

/// The experiment, after its mistakes were printed; none where an error is among them.
std::optional<LoadedExperiment> load_and_print_mistakes(
    const std::filesystem::path& file, const std::vector<std::string>& assignments = {},
    const Means& means = {});

/// Errors and warnings of an experiment with their places.
nlohmann::ordered_json mistakes_json(const LoadedExperiment& loaded);

/// Lines of a file or an answer; text that is not UTF-8 is mended.
std::string json_text(const nlohmann::ordered_json& object);
void print_json(const nlohmann::ordered_json& object);
/// One more value of what --json answers; without --json nothing.
void add_to_json(const std::string& key, const nlohmann::ordered_json& value);

/// Folder of results that a file is run into by default: its name without its extension.
std::string stem_of(const std::filesystem::path& file);

// What a command says. Control characters of foreign names are written out (printable()). Where
// nobody listens the work goes on.

/// On standard output; with --json a part of its text.
void say_text(std::string_view text);
template <typename... Args>
void say(fmt::format_string<Args...> text, Args&&... args) {
  say_text(fmt::format(text, std::forward<Args>(args)...));
}
/// On standard error, colored(); with --json among what is answered.
void complain(const Complaint& complaint);
void complain(const std::vector<Complaint>& complaints);
template <typename... Args>
void warn(fmt::format_string<Args...> text, Args&&... args) {
  complain({.grade = Complaint::Grade::kWarning,
            .text = fmt::format(text, std::forward<Args>(args)...)});
}

/// On standard error whatever is asked for: help, what an interrupted run leaves.
void hint_text(std::string_view text);

/// On standard error, what is neither an error nor a warning; not with --quiet.
void remark_text(std::string_view text);
template <typename... Args>
void remark(fmt::format_string<Args...> text, Args&&... args) {
  remark_text(fmt::format(text, std::forward<Args>(args)...));
}

/// Before anything else: standard streams that were closed are opened to nothing, so that no file
/// takes their place, and a reader that goes away is an error and no signal. False, after a
/// message, where the words of the command are no UTF-8 text.
bool prepare_streams(int argc, char** argv);

/// Among the warnings that --json answers; without --json nothing.
void note_warning(const std::string& text);

// Colours of messages on a terminal.

/// Whether standard error is a terminal that understands codes: it can clear a line and color a
/// text.
bool can_rewrite();

/// The text with "error:", "warning:" and carets marked, where messages on standard error may be
/// coloured: it is a terminal that is not "dumb", and NO_COLOR is not set (no-color.org: set to
/// anything but the empty text).
std::string colored(const std::string& text);

// Progress on stderr: on a terminal one line that is rewritten, how long the work takes already and
// what of it is done where it says so; elsewhere a line every few seconds of a list of tasks alone.
// Every command has one; of those of a thread the last one that was made is shown.

class Progress {
 public:
  enum class Of { kList, kOne };
  /// As long as it lives no progress of its thread is in the way of what is said.
  class Pause {
   public:
    Pause();

   private:
    std::unique_lock<std::mutex> lock_;
  };
  Progress(std::string_view what, Of work);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Share done in [0, 1]; may be called from any thread.
  void report(double share);

 private:
  using Clock = std::chrono::steady_clock;
  // While nobody reports: until it is told to stop.
  void beat(const std::stop_token& stop);
  void draw(Clock::time_point now);
  void clear();
  void cover(bool is_covered);

  std::mutex mutex_;
  std::condition_variable_any ended_;
  std::string what_;
  Of work_;
  Caller* caller_ = Caller::here();
  bool terminal_;
  bool shown_ = false;
  bool covered_ = false;  // another one is shown
  double share_ = 0.0;
  Clock::time_point start_;
  Clock::time_point last_;
  Progress* outer_;    // null: none
  std::jthread beat_;  // last: it ends before the rest does
};

// Ctrl-C and termination, as a wish that the work polls.

/// From now on SIGINT and SIGTERM end the process at once with kInterrupted.
void catch_interrupts();
/// From now on the first of them requests a stop, the second ends the process.
StopToken interrupt_token();
bool interrupted();

}  // namespace modcal
