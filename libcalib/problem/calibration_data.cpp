#include "libcalib/problem/calibration_data.hpp"

#include <algorithm>
#include <cmath>

#include "libsim/base/error.hpp"

namespace modcal {
namespace {

std::string_view name_of(End end) { return end == End::kLeft ? "left" : "right"; }

constexpr std::array kEnds = {End::kLeft, End::kRight};

std::vector<Complex> spectrum_of(std::span<const double> record, End end) {
  if (record.empty()) return {};
  for (std::size_t j = 0; j < record.size(); ++j) {
    MODCAL_REQUIRE(std::isfinite(record[j]), "sample {} of the {} reaction is {:g}", j,
                   name_of(end), record[j]);
  }
  return RealFft(record.size()).forward(record);
}

}  // namespace

CalibrationData CalibrationData::of_records(std::span<const double> left,
                                            std::span<const double> right, double sample_rate) {
  MODCAL_REQUIRE(left.empty() || right.empty() || left.size() == right.size(),
                 "the reactions have {} and {} samples: cut them to one length", left.size(),
                 right.size());
  CalibrationData data;
  data.samples = std::max(left.size(), right.size());
  data.sample_rate = sample_rate;
  data.reactions = {spectrum_of(left, End::kLeft), spectrum_of(right, End::kRight)};
  data.require_valid();
  return data;
}

void CalibrationData::require_valid() const {
  MODCAL_REQUIRE(has(End::kLeft) || has(End::kRight),
                 "a calibration needs the reaction at one end at least");
  MODCAL_REQUIRE(sample_rate > 0.0 && std::isfinite(sample_rate),
                 "sample rate {:g} Hz must be positive and finite", sample_rate);
  const std::size_t bins = grid().bins;
  for (const End end : kEnds) {
    if (!has(end)) continue;
    MODCAL_REQUIRE(reaction(end).size() == bins,
                   "the {} reaction has {} bins, a record of {} samples has {}", name_of(end),
                   reaction(end).size(), samples, bins);
    for (std::size_t k = 0; k < bins; ++k) {
      MODCAL_REQUIRE(std::isfinite(std::norm(reaction(end)[k])),
                     "bin {} of the {} reaction is not finite", k, name_of(end));
    }
  }
}

void CalibrationData::require_motion() const {
  for (const End end : kEnds) {
    if (!has(end)) continue;
    const std::vector<Complex>& bins = reaction(end);
    // A constant record leaves rounding in the other bins.
    const double rounding = 1e-13 * std::abs(bins.front());
    const bool moves = std::any_of(bins.begin() + 1, bins.end(),
                                   [&](Complex bin) { return std::abs(bin) > rounding; });
    MODCAL_REQUIRE(moves,
                   "the {} reaction is silent: all of its {} samples are {:g} N; check its sensor, "
                   "channel and scale, or leave that reaction out where the method works with one",
                   name_of(end), samples,
                   bins.front().real() / static_cast<double>(std::max<std::size_t>(samples, 1)));
  }
}

}  // namespace modcal
