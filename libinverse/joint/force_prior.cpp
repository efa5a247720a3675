#include "libinverse/joint/force_prior.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "libsim/base/error.hpp"

namespace modcal {
namespace {

void visit_corner(OptionVisitor& visitor, double& corner) {
  visitor("corner", "frequency below which the supposed spectrum is flat",
          {.unit = "Hz", .range = Range::positive()}, corner);
}

void visit_passes(OptionVisitor& visitor, std::int64_t& passes) {
  visitor("passes", "how often the spectrum is learned anew from the record",
          {.range = Range::closed(1, 100)}, passes);
}

// The window slides: a bin enters once and leaves once. Bins far apart in power follow each other,
// so the sum is begun anew where what has left outweighs what is left.
void box_mean(std::span<const double> in, std::span<double> out, double at_zero, double slope) {
  const std::size_t n = in.size();
  std::size_t begin = 0, end = 0;
  double sum = 0.0, largest = 0.0;
  for (std::size_t k = 0; k < n; ++k) {
    const auto half = static_cast<std::size_t>(at_zero + slope * static_cast<double>(k));
    const std::size_t low = k > half ? k - half : 0;
    const std::size_t high = std::min(n, k + half + 1);
    for (; end < high; ++end) sum += in[end];
    for (; begin < low; ++begin) sum -= in[begin];
    largest = std::max(largest, sum);
    if (sum < 1e-6 * largest) {
      sum = 0.0;
      for (std::size_t j = low; j < high; ++j) sum += in[j];
      largest = sum;
    }
    out[k] = sum / static_cast<double>(high - low);
  }
}

// Sums of the first i + 1 terms of several runs, whose additions are under way at once.
template <std::size_t kChains, class Term, class Visit>
void running_sums(std::size_t count, Term term, Visit visit) {
  double sums[kChains] = {};
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t c = 0; c < kChains; ++c) {
      sums[c] += term(c, i);
      visit(c, i, sums[c]);
    }
  }
}

// Means over k ± half of windows inside the spectrum. A window of w bins is the end of one block of
// w bins and the beginning of the next: sums from either side of the border, nothing subtracted
// (van Herk, 1992).
template <std::size_t kChains>
void inner_means(std::span<const double> in, std::span<double> out, std::size_t half,
                 std::size_t block) {
  const std::size_t width = 2 * half + 1;
  const double inverse = 1.0 / static_cast<double>(width);
  const double* from = in.data() + block * width;
  double* to = out.data() + block * width + half;
  running_sums<kChains>(
      width, [&](std::size_t c, std::size_t i) { return from[c * width + width - 1 - i]; },
      [&](std::size_t c, std::size_t i, double sum) { to[c * width + width - 1 - i] = sum; });
  for (std::size_t c = 0; c < kChains; ++c) to[c * width] *= inverse;
  running_sums<kChains>(
      width - 1, [&](std::size_t c, std::size_t i) { return from[(c + 1) * width + i]; },
      [&](std::size_t c, std::size_t i, double sum) {
        double& mean = to[c * width + 1 + i];
        mean = (mean + sum) * inverse;
      });
}

void constant_box_mean(std::span<const double> in, std::span<double> out, std::size_t half) {
  // Fixed by: additions under way at once; every window has its own sum whatever their number.
  constexpr std::size_t kChains = 4;
  const std::size_t n = in.size(), width = 2 * half + 1;
  const std::size_t blocks = n / width - 1;  // that have a next one
  std::size_t block = 0;
  for (; block + kChains <= blocks; block += kChains) inner_means<kChains>(in, out, half, block);
  for (; block < blocks; ++block) inner_means<1>(in, out, half, block);
  // Windows cut by an end, and the last ones, which no whole block follows.
  double sum = 0.0;
  for (std::size_t j = 0; j < half; ++j) sum += in[j];
  for (std::size_t k = 0; k < half; ++k) {
    sum += in[k + half];
    out[k] = sum / static_cast<double>(k + half + 1);
  }
  for (std::size_t k = blocks * width + half; k < n; ++k) {
    const std::size_t high = std::min(n, k + half + 1);
    double window = 0.0;
    for (std::size_t j = k - half; j < high; ++j) window += in[j];
    out[k] = window / static_cast<double>(high - (k - half));
  }
}

void box_mean_of(std::span<const double> in, std::span<double> out, double at_zero, double slope) {
  const auto half = static_cast<std::size_t>(at_zero);
  if (slope == 0.0 && half > 0 && in.size() >= 4 * (2 * half + 1)) {
    constant_box_mean(in, out, half);
  } else {
    box_mean(in, out, at_zero, slope);
  }
}

}  // namespace

void ForcePrior::shape(const PriorGrid& grid, std::span<double> variance) const {
  MODCAL_REQUIRE(variance.size() == grid.bins, "{} variances for {} bins", variance.size(),
                 grid.bins);
  do_shape(grid, variance);
  double sum = 0.0;
  for (const double value : variance) sum += value;
  const double scale = static_cast<double>(grid.bins) / sum;
  for (double& value : variance) value *= scale;
}

void ForcePrior::learn(const PriorGrid& grid, std::span<double> power,
                       std::span<double> scratch) const {
  MODCAL_REQUIRE(power.size() == grid.bins && scratch.size() == power.size(),
                 "{} powers and {} places for {} bins", power.size(), scratch.size(), grid.bins);
  do_learn(grid, power, scratch);
}

void ForcePrior::do_learn(const PriorGrid& /*grid*/, std::span<double> /*power*/,
                          std::span<double> /*scratch*/) const {}

void smooth_power(std::span<double> power, std::span<double> scratch, double bins_at_zero,
                  double bins_per_bin) {
  box_mean_of(power, scratch, bins_at_zero, bins_per_bin);
  box_mean_of(scratch, power, bins_at_zero, bins_per_bin);
}

void FlatPrior::do_shape(const PriorGrid& /*grid*/, std::span<double> variance) const {
  std::fill(variance.begin(), variance.end(), 1.0);
}

void JumpPrior::Options::visit(OptionVisitor& visitor) { visit_corner(visitor, corner); }

JumpPrior::JumpPrior(const Options& options) : corner_(options.corner) {
  MODCAL_REQUIRE(corner_ > 0.0 && std::isfinite(corner_), "corner {:g} Hz of the prior must be > 0",
                 corner_);
}

void JumpPrior::do_shape(const PriorGrid& grid, std::span<double> variance) const {
  // sin² x = (1 − cos 2x)/2, cosines of sums from those of places and of steps within.
  // Fixed by: length of two arrays; the sums of angles hold for any.
  constexpr std::size_t kBlock = 64;
  const double step = 2.0 * std::numbers::pi / static_cast<double>(grid.samples);
  std::array<double, kBlock> cosine, sine;
  for (std::size_t j = 0; j < kBlock; ++j) {
    cosine[j] = 0.5 * std::cos(step * static_cast<double>(j));
    sine[j] = 0.5 * std::sin(step * static_cast<double>(j));
  }
  const double corner = std::sin(std::min(0.5, corner_ / grid.sample_rate) * std::numbers::pi);
  const double constant = 0.5 + corner * corner;
  for (std::size_t begin = 0; begin < variance.size(); begin += kBlock) {
    const double place = step * static_cast<double>(begin);
    const double place_cosine = std::cos(place), place_sine = std::sin(place);
    const std::size_t count = std::min(kBlock, variance.size() - begin);
    for (std::size_t j = 0; j < count; ++j) {
      variance[begin + j] = 1.0 / (constant - (place_cosine * cosine[j] - place_sine * sine[j]));
    }
  }
}

void SmoothPrior::Options::visit(OptionVisitor& visitor) {
  visit_corner(visitor, corner);
  visitor("octaves", "width of the smoothing in octaves", {.range = Range::closed(0.01, 4.0)},
          octaves);
  visit_passes(visitor, passes);
}

SmoothPrior::SmoothPrior(const Options& options)
    : LearningPrior(options.corner, options.passes), octaves_(options.octaves) {
  MODCAL_REQUIRE(octaves_ > 0.0 && options.passes >= 1,
                 "smoothing over {:g} octaves in {} passes: both must be > 0", octaves_,
                 options.passes);
}

void SmoothPrior::do_learn(const PriorGrid& /*grid*/, std::span<double> power,
                           std::span<double> scratch) const {
  smooth_power(power, scratch, 1.0, 0.5 * (std::exp2(0.5 * octaves_) - 1.0));
}

void LearnedPrior::Options::visit(OptionVisitor& visitor) {
  visit_corner(visitor, corner);
  visitor("bandwidth", "full width of the smoothing over frequency",
          {.unit = "Hz", .range = Range::positive()}, bandwidth);
  visit_passes(visitor, passes);
}

LearnedPrior::LearnedPrior(const Options& options)
    : LearningPrior(options.corner, options.passes), bandwidth_(options.bandwidth) {
  MODCAL_REQUIRE(bandwidth_ > 0.0 && options.passes >= 1,
                 "smoothing over {:g} Hz in {} passes: both must be > 0", bandwidth_,
                 options.passes);
}

void LearnedPrior::do_learn(const PriorGrid& grid, std::span<double> power,
                            std::span<double> scratch) const {
  // Two boxes of half the width make a triangle of the full one.
  smooth_power(power, scratch, std::max(1.0, 0.25 * bandwidth_ / grid.bin_width()), 0.0);
}

Registry<ForcePrior> ForcePrior::registry() {
  static constexpr std::array kTable = {
      entry_of<ForcePrior, FlatPrior>("flat", "the same variance at every frequency"),
      entry_of<ForcePrior, JumpPrior>("jumps", "a force that jumps: 1/f^2 above a corner"),
      entry_of<ForcePrior, LearnedPrior>("learned",
                                         "learned from the record, lines of a note resolved"),
      entry_of<ForcePrior, SmoothPrior>("smooth",
                                        "learned from the record, smooth over part of an octave"),
  };
  return kTable;
}

}  // namespace modcal
