#include "libinverse/spectral/regularizers/tikhonov.hpp"

#include "libinverse/spectral/regularizers/filter_terms.hpp"
#include "libsim/base/error.hpp"

namespace modcal {

void Tikhonov::Options::visit(OptionVisitor& visitor) {
  visitor.integer({.key = "order",
                   .meaning = "order of the derivative whose norm is held down",
                   .range = Range::closed(0, 2)},
                  order);
}

Tikhonov::Tikhonov(const Options& options) : order_(options.order) {
  MODCAL_REQUIRE(order_ >= 0 && order_ <= 2, "order {} of the derivative: 0, 1 or 2", order_);
}

double Tikhonov::penalty(double omega, double reference) const {
  const double ratio = omega / reference;
  return order_ == 0 ? 1.0 : order_ == 1 ? ratio : ratio * ratio;
}

void Tikhonov::do_filter_factors(std::span<const double> sigma, double parameter,
                                 std::span<double> kept, std::span<double> lost) const {
  tikhonov_factors(sigma, parameter, kept, lost);
}

void tikhonov_factors(std::span<const double> sigma, double parameter, std::span<double> kept,
                      std::span<double> lost) {
  // Ratios rather than σ²/(σ² + λ²), and each factor by its own quotient: nothing cancels, and an
  // overflow of a ratio gives the limit 0.
  for (std::size_t i = 0; i < sigma.size(); ++i) {
    const double ratio = parameter / sigma[i];
    kept[i] = sigma[i] > 0.0 ? 1.0 / (1.0 + ratio * ratio) : 0.0;
  }
  for (std::size_t i = 0; i < lost.size(); ++i) {
    const double ratio = sigma[i] / parameter;
    lost[i] = sigma[i] > 0.0 ? 1.0 / (1.0 + ratio * ratio) : 1.0;
  }
}

void Tikhonov::do_trace_squares(const SpectralSystem& system, std::span<const double> parameters,
                                std::span<CurvePoint> curve) const {
  sum_filtered(*this, compacted_terms_of(system), parameters, curve);
}

}  // namespace modcal
