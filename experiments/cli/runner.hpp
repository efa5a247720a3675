// Runs loaded experiments and leaves their results in a folder.
#pragma once

#include <array>
#include <nlohmann/json.hpp>

#include "experiments/cli/command.hpp"
#include "experiments/loader.hpp"
#include "experiments/runs/run_store.hpp"
#include "experiments/runs/task_experiment.hpp"

namespace modcal {

struct RunSettings {
  std::filesystem::path out;
  int threads = 0;  ///< 0: all
  /// The command line that makes the same results again, of the whole list.
  std::string command;
  std::string title;  ///< of the report; empty: the experiment's
  Shard shard;        ///< part of the task list to run
  /// Where relative paths of the experiment start; empty: the folder of its file.
  std::filesystem::path folder;
  /// Where relative paths of the command start; empty: here.
  std::filesystem::path directory;
};

/// One experiment, whose results stand in the folder itself: resolved.yaml, provenance.json, tables
/// as CSV and JSON, figures, report.html. A list of tasks goes on where an earlier run with the
/// same program ended; of a shard the tasks alone are run. Throws InvalidInput where another run
/// works in the folder.
ExitCode run_one(const LoadedExperiment& loaded, const RunSettings& settings);

/// Writes files, summary and report of a result and gives the exit code that stands for it. Where
/// a file that no run wrote has a name of theirs they stand in a folder below, and the code says
/// so.
ExitCode present(const LoadedExperiment& loaded, StudyResult result, const RunSettings& settings,
                 double seconds);

/// What a few tasks of a list cost.
struct PilotRun {
  std::vector<std::size_t> pending = {};  ///< tasks still to do, ascending
  std::size_t run = 0;                    ///< tasks that the mean is taken over
  double seconds_per_task = 0.0;          ///< mean
};

/// Runs evenly spaced tasks of a list for ten seconds, at least one and at most twenty; their
/// results are kept. Throws InvalidInput where the experiment is no list or nothing is left to do.
PilotRun run_pilot(const LoadedExperiment& loaded, const RunSettings& settings);

/// Several experiments in one report; each one's resolved.yaml and files stand in a folder of its
/// name. Truths are shared.
ExitCode run_together(const std::vector<LoadedExperiment>& experiments,
                      const RunSettings& settings);

// What every folder of results holds.
inline constexpr const char* kProvenanceFile = "provenance.json";
inline constexpr const char* kResolvedFile = "resolved.yaml";
inline constexpr const char* kAnswerFile = "answer.json";
inline constexpr const char* kDatabaseFile = "results.sqlite";
inline constexpr const char* kSlurmFolder = "slurm";
/// Below it, the scripts that `submit` writes.
inline constexpr std::array kSlurmScripts = {"slurm/run.sh", "slurm/merge.sh"};

/// Every default written out; reads back to the same experiment from the folder that is named.
std::string resolved_text(const LoadedExperiment& loaded, const std::filesystem::path& folder);
/// Whether a run has written it.
bool is_resolved_text(std::string_view text);

// Where results come from: version, commit, compiler, libraries, machine, command, time.

std::string version_text();
/// Equal for programs that give equal results: version, commit, compiler and kind of build, and for
/// a program built from changed sources its content.
std::string program_identity();
nlohmann::ordered_json provenance_json(const std::string& command);
/// The seeds of an experiment by their paths, a swept one as its list.
nlohmann::ordered_json seeds_json(const LoadedExperiment& loaded);
std::vector<report::ProvenanceLine> provenance_lines(const std::string& command);

// A folder of results as a run left it, running or dead.

/// The experiment of a folder and what is finished of it. Nothing in the folder is touched.
class StoredRun {
 public:
  /// Reads resolved.yaml, provenance.json and the journals. Throws InvalidInput where the folder
  /// holds no run of a list of tasks.
  explicit StoredRun(std::filesystem::path out);

  const LoadedExperiment& loaded() const { return loaded_; }
  const TaskExperiment& list() const { return *list_; }
  const std::filesystem::path& out() const { return out_; }
  /// Where relative paths of the experiment start.
  const std::filesystem::path& folder() const { return folder_; }
  /// The command that made the run, and makes it go on.
  const std::string& command() const { return command_; }
  /// The command as it works from the working directory.
  std::string command_from_here() const;
  /// For results of the same command in `out`.
  RunSettings settings(std::filesystem::path out) const;
  /// What was finished when the folder was read, by task.
  const TaskOutcomes& outcomes() const { return *outcomes_; }
  std::size_t tasks() const { return outcomes_->size(); }
  /// Results in its journals of other settings, records or programs.
  std::size_t other_results() const { return finished_->size() - outcomes_->records(); }
  /// Throws InvalidInput where no task is finished.
  void require_some_done() const;
  const std::vector<JournalDamage>& damages() const { return finished_->damages(); }

 private:
  /// Of a run that is no list: where its answer stands, or that there is none.
  [[noreturn]] void refuse_single() const;

  std::filesystem::path out_;
  LoadedExperiment loaded_;
  const TaskExperiment* list_ = nullptr;
  std::filesystem::path folder_;
  std::string command_;
  std::filesystem::path directory_;
  std::optional<FinishedTasks> finished_;
  std::optional<TaskOutcomes> outcomes_;
};

/// Files, summary and report of what is finished. Throws InvalidInput where nothing is.
ExitCode report_stored_run(const std::string& out);

}  // namespace modcal
