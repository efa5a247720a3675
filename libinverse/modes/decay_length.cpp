#include "libinverse/modes/decay_length.hpp"

#include <algorithm>
#include <cmath>

#include "libinverse/modes/decimated_decay.hpp"
#include "libsim/base/error.hpp"

namespace modcal {

void require_decay_length(std::size_t samples, double sample_rate, const PluckOptions& options) {
  const auto skipped = static_cast<std::size_t>(std::ceil(options.skip * sample_rate));
  const double duration = static_cast<double>(samples) / sample_rate;
  MODCAL_REQUIRE(skipped < samples,
                 "the first {:g} s are left out of a decay of {:.3g} s: record a longer one, or "
                 "skip less",
                 options.skip, duration);
  // What is kept depends on the length alone.
  const DecimatedDecay decay =
      decimate({.sample_rate = sample_rate, .channels = {std::vector<double>(samples - skipped)}},
               options.highest_frequency);
  const std::size_t least = 2 * static_cast<std::size_t>(options.block_rows) + 1;
  const std::size_t kept = decay.record.samples();
  MODCAL_REQUIRE(
      kept >= least,
      "a decay of {:.3g} s leaves {} samples at {:g} Hz, too few for {} block rows: record "
      "{:.3g} s more, or take fewer block rows",
      duration, kept, decay.record.sample_rate, options.block_rows,
      static_cast<double>(least - std::min(kept, least)) / decay.record.sample_rate);
}

}  // namespace modcal
