#include "libsim/base/instruction_set.hpp"

#include <fmt/ranges.h>
#include <hwy/targets.h>

#include <cstdlib>

#include "libsim/base/error.hpp"

namespace modcal {
namespace {

struct InstructionSet {
  std::string_view name;
  std::int64_t targets;  ///< of Highway that it stands for
};
constexpr InstructionSet kSets[] = {
    {"baseline", HWY_STATIC_TARGET}, {"avx2", HWY_AVX2}, {"avx512", HWY_AVX3 | HWY_AVX3_DL}};

// Lower bits are better targets: all below the lowest of the set.
std::int64_t better_than(std::int64_t targets) { return (targets & -targets) - 1; }

}  // namespace

std::vector<std::string> instruction_sets() {
  std::vector<std::string> names;
  for (const InstructionSet& set : kSets) {
    const bool is_there = (hwy::SupportedTargets() & set.targets) != 0;
    if (is_there || set.targets == HWY_STATIC_TARGET) names.emplace_back(set.name);
  }
  return names;
}

void limit_instructions(std::string_view name) {
  if (name.empty()) return;
  const std::vector<std::string> there = instruction_sets();
  for (const InstructionSet& set : kSets) {
    if (set.name != name) continue;
    MODCAL_REQUIRE(std::find(there.begin(), there.end(), name) != there.end(),
                   "this machine has no {} instructions: {}", name, fmt::join(there, ", "));
    hwy::DisableTargets(better_than(set.targets));
    return;
  }
  throw_invalid_input("MODCAL_INSTRUCTIONS=\"{}\" is none of the instruction sets here: {}", name,
                      fmt::join(there, ", "));
}

void limit_instructions_by_environment() {
  const char* const name = std::getenv("MODCAL_INSTRUCTIONS");
  limit_instructions(name == nullptr ? "" : name);
}

}  // namespace modcal
