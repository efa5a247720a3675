#include "libsim/dynamics/gestures/gesture_noise.hpp"

#include <cmath>
#include <numbers>

#include "libsim/base/error.hpp"

namespace modcal {
namespace {

constexpr std::size_t kLobes = 8;   // of the window on either side
constexpr std::size_t kPieces = 8;  // straight pieces between two draws

double sinc(double x) {
  const double angle = std::numbers::pi * x;
  return x == 0.0 ? 1.0 : std::sin(angle) / angle;
}

double lanczos(double x) {
  return std::abs(x) < kLobes ? sinc(x) * sinc(x / static_cast<double>(kLobes)) : 0.0;
}

}  // namespace

void GestureNoise::visit(OptionVisitor& visitor) {
  visitor.number({.key = "level",
                  .meaning = "standard deviation over the nominal value",
                  .unit = "1",
                  .range = Range::non_negative()},
                 level);
  visitor.number({.key = "cutoff",
                  .meaning = "frequency above which there is no noise",
                  .unit = "Hz",
                  .range = Range::positive()},
                 cutoff);
  visitor.integer({.key = "seed", .meaning = "seed of the draws", .range = Range::non_negative()},
                  seed);
}

PiecewiseLinear GestureNoise::factor(double duration, std::string_view role) const {
  if (!present || level == 0.0) return PiecewiseLinear(1.0);
  const double pieces = std::ceil(duration * 2.0 * cutoff * static_cast<double>(kPieces));
  MODCAL_REQUIRE(pieces <= 1e7, "noise up to {:g} Hz over {:g} s takes {:g} pieces: at most 1e7",
                 cutoff, duration, pieces);
  const auto count = static_cast<std::size_t>(pieces) + 1;
  std::vector<double> draws((count - 1) / kPieces + 2 * kLobes + 1);
  fill_standard_normal(StreamKey(static_cast<std::uint64_t>(seed)).with(role), draws);
  std::vector<double> times(count), values(count, 1.0);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t whole = i / kPieces;
    const double part = static_cast<double>(i % kPieces) / static_cast<double>(kPieces);
    times[i] = static_cast<double>(i) / (2.0 * cutoff * static_cast<double>(kPieces));
    // Draw j stands at the time (j − kLobes)/(2 f_cut).
    for (std::size_t j = 0; j <= 2 * kLobes; ++j) {
      const double distance = part + static_cast<double>(kLobes) - static_cast<double>(j);
      values[i] += level * draws[whole + j] * lanczos(distance);
    }
  }
  return {std::move(times), std::move(values)};
}

}  // namespace modcal
