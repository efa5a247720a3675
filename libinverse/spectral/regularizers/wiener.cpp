#include "libinverse/spectral/regularizers/wiener.hpp"

#include <cmath>
#include <numbers>

#include "libinverse/spectral/regularizers/filter_terms.hpp"
#include "libinverse/spectral/regularizers/tikhonov.hpp"
#include "libsim/base/error.hpp"

namespace modcal {

void WienerFilter::Options::visit(OptionVisitor& visitor) {
  visitor.number({.key = "corner",
                  .meaning = "frequency below which the supposed spectrum of the force is flat",
                  .unit = "Hz",
                  .range = Range::positive()},
                 corner);
}

WienerFilter::WienerFilter(const Options& options)
    : corner_(2.0 * std::numbers::pi * options.corner) {
  MODCAL_REQUIRE(corner_ > 0.0 && std::isfinite(corner_), "corner {:g} Hz must be > 0",
                 options.corner);
}

double WienerFilter::penalty(double omega, double /*reference*/) const {
  return std::hypot(1.0, omega / corner_);
}

void WienerFilter::do_filter_factors(std::span<const double> sigma, double parameter,
                                     std::span<double> kept, std::span<double> lost) const {
  tikhonov_factors(sigma, parameter, kept, lost);
}

void WienerFilter::do_trace_squares(const SpectralSystem& system,
                                    std::span<const double> parameters,
                                    std::span<CurvePoint> curve) const {
  sum_filtered(*this, compacted_terms_of(system), parameters, curve);
}

}  // namespace modcal
