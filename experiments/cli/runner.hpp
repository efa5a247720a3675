// Runs loaded experiments and leaves their results in a folder.
#pragma once

#include "experiments/cli/command.hpp"
#include "experiments/runs/run_store.hpp"

namespace modcal {

struct RunSettings {
  std::filesystem::path out;
  int threads = 0;    ///< 0: all
  bool json = false;  ///< summary on stdout as JSON
  /// The command line that makes the same results again, of the whole list.
  std::string command;
  std::string title;  ///< of the report; empty: the experiment's
  Shard shard;        ///< part of the task list to run
  /// Where relative paths of the experiment start; empty: the folder of its file.
  std::filesystem::path folder;
};

/// One experiment, whose results stand in the folder itself: resolved.yaml, provenance.json, tables
/// as CSV and JSON, figures, report.html. A list of tasks goes on where an earlier run with the
/// same program ended; of a shard the tasks alone are run. Throws InvalidInput where another run
/// works in the folder.
ExitCode run_one(const LoadedExperiment& loaded, const RunSettings& settings);

/// Writes files, summary and report of a result and gives the exit code that stands for it.
ExitCode present(const LoadedExperiment& loaded, StudyResult result, const RunSettings& settings,
                 double seconds);

/// What a few tasks of a list cost.
struct PilotRun {
  std::size_t pending = 0;        ///< tasks still to do
  std::size_t run = 0;            ///< tasks that the mean is taken over
  double seconds_per_task = 0.0;  ///< mean
};

/// Runs evenly spaced tasks of a list for ten seconds, at least one and at most twenty; their
/// results are kept. Throws InvalidInput where the experiment is no list or nothing is left to do.
PilotRun run_pilot(const LoadedExperiment& loaded, const RunSettings& settings);

/// Several experiments in one report; each one's resolved.yaml and files stand in a folder of its
/// name. Truths are shared.
ExitCode run_together(const std::vector<LoadedExperiment>& experiments,
                      const RunSettings& settings);

}  // namespace modcal
