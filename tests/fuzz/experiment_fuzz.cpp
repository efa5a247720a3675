// An experiment's file with what `--set` puts into it: a line that begins with "--set " is an
// argument, the others are the file.
#include <sstream>

#include "experiments/loader.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace modcal::fuzz {
namespace {

constexpr Means kMeans{.memory = 1e9, .threads = 2};

// A short sweep may have a million cells, whose options take their time to read.
bool is_large(const YamlDocument& document) {
  const YamlNode* sweep = document.root.find("sweep");
  const YamlNode* product = sweep == nullptr ? nullptr : sweep->find("product");
  double cells = 1.0;
  if (product == nullptr) return false;
  for (const YamlNode::Member& axis : product->members) {
    cells *= static_cast<double>(std::max<std::size_t>(1, axis.value.items.size()));
  }
  return cells > 64.0;
}

YamlDocument document_of(const std::string& text) {
  std::istringstream lines(text);
  std::string file;
  std::vector<std::string> assignments;
  for (std::string line; std::getline(lines, line);) {
    constexpr std::string_view kSet = "--set ";
    if (line.starts_with(kSet)) {
      assignments.push_back(line.substr(kSet.size()));
    } else {
      file += line + (lines.eof() ? "" : "\n");
    }
  }
  YamlDocument document = parse_yaml(file, "fuzz.yaml");
  for (std::size_t i = 0; i < assignments.size(); ++i) {
    apply_assignment(document, assignments[i], i + 1);
  }
  return document;
}

}  // namespace
}  // namespace modcal::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace modcal;
  YamlDocument document = fuzz::document_of(std::string(fuzz::text_of(data, size)));
  if (fuzz::is_large(document)) return 0;
  const LoadedExperiment loaded = load_experiment(std::move(document), fuzz::kMeans);
  const std::string mistakes = format_mistakes(loaded.document, loaded.mistakes);
  if (loaded.has_errors()) {
    fuzz::require(!mistakes.empty(), "refused without a word");
    return 0;
  }
  fuzz::require(loaded.experiment != nullptr, "neither an experiment nor a mistake");
  // What is written out reads back to the same.
  const std::string resolved = loaded.resolved();
  const LoadedExperiment again =
      load_experiment(parse_yaml(resolved, "resolved.yaml"), fuzz::kMeans);
  if (again.has_errors()) {
    std::fputs(format_mistakes(again.document, again.mistakes).c_str(), stderr);
  }
  fuzz::require(!again.has_errors(), "resolved.yaml has mistakes");
  fuzz::require(again.resolved() == resolved, "resolved.yaml reads back to something else");
  return 0;
}
