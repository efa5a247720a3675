// From a YAML file to an experiment that can run.
#pragma once

#include "experiments/config/document.hpp"
#include "experiments/experiment.hpp"

namespace modcal {

struct LoadedExperiment {
  YamlDocument document;
  std::string kind;
  std::string title;
  std::string description;
  Choice<Experiment> choice;
  std::shared_ptr<const Experiment> experiment;  ///< null where there are errors
  std::vector<Mistake> mistakes;                 ///< errors and warnings, from parsing to lint
  double memory = 0.0;                           ///< that a run needs, about [B]

  bool has_errors() const;
  /// Every option with its value, as YAML that reads back to the same values.
  std::string resolved() const;
};

/// What a run may use.
struct Means {
  double memory = 0.0;      ///< [B]; 0: all that machine_memory() tells
  std::size_t threads = 0;  ///< 0: all
};

/// Reads the file, applies `assignments` ("key.path=value"), reads all options, refuses what needs
/// more memory than there is, and lints. Throws InvalidInput only where the file cannot be read.
LoadedExperiment load_experiment(const std::filesystem::path& file,
                                 const std::vector<std::string>& assignments = {},
                                 const Means& means = {});
LoadedExperiment load_experiment(YamlDocument document, const Means& means = {});

/// Reads the recorded files, too, and adds what they say against the settings to the mistakes.
void check_records(LoadedExperiment& loaded);

}  // namespace modcal
