// Which vector instructions the kernels take.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace modcal {

/// Names of the instruction sets that this machine and this build have, the least first:
/// "baseline", what every x86-64 has; "avx2"; "avx512".
std::vector<std::string> instruction_sets();

/// Kernels take no more than the set named, where there is more; to be called before the first of
/// them. Empty: all there is. Throws InvalidInput for a set that is unknown or not there.
void limit_instructions(std::string_view name);

/// The same with what the environment variable MODCAL_INSTRUCTIONS says.
void limit_instructions_by_environment();

}  // namespace modcal
