// What a kind of experiment gets and gives, apart from files, terminals and signals of the system.
#pragma once

#include <iterator>

#include "experiments/report/report.hpp"
#include "experiments/study/identification.hpp"

namespace modcal {

/// Truths and prepared inversions, shared by all experiments of one process.
struct SharedWork {
  SharedWork() = default;
  explicit SharedWork(const StopToken& stop) : truths(stop) {}

  TruthCache truths;
  InversionCache inversions;
};

struct StudyContext {
  SharedWork& work;
  std::filesystem::path folder;  ///< where relative paths of the experiment start
  std::string command;           ///< what makes the results again
  std::function<void(double)> progress = [](double) {};  ///< share done, from any thread
  StopToken stop;                                        ///< set by Ctrl-C
  bool numbers_alone = false;  ///< nobody reads figures and signals of the result

  void throw_if_interrupted() const { stop.throw_if_requested(); }
};

/// Signals to be written as a record file, "csv" or "wav".
struct SignalFile {
  std::string name;
  std::vector<Signal> signals;
  double full_scale = 1.0;  ///< of a sound file: what 1.0 stands for, in the signals' units
  std::vector<std::string> notes = {};  ///< what a reader of the signals has to know
};

/// Tasks of a list that failed, or were warned of, for the same reason, up to its numbers.
struct TasksOfReason {
  std::string reason;  ///< of the first
  std::size_t count = 0;
  std::vector<std::size_t> first;  ///< a few of them
};

/// A number that was found, for programs; NaN: not known.
struct FoundParameter {
  std::string name;
  double value = 0.0;
  double deviation = 0.0;
  std::string unit;
  double initial = 0.0;
};

/// How close an identified force comes to the true one, for programs.
struct FoundScore {
  std::string side;
  WindowScore score;
};

struct StudyResult {
  std::string answer;                 ///< in a sentence, for the head of the report
  std::vector<std::string> warnings;  ///< in the summary, too
  std::vector<FoundParameter> parameters;
  std::vector<FoundScore> scores;
  std::vector<report::Block> blocks;  ///< of the report
  std::size_t first_screen = 0;       ///< blocks that answer the question; 0: see take_parts()
  std::vector<std::pair<std::string, std::string>> files;  ///< name and content
  std::vector<SignalFile> signal_files;
  std::string summary;  ///< for standard output
  report::Status status = report::Status::kOk;
  std::size_t failed_tasks = 0;
  std::vector<TasksOfReason> failures;
  std::size_t pending_tasks = 0;  ///< not run yet: the figures stand on the others
  /// Accepted figures that were missed, one sentence each.
  std::vector<std::string> missed;

  /// Figures and tables that state no command of their own were made by this one.
  void state_command(const std::string& command) {
    const auto state = [&command](auto& item) {
      if constexpr (requires { item.command; }) {
        if (item.command.empty()) item.command = command;
      }
    };
    for (report::Block& block : blocks) std::visit(state, block);
  }
  /// The answer is the first line of the summary.
  void answer_by_summary() { answer = summary.substr(0, summary.find('\n')); }
  /// Before all others, on the first screen.
  void add_first(report::Block block) {
    blocks.insert(blocks.begin(), std::move(block));
    if (first_screen > 0) ++first_screen;
  }
  /// What is added from here on are details.
  void end_first_screen() { first_screen = blocks.size(); }
  /// Takes the blocks apart: what answers the question, and details. Where nothing says so, the
  /// answer is what is warned of, what is said before all else, the first figure and the first
  /// table, if it is small.
  std::pair<std::vector<report::Block>, std::vector<report::Block>> take_parts();
  /// Takes them to a report: a section of its own for the answer, the details folded below it.
  void move_to(report::Report& report, std::string title, std::string details);
  void add(std::vector<report::Table> tables) {
    std::move(tables.begin(), tables.end(), std::back_inserter(blocks));
  }
  /// A line of the summary and a box of the report.
  void warn(const std::string& text) {
    warnings.push_back(text);
    summary += "warning: " + text + "\n";
    blocks.emplace_back(report::Text{text, report::Text::Kind::kWarning});
  }
};

}  // namespace modcal
