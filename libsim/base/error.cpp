#include "libsim/base/error.hpp"

#include <string_view>

namespace modcal {

void throw_formatted(fmt::string_view text, fmt::format_args args) {
  const std::string_view format(text.data(), text.size());
  for (const std::string_view place : {"{}", "{}:{}"}) {
    if (!format.starts_with(place) || !format.substr(place.size()).starts_with(": ")) continue;
    throw InvalidInput(fmt::vformat(text, args),
                       fmt::vformat(fmt::string_view(place.data(), place.size()), args));
  }
  throw InvalidInput(fmt::vformat(text, args));
}

}  // namespace modcal
