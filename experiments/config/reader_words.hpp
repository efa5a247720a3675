// What mistakes in a configuration call things.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "experiments/config/document.hpp"

namespace modcal {

/// "a map", "a list", "a single value" or "nothing".
std::string_view kind_name(const YamlNode& node);

std::vector<std::string> strings_of(const std::vector<std::string_view>& views);

}  // namespace modcal
