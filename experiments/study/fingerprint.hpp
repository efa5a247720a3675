// Options as one line of text that is equal for equal options: the key of what is computed once.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "libsim/base/options.hpp"

namespace modcal {

/// Keys and values in the order of the visit; numbers bit for bit.
std::string fingerprint(const std::function<void(OptionVisitor&)>& visit_options);

/// Size and time of change of a recorded file; "missing" where there is none.
std::string record_fingerprint(const std::filesystem::path& file);

}  // namespace modcal
