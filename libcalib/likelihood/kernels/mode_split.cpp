#include "libcalib/likelihood/kernels/mode_split.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libcalib/likelihood/kernels/likelihood_kernel.hpp"
#include "libcalib/likelihood/kernels/tuning.hpp"

namespace modcal {
namespace {

BlockNodes make_nodes() {
  BlockNodes nodes;
  for (std::size_t k = 0; k < WhitenedRecord::kBlock; ++k) {
    const double x = WhitenedRecord::block_place(static_cast<double>(k));
    for (std::size_t j = 0; j < BlockNodes::kCount; ++j) {
      double product = 1.0;
      const double own = WhitenedRecord::node_place(j);
      for (std::size_t i = 0; i < BlockNodes::kCount; ++i) {
        const double other = WhitenedRecord::node_place(i);
        if (i != j) product *= (x - other) / (own - other);
      }
      nodes.weight[j][k] = product;
    }
  }
  return nodes;
}

}  // namespace

const BlockNodes& block_nodes() {
  static const BlockNodes nodes = make_nodes();
  return nodes;
}

ModeSplits::ModeSplits(const WhitenedRecord& record, std::span<const LikelihoodMode> modes,
                       bool interpolate)
    : modes_(modes), counts_(record.blocks()) {
  order_.reserve(record.blocks() * modes.size());
  const double half = 0.5 * static_cast<double>(WhitenedRecord::kBlock - 1) * record.spacing;
  std::vector<double> poles;  // [rad/s]
  for (const LikelihoodMode& mode : modes) {
    poles.push_back(mode.decays ? std::arg(mode.pole) * record.sample_rate
                                : std::sqrt(mode.omega_squared));
  }
  const double turn = 2.0 * std::numbers::pi * record.sample_rate;
  for (std::size_t b = 0; b < record.blocks(); ++b) {
    const double center = record.omega[b * WhitenedRecord::kBlock] + half;
    const auto is_far = [&](std::size_t n) {
      double distance = std::abs(poles[n] - center);
      // The pole at −ω as well: the decays' repeats after a turn.
      if (modes[n].decays) distance = std::min(distance, turn - poles[n] - center);
      return interpolate && distance >= kFarMode * half;
    };
    std::size_t far = 0;
    for (std::size_t n = 0; n < modes.size(); ++n) far += is_far(n) ? 1 : 0;
    for (std::size_t group = 0; group < 4; ++group) {
      const bool wants_far = group >= 2;
      const std::size_t before = order_.size();
      for (std::size_t n = 0; n < modes.size(); ++n) {
        const bool counts_as_far = far >= kFewestFarModes && is_far(n);
        if (modes[n].even == (group % 2 == 1) && counts_as_far == wants_far) order_.push_back(n);
      }
      counts_[b][group] = order_.size() - before;
    }
  }
}

std::span<const std::size_t> ModeSplit::decaying(std::span<const std::size_t> list) const {
  while (!list.empty() && !modes[list.back()].decays) list = list.first(list.size() - 1);
  return list;
}

ModeSplit ModeSplits::of(std::size_t block) const {
  const std::size_t* at = order_.data() + block * modes_.size();
  ModeSplit split{.modes = modes_, .near = {}, .far = {}};
  for (std::size_t group = 0; group < 4; ++group) {
    auto& lists = group < 2 ? split.near : split.far;
    lists[group % 2] = {at, counts_[block][group]};
    at += counts_[block][group];
  }
  return split;
}

}  // namespace modcal
