// Files of configs/structures as they are, or changed, and what they write.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/experiments/kinds/run_document.hpp"

namespace modcal::structure_config {

inline const std::string kFolder = std::string(MODCAL_CONFIGS) + "/structures/";

inline StudyResult run(const std::string& file, const std::vector<std::string>& changes = {}) {
  YamlDocument document = read_yaml_file(kFolder + file);
  std::size_t number = 0;
  for (const std::string& change : changes) apply_assignment(document, change, ++number);
  return run_document(std::move(document));
}

inline nlohmann::json file_of(const StudyResult& result, const std::string& name) {
  for (const auto& [file, text] : result.files) {
    if (file == name) return nlohmann::json::parse(text);
  }
  throw std::runtime_error("no " + name);
}

}  // namespace modcal::structure_config
