#include "libinverse/waves/end_residual.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

#include "libinverse/waves/tuning.hpp"
#include "libsim/signal/fft.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

// n of n √(1 + B n²) = f/f₀, to 1e-9 at B = 1e-2 and n = 12.
double mode_number(double ratio, double inharmonicity) {
  const double b = 4.0 * inharmonicity * ratio * ratio;
  return ratio * std::sqrt(2.0 / (1.0 + std::sqrt(1.0 + b)));
}

// Half a cosine from 0 below `from` to 1 above `to`.
double rise(double value, double from, double to) {
  const double share = std::clamp((value - from) / (to - from), 0.0, 1.0);
  return 0.5 - 0.5 * std::cos(std::numbers::pi * share);
}

// Below its first mode a string says little, and hum whatever it likes.
double pass(double ratio) {
  return rise(ratio, 0.5 * kRelationBottom, kRelationBottom) *
         rise(-ratio, -kRelationTop, -0.5 * kRelationTop);
}

/// What the relation leaves over time, between 0.75 and 10 f₀.
struct EndResidual {
  std::vector<double> error, left, right;  ///< a R₁ − b R₂, a R₁, b R₂
  double noise = 0.0;                      ///< variance of a sample of `error`
};

EndResidual residual_of(const EndRecord& record, const StatedString& string) {
  const std::size_t size = record.left.size();
  const RealFft fft(size);
  const double width = record.sample_rate / static_cast<double>(size);
  std::vector<Complex> spectra[3];
  for (std::size_t r = 0; r < 2; ++r) {
    const auto samples = r == 0 ? record.left : record.right;
    std::vector<double> centred(samples.begin(), samples.end());
    remove_mean(centred);
    spectra[r] = fft.forward(centred);
  }
  spectra[2].resize(fft.bins());
  EndResidual residual;
  for (std::size_t k = 0; k < fft.bins(); ++k) {
    const double frequency = static_cast<double>(k) * width;
    const double gain = pass(frequency / string.fundamental);
    const EndFactors factors = gain > 0.0 ? end_factors(frequency, string) : EndFactors{0.0, 0.0};
    const double a = gain * factors.left, b = gain * factors.right;
    spectra[0][k] *= a;
    spectra[1][k] *= b;
    spectra[2][k] = spectra[0][k] - spectra[1][k];
    residual.noise +=
        2.0 / static_cast<double>(size) *
        (a * a * record.noise[0] * record.noise[0] + b * b * record.noise[1] * record.noise[1]);
  }
  residual.left = fft.inverse(std::move(spectra[0]));
  residual.right = fft.inverse(std::move(spectra[1]));
  residual.error = fft.inverse(std::move(spectra[2]));
  return residual;
}

/// Sums over one period.
struct Period {
  double time, error, power;
};

std::vector<Period> periods_of(const EndResidual& residual, double sample_rate,
                               double fundamental) {
  const auto length = static_cast<std::size_t>(sample_rate / fundamental);
  std::vector<Period> periods;
  // The transform wraps: the first and last periods see the other end, through the low-pass, too.
  for (std::size_t first = kEndPeriods * length;
       first + (kEndPeriods + 1) * length < residual.error.size();
       first += std::max<std::size_t>(1, length / 2)) {
    Period period{
        .time = (static_cast<double>(first) + 0.5 * static_cast<double>(length)) / sample_rate,
        .error = 0.0,
        .power = 0.0};
    for (std::size_t j = first; j < first + length; ++j) {
      period.error += residual.error[j] * residual.error[j];
      period.power += residual.left[j] * residual.left[j] + residual.right[j] * residual.right[j];
    }
    periods.push_back(period);
  }
  return periods;
}

double power_of(const std::vector<double>& samples) {
  return std::transform_reduce(samples.begin(), samples.end(), samples.begin(), 0.0);
}

/// What the relation of a string leaves of a record.
struct ResidualLevel {
  double unexplained = 0.0;  ///< share of the power, without noise
  double usual = 0.0;        ///< power of a period [N²], exceeded by few of them
  EndDisturbance worst;
  std::size_t periods = 0;
};

bool is_disturbed(const ResidualLevel& level) {
  return level.worst.ratio > kDisturbance && level.periods >= kLeastPeriods;
}

ResidualLevel level_of(const EndRecord& record, const StatedString& string) {
  const EndResidual residual = residual_of(record, string);
  const std::vector<Period> periods = periods_of(residual, record.sample_rate, string.fundamental);
  ResidualLevel level;
  level.periods = periods.size();
  if (periods.empty()) return level;
  const double noise = residual.noise * std::floor(record.sample_rate / string.fundamental);
  std::vector<double> errors, shares;
  double error = 0.0, power = 0.0;
  for (const Period& period : periods) {
    errors.push_back(period.error);
    shares.push_back(period.power > 0.0 ? period.error / period.power : 0.0);
    error += period.error;
    power += period.power;
  }
  const double noise_sum = noise * static_cast<double>(periods.size());
  const auto share_of = [](double left, double all, double of_noise) {
    return all > 2.0 * of_noise ? std::max(left - of_noise, 0.0) / (all - of_noise) : 0.0;
  };
  // Of a stroke that is over soon the first periods hold most, and nothing wraps into them.
  const double whole_noise = residual.noise * static_cast<double>(residual.error.size());
  const double whole = share_of(power_of(residual.error),
                                power_of(residual.left) + power_of(residual.right), whole_noise);
  level.unexplained = std::min(share_of(error, power, noise_sum), whole);
  level.usual = quantile(errors, kUsual);
  const double usual_share = quantile(shares, kUsual);
  for (const Period& period : periods) {
    const double expected = std::max(level.usual, usual_share * period.power);
    if (expected > 0.0 && period.error > level.worst.ratio * expected) {
      level.worst = {period.time, period.error / expected};
    }
  }
  return level;
}

}  // namespace

EndFactors end_factors(double frequency, const StatedString& string) {
  const double k = std::numbers::pi / string.length *
                   mode_number(frequency / string.fundamental, string.inharmonicity);
  return {std::sin(k * string.contact), std::sin(k * (string.length - string.contact))};
}

void judge_residual(const EndRecord& record, const StatedString& found, double stated_contact,
                    EndRelationFit& fit) {
  const ResidualLevel level = level_of(record, found);
  fit.unexplained = level.unexplained;
  ResidualLevel least = level;
  // Noise leaves x_c to a few millimeters, and the start of a stroke shows what is wrong in it: a
  // gap is what the x_c leaves that leaves least elsewhere.
  for (int step = -kContactSteps; step <= kContactSteps && is_disturbed(level); ++step) {
    StatedString other = found;
    other.contact = stated_contact + step * kContactStep * found.length;
    if (!(other.contact > 0.0 && other.contact < found.length)) continue;
    const ResidualLevel there = level_of(record, other);
    if (there.usual < least.usual) least = there;
  }
  if (is_disturbed(least)) fit.disturbance = least.worst;
}

}  // namespace modcal
