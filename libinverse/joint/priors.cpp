#include "libinverse/joint/priors.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "libsim/base/error.hpp"

namespace modcal {
namespace {

void visit_corner(OptionVisitor& visitor, double& corner) {
  visitor.number({.key = "corner",
                  .meaning = "frequency below which the supposed spectrum is flat",
                  .unit = "Hz",
                  .range = Range::positive()},
                 corner);
}

void visit_passes(OptionVisitor& visitor, std::int64_t& passes) {
  visitor.integer({.key = "passes",
                   .meaning = "how often the spectrum is learned anew from the record",
                   .range = Range::closed(1, 100)},
                  passes);
}

}  // namespace

void FlatPrior::do_shape(const PriorGrid& /*grid*/, std::span<double> variance) const {
  std::fill(variance.begin(), variance.end(), 1.0);
}

void JumpPrior::Options::visit(OptionVisitor& visitor) { visit_corner(visitor, corner); }

JumpPrior::JumpPrior(const Options& options) : corner_(options.corner) {
  MODCAL_REQUIRE(corner_ > 0.0 && std::isfinite(corner_), "corner {:g} Hz of the prior must be > 0",
                 corner_);
}

void JumpPrior::do_shape(const PriorGrid& grid, std::span<double> variance) const {
  // sin² x = (1 − cos 2x)/2, cosines of sums from those of 64 places and of 64 steps within.
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
  visitor.number({.key = "octaves",
                  .meaning = "width of the smoothing in octaves",
                  .range = Range::closed(0.01, 4.0)},
                 octaves);
  visit_passes(visitor, passes);
}

SmoothPrior::SmoothPrior(const Options& options)
    : start_({.corner = options.corner}), octaves_(options.octaves), passes_(options.passes) {
  MODCAL_REQUIRE(octaves_ > 0.0 && passes_ >= 1,
                 "smoothing over {:g} octaves in {} passes: both must be > 0", octaves_, passes_);
}

void SmoothPrior::do_shape(const PriorGrid& grid, std::span<double> variance) const {
  start_.shape(grid, variance);
}

void SmoothPrior::do_learn(const PriorGrid& /*grid*/, std::span<double> power,
                           std::span<double> scratch) const {
  smooth_power(power, scratch, 1.0, 0.5 * (std::exp2(0.5 * octaves_) - 1.0));
}

void LearnedPrior::Options::visit(OptionVisitor& visitor) {
  visit_corner(visitor, corner);
  visitor.number({.key = "bandwidth",
                  .meaning = "full width of the smoothing over frequency",
                  .unit = "Hz",
                  .range = Range::positive()},
                 bandwidth);
  visit_passes(visitor, passes);
}

LearnedPrior::LearnedPrior(const Options& options)
    : start_({.corner = options.corner}), bandwidth_(options.bandwidth), passes_(options.passes) {
  MODCAL_REQUIRE(bandwidth_ > 0.0 && passes_ >= 1,
                 "smoothing over {:g} Hz in {} passes: both must be > 0", bandwidth_, passes_);
}

void LearnedPrior::do_shape(const PriorGrid& grid, std::span<double> variance) const {
  start_.shape(grid, variance);
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
