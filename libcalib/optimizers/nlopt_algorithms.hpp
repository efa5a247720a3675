// Every algorithm that NLopt lists: how it is run here, or why it is refused.
#pragma once

#include <span>
#include <string_view>

namespace modcal {

enum class NloptUse {
  kInTheBox,   ///< keeps to the bounds by itself
  kUnbounded,  ///< leaves the bounds: runs through UnboundedSearch
  kTwoLevels,  ///< starts a second algorithm from many points
  kRefused,
};

struct NloptAlgorithm {
  std::string_view name;  ///< without the prefix NLOPT_
  NloptUse use;
  std::string_view refusal;  ///< why it is refused and what to take instead; else empty

  bool needs_gradient() const { return name[1] == 'D'; }
};

/// All algorithms of NLopt 2.7, sorted by name.
std::span<const NloptAlgorithm> nlopt_algorithms();
/// The row of an algorithm; null for a name NLopt does not know.
const NloptAlgorithm* find_nlopt_algorithm(std::string_view name);

}  // namespace modcal
