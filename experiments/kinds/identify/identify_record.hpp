// A recorded decay: which part of it is free, and whether what was found are its modes.
#pragma once

#include <optional>

#include "libcalib/parameters/stiff_string_fit.hpp"
#include "libinverse/modes/pluck_identification.hpp"
#include "libsim/records/recording.hpp"

namespace modcal {

struct IdentifyOptions;
struct IdentifyOutcome;

struct PluckedRecord {
  DecayRecord decay;                    ///< a period behind the pluck, means taken out
  double begin = 0.0;                   ///< of it in the record's part [s]
  double end = 0.0;                     ///< of it in the record's part [s]
  std::vector<std::string> names = {};  ///< of a structure's sensors; empty: a string's reactions
  std::vector<std::string> warnings = {};
};

/// A string's reactions, or a structure's responses, from one period behind the one in which they
/// change most, by the power of their differences: a string that is held before is at rest or bent.
/// Of values that are multiples of a step up to the last period whose rms is four of them. The
/// period is that of f₀, or of a structure's lowest_frequency, a fiftieth of the record where none
/// is stated. Throws InvalidInput as load_record() and load_structure_record() do, and for a part,
/// or decay, shorter than three periods.
PluckedRecord load_decay(const IdentifyOptions& options, const std::filesystem::path& folder,
                         const StopToken& stop = {});

/// Residual of each channel within the band over the rms of the channel; empty for era.
std::vector<double> shares_left(const PluckIdentification& found, const DecayRecord& decay);

/// Why these are no modes of a string of this f₀ [Hz], or of a structure (NaN), that decays freely:
/// fewer than half of the damping ratios lie above zero by three deviations, the modes leave more
/// than half of a reaction or of every response, one is neither one damped sinusoid nor two; of a
/// string, all numbers have a common divisor or the law through the frequencies has another f₀ by
/// 3 %. Empty: nothing tells against it.
std::string rejection_of(const PluckIdentification& found, const PluckedRecord& record,
                         double fundamental, const std::optional<StiffStringFit>& law);

/// Of an outcome without modes.
std::string why_nothing(const IdentifyOutcome& outcome);

/// rejection_of(); warnings: modes without a number, and modes with a second pole; of a structure,
/// modes of one shape at one place, and those without a decay.
std::string doubt_decay(const PluckIdentification& found, const PluckedRecord& record,
                        double fundamental, const std::optional<StiffStringFit>& law,
                        std::vector<std::string>& warnings);

}  // namespace modcal
