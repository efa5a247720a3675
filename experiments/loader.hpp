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

  bool has_errors() const;
  /// Every option with its value, as YAML that reads back to the same values.
  std::string resolved() const;
};

/// Reads the file, applies `assignments` ("key.path=value"), reads all options and lints.
/// Throws InvalidInput only where the file cannot be read.
LoadedExperiment load_experiment(const std::filesystem::path& file,
                                 const std::vector<std::string>& assignments = {});
LoadedExperiment load_experiment(YamlDocument document);

}  // namespace modcal
