#include "libcalib/likelihood/records/noise_level.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

#include "libcalib/likelihood/records/tuning.hpp"
#include "libsim/base/error.hpp"
#include "libsim/signal/fft.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

using std::numbers::pi;

struct Bins {
  std::size_t first, last;
  std::size_t count() const { return last > first ? last - first : 0; }
};

Bins bins_of(const NoiseBand& band, std::size_t samples) {
  return {static_cast<std::size_t>(band.low * static_cast<double>(samples)),
          static_cast<std::size_t>(band.high * static_cast<double>(samples))};
}

// Of all bins, or their number times what the median tells.
double total_power(std::span<const Complex> spectrum, bool clear) {
  std::vector<double> powers;
  for (const Complex number : spectrum) powers.push_back(std::norm(number));
  if (clear) return std::accumulate(powers.begin(), powers.end(), 0.0);
  const auto count = static_cast<double>(powers.size());
  return count * quantile(std::move(powers), 0.5) / std::numbers::ln2;
}

}  // namespace

NoiseBand NoiseBand::above(double top, double sample_rate, std::size_t samples) {
  MODCAL_REQUIRE(top > 0.0 && sample_rate > 0.0,
                 "no noise band above {:g} Hz at {:g} samples per second", top, sample_rate);
  NoiseBand band;
  if (kClearNoise * top <= band.low * sample_rate) return band;
  band.clear = false;
  band.low = std::max(band.low, kLineMargin * top / sample_rate);
  MODCAL_REQUIRE(
      bins_of(band, samples).count() >= kFewestNoiseBins,
      "the noise cannot be read from {} samples at {:g} Hz with modes up to {:g} Hz: it "
      "takes {} bins between {:g} Hz and {:g} Hz. State "
      "noise_rms_1 and noise_rms_2 (of a calibration in calibration.objective, beside type: "
      "joint_likelihood; of an inversion in inversion.estimator), use fewer modes, or sample "
      "faster",
      samples, sample_rate, top, kFewestNoiseBins, band.low * sample_rate, band.high * sample_rate);
  return band;
}

NoiseBand NoiseBand::above(const ModalBasis& basis, double sample_rate, std::size_t samples) {
  MODCAL_REQUIRE(basis.size() > 0, "a model of {} modes", basis.size());
  const double top = *std::max_element(basis.omega.begin(), basis.omega.end()) / (2.0 * pi);
  return above(top, sample_rate, samples);
}

double noise_deviation(std::span<const double> samples, const NoiseBand& band) {
  MODCAL_REQUIRE(samples.size() >= 64, "{} samples are too few to estimate the noise from",
                 samples.size());
  const std::size_t count = samples.size();
  const std::vector<Complex> spectrum = hann_spectrum(samples);
  const Bins bins = bins_of(band, count);
  MODCAL_REQUIRE(bins.count() > 0 && bins.last <= spectrum.size(),
                 "a noise band from {:g} to {:g} of the sample rate has no bin", band.low,
                 band.high);
  const auto inside = std::span(spectrum).subspan(bins.first, bins.count());
  const double power = total_power(inside, band.clear);
  const double deviation = std::sqrt(power / static_cast<double>(bins.count()));
  return std::max(deviation, 2e-4 * standard_deviation(samples));
}

void require_noise_known(const std::array<double, 2>& stated, const ModalBasis& basis,
                         double sample_rate, std::size_t samples) {
  const bool known = !std::isnan(stated[0]) && !std::isnan(stated[1]);
  if (!known) NoiseBand::above(basis, sample_rate, samples);
}

double noise_power_error(const std::array<double, 2>& stated, const ModalBasis& basis,
                         const CalibrationData& data) {
  if (!std::isnan(stated[0]) && !std::isnan(stated[1])) return 0.0;
  const NoiseBand band = NoiseBand::above(basis, data.sample_rate, data.samples);
  const double full = 1e-2 * std::sqrt(51200.0 / static_cast<double>(data.samples));
  if (band.clear) return full;
  const NoiseBand widest;
  return full * kMedianOverMean * std::sqrt((widest.high - widest.low) / (band.high - band.low));
}

}  // namespace modcal
