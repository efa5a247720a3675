// What the reader of the example's options reports.
#pragma once

#include <string>
#include <vector>

#include "experiments/config/reader.hpp"
#include "tests/experiments/config/example_options.hpp"

namespace modcal::testing {

/// What a user sees of a text and of arguments with mistakes.
inline std::string mistakes(const std::string& yaml, const std::vector<std::string>& arguments = {},
                            ExampleOptions* options = nullptr) {
  YamlDocument document = parse_yaml(yaml, "a.yaml");
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    apply_assignment(document, arguments[i], i + 1);
  }
  std::vector<Mistake> found = document.mistakes;
  ExampleOptions unused;
  ExampleOptions& target = options != nullptr ? *options : unused;
  if (document.root.kind == YamlNode::Kind::kMap) {
    read_options(
        document.root, [&](OptionVisitor& visitor) { target.visit(visitor); }, found);
  }
  return format_mistakes(document, found);
}

/// The same for a text that follows two right lines.
inline std::string mistakes_after_string(const std::string& yaml) {
  return mistakes(std::string(kString) + yaml);
}

}  // namespace modcal::testing
