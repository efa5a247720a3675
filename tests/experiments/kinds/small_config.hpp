// The experiments of configs/ at a size that a test can run.
#pragma once

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "experiments/loader.hpp"

namespace modcal {

inline std::vector<std::string> config_files(const std::filesystem::path& folder) {
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.path().extension() == ".yaml") files.push_back(entry.path().string());
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// `full`: the file as it stands.
inline LoadedExperiment load_small(const std::string& file, const LoadedExperiment& full) {
  // Coarser steps; in a sweep one value on each axis, on a map a few cells.
  YamlDocument document = read_yaml_file(file);
  const YamlNode* simulator = full.document.root.find("simulator");
  if (simulator && simulator->find("type")->text != "modal_event") {
    apply_assignment(document, "simulator.time_step=4 us", 1);
  }
  if (full.kind == "schelleng") {
    apply_assignment(document, "positions.count=4", 1);
    apply_assignment(document, "forces.count=4", 2);
  }
  if (full.kind == "calibration_limit") {
    apply_assignment(document, "seeds=1", 1);
    document.root.find("noise_levels")->items.resize(1);
  }
  if (file.find("simulator_in_the_loop") != std::string::npos) {
    apply_assignment(document, "calibration.budget.evaluations=20", 1);
  }
  if (full.kind == "pluck_then_bow") {
    apply_assignment(document, "scene.string.modes=14", 1);
    apply_assignment(document, "refinement.optimizer.loops=1", 2);
  }
  if (document.root.find("model_based")) {
    apply_assignment(document, "scene.duration=0.06 s", 2);
    apply_assignment(document, "score.windows=[0.04 s]", 3);
    if (document.root.find("score")->find("whole")) {
      apply_assignment(document, "score.whole=[0.01 s, 0.057 s]", 6);
    }
    apply_assignment(document, "model_based.rounds=0", 4);
    apply_assignment(document, "scene.string.damping.ratio=1.5e-2", 5);  // dies out in 0.06 s
  }
  if (YamlNode* sweep = document.root.find("sweep")) {
    for (YamlNode::Member& axis : sweep->find("product")->members) axis.value.items.resize(1);
    std::erase_if(sweep->members, [](const auto& member) { return member.key != "product"; });
  }
  return load_experiment(std::move(document));
}

}  // namespace modcal
