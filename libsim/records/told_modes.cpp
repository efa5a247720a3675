#include "libsim/records/told_modes.hpp"

#include <algorithm>
#include <cmath>

#include "libsim/records/levels.hpp"
#include "libsim/records/tuning.hpp"
#include "libsim/signal/fft.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

// Power of a reaction in bins, under a Hann window, noise of variance 1 in it having power 1 a bin.
class PowerInNoise {
 public:
  explicit PowerInNoise(const Signal& signal) : spacing_(signal.sample_rate) {
    const double noise = white_noise_rms(signal.samples);
    if (!(noise > 0.0)) return;
    spacing_ /= static_cast<double>(signal.samples.size());
    for (const Complex bin : hann_spectrum(signal.samples)) {
      power_.push_back(std::norm(bin) / (noise * noise));
    }
  }

  bool known() const { return !power_.empty(); }
  /// Mean between two frequencies [Hz].
  double mean_of(double low, double high) const {
    const auto bin = [this](double frequency) {
      return std::min(static_cast<std::size_t>(frequency / spacing_), power_.size() - 1);
    };
    const std::size_t first = bin(low), last = bin(high) + 1;
    return mean(std::span(power_).subspan(first, last - first));
  }

 private:
  double spacing_;
  std::vector<double> power_;
};

}  // namespace

ToldModes told_modes(const StringModel& string, const RecordedSignals& record) {
  ToldModes told{.highest = kModesBelow * record.sample_rate};
  told.in_band = modes_below(string, told.highest);
  MODCAL_REQUIRE(told.in_band >= 2 && told.in_band <= 5000,
                 "{} modes of a string of {:g} Hz lie below {:g} Hz, 0.4 sampling rates: state "
                 "modes, from 2 to 5000",
                 told.in_band, string.fundamental, told.highest);
  told.count = told.in_band;
  std::vector<PowerInNoise> reactions;
  for (const auto* reaction : {&record.left, &record.right}) {
    if (reaction->has_value()) reactions.emplace_back(**reaction);
  }
  const auto stands_out = [&](std::int64_t n) {
    const double f = stiff_string_frequency(string.fundamental, string.inharmonicity,
                                            static_cast<std::size_t>(n));
    const double half = 0.5 * string.fundamental;
    return std::any_of(reactions.begin(), reactions.end(), [&](const PowerInNoise& reaction) {
      return !reaction.known() || reaction.mean_of(f - half, f + half) > kStandsOut;
    });
  };
  while (told.count > kFewestModes && !stands_out(told.count)) --told.count;
  told.standing_out = told.count;
  told.count = std::min(told.count, kMostModes);
  return told;
}

std::string ToldModes::text() const {
  if (count < standing_out) {
    return fmt::format(
        "{} modes taken (modes: auto): of the {} that stand out of the noise the first; state "
        "modes for more, which take longer",
        count, standing_out);
  }
  if (count == in_band) {
    return fmt::format(
        "{} modes taken (modes: auto): those of the stated law below {:.5g} Hz, "
        "0.4 sampling rates",
        count, highest);
  }
  return fmt::format(
      "{} modes taken (modes: auto): of the {} of the stated law below {:.5g} Hz, "
      "0.4 sampling rates, those up to the last that stands out of the noise",
      count, in_band, highest);
}

}  // namespace modcal
