// Values on one line, as YAML writes them.
#pragma once

#include <string>

#include "experiments/config/document.hpp"

namespace modcal {

/// YAML's double-quoted form, which is JSON's.
std::string yaml_string(const std::string& text);

/// Numbers, units and words as they were written; what would not read back so, in quotes.
std::string flow_scalar(const std::string& text);

/// A node on one line: 30 mm, [1, 2], {type: grid, points: 5}. A scalar stands as it was written.
std::string flow_text(const YamlNode& node);

}  // namespace modcal
