// Runs loaded experiments and leaves their results in a folder.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "experiments/cli/exit_code.hpp"
#include "experiments/loader.hpp"

namespace modcal {

struct RunSettings {
  std::filesystem::path out;
  int threads = 0;      ///< 0: all
  bool json = false;    ///< summary on stdout as JSON
  std::string command;  ///< the command line that makes the same results again
  std::string title;    ///< of the report; empty: the experiment's
};

/// One experiment, whose results stand in the folder itself: resolved.yaml, provenance.json, tables
/// as CSV and JSON, figures, report.html.
ExitCode run_one(const LoadedExperiment& loaded, const RunSettings& settings);

/// Several experiments in one report; each one's resolved.yaml and files stand in a folder of its
/// name. Truths are shared.
ExitCode run_together(const std::vector<LoadedExperiment>& experiments,
                      const RunSettings& settings);

}  // namespace modcal
