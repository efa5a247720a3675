// "Did you mean …?"
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace modcal {

/// The name with the smallest edit distance (Damerau, 1964: a swap of neighbors counts once;
/// letters' case ignored) from `text`; empty where even that one differs in more than a third of
/// the letters (but 1 is always allowed).
std::string nearest_name(std::string_view text, const std::vector<std::string>& names);

}  // namespace modcal
