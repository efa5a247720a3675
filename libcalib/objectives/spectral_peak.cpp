#include "libcalib/objectives/spectral_peak.hpp"

#include "libcalib/objectives/spectral_peak_function.hpp"
#include "libsim/base/error.hpp"

namespace modcal {

void SpectralPeak::Options::visit(OptionVisitor& visitor) {
  visitor.number({.key = "half_band",
                  .meaning = "how far the band reaches to either side, relative to f_n",
                  .unit = "1",
                  .range = Range::open(0.0, 1.0)},
                 half_band);
}

SpectralPeak::SpectralPeak(const Options& options) : options_(options) {
  MODCAL_REQUIRE(options.half_band > 0.0 && options.half_band < 1.0,
                 "half band {:g} must lie in (0, 1)", options.half_band);
}

std::unique_ptr<const ObjectiveFunction> SpectralPeak::do_bind(
    const CalibrationData& data, const ParameterSet& parameters) const {
  return std::make_unique<SpectralPeakFunction>(data, parameters, options_.half_band);
}

}  // namespace modcal
