#include "libcalib/optimizers/nlopt_algorithms.hpp"

#include <algorithm>
#include <array>

namespace modcal {
namespace {

constexpr std::string_view kStogo =
    "nothing stops it before its own count of calls, so that a target, a time and an interrupt "
    "would be ignored; take GD_MLSL_LDS";
constexpr std::string_view kNocedal = "it is listed but not compiled; take LD_LBFGS";
constexpr std::string_view kOriginalDirect =
    "it crashes when it is stopped within its first points; take GN_DIRECT or GN_DIRECT_L";
constexpr std::string_view kAuglag =
    "it serves constraints between variables; within bounds alone it only runs its local "
    "algorithm: choose that";
constexpr std::string_view kMlsl =
    "it leaves the local algorithm open; take GD_MLSL or GN_MLSL with local_algorithm";

constexpr std::array kTable = {
    NloptAlgorithm{"AUGLAG", NloptUse::kRefused, kAuglag},
    NloptAlgorithm{"AUGLAG_EQ", NloptUse::kRefused, kAuglag},
    NloptAlgorithm{"GD_MLSL", NloptUse::kTwoLevels, {}},
    NloptAlgorithm{"GD_MLSL_LDS", NloptUse::kTwoLevels, {}},
    NloptAlgorithm{"GD_STOGO", NloptUse::kRefused, kStogo},
    NloptAlgorithm{"GD_STOGO_RAND", NloptUse::kRefused, kStogo},
    NloptAlgorithm{"GN_AGS", NloptUse::kInTheBox, {}},
    NloptAlgorithm{"GN_CRS2_LM", NloptUse::kInTheBox, {}},
    NloptAlgorithm{"GN_DIRECT", NloptUse::kInTheBox, {}},
    NloptAlgorithm{"GN_DIRECT_L", NloptUse::kInTheBox, {}},
    NloptAlgorithm{"GN_DIRECT_L_NOSCAL", NloptUse::kInTheBox, {}},
    NloptAlgorithm{"GN_DIRECT_L_RAND", NloptUse::kInTheBox, {}},
    NloptAlgorithm{"GN_DIRECT_L_RAND_NOSCAL", NloptUse::kInTheBox, {}},
    NloptAlgorithm{"GN_DIRECT_NOSCAL", NloptUse::kInTheBox, {}},
    NloptAlgorithm{"GN_ESCH", NloptUse::kInTheBox, {}},
    NloptAlgorithm{"GN_ISRES", NloptUse::kInTheBox, {}},
    NloptAlgorithm{"GN_MLSL", NloptUse::kTwoLevels, {}},
    NloptAlgorithm{"GN_MLSL_LDS", NloptUse::kTwoLevels, {}},
    NloptAlgorithm{"GN_ORIG_DIRECT", NloptUse::kRefused, kOriginalDirect},
    NloptAlgorithm{"GN_ORIG_DIRECT_L", NloptUse::kRefused, kOriginalDirect},
    NloptAlgorithm{"G_MLSL", NloptUse::kRefused, kMlsl},
    NloptAlgorithm{"G_MLSL_LDS", NloptUse::kRefused, kMlsl},
    NloptAlgorithm{"LD_AUGLAG", NloptUse::kRefused, kAuglag},
    NloptAlgorithm{"LD_AUGLAG_EQ", NloptUse::kRefused, kAuglag},
    NloptAlgorithm{"LD_CCSAQ", NloptUse::kInTheBox, {}},
    NloptAlgorithm{"LD_LBFGS", NloptUse::kInTheBox, {}},
    NloptAlgorithm{"LD_LBFGS_NOCEDAL", NloptUse::kRefused, kNocedal},
    NloptAlgorithm{"LD_MMA", NloptUse::kInTheBox, {}},
    NloptAlgorithm{"LD_SLSQP", NloptUse::kInTheBox, {}},
    NloptAlgorithm{"LD_TNEWTON", NloptUse::kInTheBox, {}},
    NloptAlgorithm{"LD_TNEWTON_PRECOND", NloptUse::kInTheBox, {}},
    NloptAlgorithm{"LD_TNEWTON_PRECOND_RESTART", NloptUse::kInTheBox, {}},
    NloptAlgorithm{"LD_TNEWTON_RESTART", NloptUse::kInTheBox, {}},
    NloptAlgorithm{"LD_VAR1", NloptUse::kInTheBox, {}},
    NloptAlgorithm{"LD_VAR2", NloptUse::kInTheBox, {}},
    NloptAlgorithm{"LN_AUGLAG", NloptUse::kRefused, kAuglag},
    NloptAlgorithm{"LN_AUGLAG_EQ", NloptUse::kRefused, kAuglag},
    NloptAlgorithm{"LN_BOBYQA", NloptUse::kInTheBox, {}},
    NloptAlgorithm{"LN_COBYLA", NloptUse::kInTheBox, {}},
    NloptAlgorithm{"LN_NELDERMEAD", NloptUse::kInTheBox, {}},
    NloptAlgorithm{"LN_NEWUOA", NloptUse::kUnbounded, {}},
    NloptAlgorithm{"LN_NEWUOA_BOUND", NloptUse::kInTheBox, {}},
    NloptAlgorithm{"LN_PRAXIS", NloptUse::kUnbounded, {}},
    NloptAlgorithm{"LN_SBPLX", NloptUse::kInTheBox, {}},
};

}  // namespace

std::span<const NloptAlgorithm> nlopt_algorithms() { return kTable; }

const NloptAlgorithm* find_nlopt_algorithm(std::string_view name) {
  const auto* found = std::find_if(kTable.begin(), kTable.end(),
                                   [&](const NloptAlgorithm& row) { return row.name == name; });
  return found == kTable.end() ? nullptr : found;
}

}  // namespace modcal
