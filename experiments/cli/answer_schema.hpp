// What --json answers, described for programs.
#pragma once

#include <nlohmann/json_fwd.hpp>

namespace modcal {

/// JSON schema (2020-12) of the answers of all commands, each below "$defs" by its name.
nlohmann::ordered_json answer_schema();

/// What stands below "$defs" beside the commands: parts that several of them have.
const char* answer_parts();

}  // namespace modcal
