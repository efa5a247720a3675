// Runs an experiment as a test has written it.
#pragma once

#include <utility>

#include "experiments/loader.hpp"
#include "experiments/study/study.hpp"
#include "libsim/base/error.hpp"

namespace modcal {

/// Throws InvalidInput with all mistakes of the document.
inline StudyResult run_document(YamlDocument document) {
  const LoadedExperiment loaded = load_experiment(std::move(document));
  if (!loaded.experiment) throw InvalidInput(format_mistakes(loaded.document, loaded.mistakes));
  SharedWork work;
  return loaded.experiment->run(
      {.work = work, .folder = loaded.document.folder(), .command = "test"});
}

}  // namespace modcal
