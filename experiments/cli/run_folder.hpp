// The folder a run leaves its results in.
#pragma once

#include "experiments/cli/command.hpp"
#include "experiments/report/encoding.hpp"
#include "experiments/runs/task_experiment.hpp"

namespace modcal {

class OutputDirectory {
 public:
  /// Makes the folder and checks that files can be written there, before anything is computed.
  /// Throws InvalidInput where they cannot.
  explicit OutputDirectory(std::filesystem::path path);

  const std::filesystem::path& path() const { return path_; }
  /// Writes the whole file under a temporary name and renames it: an existing file is replaced by a
  /// complete one or not at all. Throws InvalidInput where that fails (no space, no permission).
  void write_text(std::string_view name, std::string_view content) const {
    report::write_file_atomically(path_ / name, content);
  }

 private:
  std::filesystem::path path_;
};

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
  /// What was finished when the folder was read, by task.
  const TaskOutcomes& outcomes() const { return *outcomes_; }
  std::size_t tasks() const { return outcomes_->size(); }
  const std::vector<JournalDamage>& damages() const { return finished_->damages(); }

 private:
  std::filesystem::path out_;
  LoadedExperiment loaded_;
  const TaskExperiment* list_ = nullptr;
  std::filesystem::path folder_;
  std::string command_;
  std::optional<FinishedTasks> finished_;
  std::optional<TaskOutcomes> outcomes_;
};

/// Files, summary and report of what is finished. Throws InvalidInput where nothing is.
ExitCode report_stored_run(const std::string& out);

}  // namespace modcal
