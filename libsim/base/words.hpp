// Words of options as enumerators.
#pragma once

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <vector>

#include "libsim/base/error.hpp"

namespace modcal {

/// The enumerator whose place in `names` has this name. Throws InvalidInput for another name;
/// `what` the word stands for.
template <class Enum, std::size_t kNames>
Enum enum_of(const std::array<std::string_view, kNames>& names, std::string_view what,
             std::string_view name) {
  const auto place = std::find(names.begin(), names.end(), name);
  MODCAL_REQUIRE(place != names.end(), "unknown {} \"{}\": {} are possible", what, name,
                 fmt::join(names, ", "));
  return static_cast<Enum>(place - names.begin());
}

/// The names as the choices of a text option.
template <std::size_t kNames>
std::vector<std::string_view> choices_of(const std::array<std::string_view, kNames>& names) {
  return {names.begin(), names.end()};
}

/// The text without the blanks around it.
std::string_view trimmed(std::string_view text);

/// The text with its ASCII capitals as small letters.
std::string lower_case(std::string text);

// "Did you mean …?"

/// The name with the smallest edit distance (Damerau, 1964: a swap of neighbors counts once;
/// letters' case ignored) from `text`; where even that one differs in more than a third of the
/// letters (but 1 is always allowed), the first name that holds the text; empty where none does.
std::string nearest_name(std::string_view text, const std::vector<std::string>& names);

}  // namespace modcal
