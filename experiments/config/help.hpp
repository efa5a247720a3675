// Options described: as text and JSON for people, as a JSON schema for editors.
#pragma once

#include <nlohmann/json.hpp>

#include "experiments/config/value_visitor.hpp"

namespace modcal {

/// One entry per option: key, type, unit, default, range, choices, meaning, and the options of
/// groups. Nested plug-ins list their names.
nlohmann::ordered_json describe_options(const std::function<void(OptionVisitor&)>& visit);

/// The same as lines of text, indented by level.
std::string help_text(const nlohmann::ordered_json& options);

/// JSON schema (2020-12) of a map with these options; numbers may be texts with a unit.
nlohmann::ordered_json options_schema(const std::function<void(OptionVisitor&)>& visit);

}  // namespace modcal
