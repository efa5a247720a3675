#include "libcalib/likelihood/records/line_waves.hpp"

#include <cmath>

#include "libsim/signal/fft.hpp"

namespace modcal {
namespace {

// Σ_j q^j and Σ_j (2j/n − 1) q^j over n samples, q = e^{±iω_h/f_s} z^−1 at σ, of which q^n is the
// same in every bin: geometric series. A line that stands in a bin is all there.
struct LineSums {
  Complex steady, changing;
};
LineSums line_sums(Complex ratio, Complex power, double samples) {
  const Complex off = 1.0 - ratio;
  // Beyond, the difference of two sums of about n takes as many digits as the limit's error leaves.
  if (std::abs(off) * samples < 1e-5) return {samples, -1.0};
  const Complex sum = (1.0 - power) / off;
  const Complex by_place = (ratio * sum - samples * power) / off;
  return {sum, 2.0 / samples * by_place - sum};
}

}  // namespace

LineWaves line_waves(double omega, const WaveBins& bins) {
  const double norm = 1.0 / std::sqrt(bins.samples);
  const Complex turn = std::polar(1.0, omega / bins.sample_rate);
  const Complex end = std::exp(Complex(-bins.sigma, omega) * bins.samples / bins.sample_rate);
  LineWaves waves;
  waves.fill(PlanarVector(bins.delay.size()));
  for (std::size_t k = 0; k < bins.count; ++k) {
    const Complex delay = bins.delay.at(k);
    const LineSums forward = line_sums(turn * delay, end, bins.samples);
    const LineSums backward = line_sums(std::conj(turn) * delay, std::conj(end), bins.samples);
    waves[0].set(k, 0.5 * norm * (forward.steady + backward.steady));
    waves[1].set(k, Complex(0.0, -0.5) * norm * (forward.steady - backward.steady));
    waves[2].set(k, 0.5 * norm * (forward.changing + backward.changing));
    waves[3].set(k, Complex(0.0, -0.5) * norm * (forward.changing - backward.changing));
  }
  return waves;
}

}  // namespace modcal
