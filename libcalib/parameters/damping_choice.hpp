// What a calibration frees of the damping ratios, as a choice of words.
#pragma once

#include "libsim/base/words.hpp"

namespace modcal {

enum class DampingChoice { kAuto, kFixed, kFactor, kPower, kEach };
inline constexpr std::array<std::string_view, 5> kDampingChoices = {"auto", "fixed", "factor",
                                                                    "power", "each"};

/// Throws InvalidInput for another word.
inline DampingChoice damping_choice(std::string_view word) {
  return enum_of<DampingChoice>(kDampingChoices, "choice of the damping", word);
}

/// Whether any ratio is free; nothing stated ("auto") frees none by itself.
inline bool frees_damping(std::string_view word) {
  return damping_choice(word) > DampingChoice::kFixed;
}

}  // namespace modcal
