// A small scene for lists of tasks, and how they are read.
#pragma once

#include <gtest/gtest.h>

#include "experiments/loader.hpp"
#include "experiments/runs/task_experiment.hpp"

namespace modcal {

inline constexpr std::string_view kListScene = R"(
scene:
  string: {length: 0.33 m, linear_density: 3.1e-3 kg/m, fundamental: 196 Hz, modes: 10, damping: {type: constant, ratio: 2e-3}}
  bow: {position: 30 mm, velocity: 0 m/s, normal_force: 0 N}
  duration: 0.2 s
  initial: {type: pluck, position: 43 mm, displacement: 1 mm, width: 3 mm}
simulator: {type: modal_exact, time_step: 20 us}
)";

inline LoadedExperiment loaded_from(const std::string& yaml) {
  return load_experiment(parse_yaml(yaml, "test.yaml"));
}

inline const TaskExperiment& list_of(const LoadedExperiment& loaded) {
  EXPECT_NE(loaded.experiment, nullptr) << format_mistakes(loaded.document, loaded.mistakes);
  return dynamic_cast<const TaskExperiment&>(*loaded.experiment);
}

}  // namespace modcal
