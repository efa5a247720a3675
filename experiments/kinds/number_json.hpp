// Numbers of stored outcomes: every bit comes back, what is not finite included.
#pragma once

#include <nlohmann/json.hpp>

namespace modcal {

/// JSON has no word for what is not finite: those become "nan", "inf", "-inf".
nlohmann::json number_json(double value);
/// Throws nlohmann::json::exception for anything number_json does not write.
double read_number(const nlohmann::json& value);

}  // namespace modcal
