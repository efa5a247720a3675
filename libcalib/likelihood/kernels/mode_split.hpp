// Modes that resonate in or near a block of bins, and modes that are smooth across it.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "libcalib/likelihood/records/whitened_record.hpp"

namespace modcal {

struct LikelihoodMode;

/// Modes of one block by parity (index 1: even). Near ones are evaluated in every bin. Far ones
/// have their poles 4 half-widths or more from the block's center and are evaluated at its P = 16
/// Chebyshev nodes alone. For f = 1/(x − x_0) the interpolation's relative error is
/// |T_P(x)/T_P(x_0)| ≤ 1/T_16(4) = 1e-14, for its square 22 times that (differentiate by x_0).
struct ModeSplit {
  std::span<const LikelihoodMode> modes;
  std::array<std::span<const std::size_t>, 2> near, far;

  std::size_t near_count() const { return near[0].size() + near[1].size(); }
  /// Near modes of both parities: the lists lie side by side.
  std::span<const std::size_t> all_near() const { return {near[0].data(), near_count()}; }
  /// Those of a list that leave something ringing; modes that do not stand last.
  std::span<const std::size_t> decaying(std::span<const std::size_t> list) const;
  bool has_far() const { return !far[0].empty() || !far[1].empty(); }
};

/// The split of every block. Blocks with a few far modes have none: interpolation costs more.
class ModeSplits {
 public:
  /// `modes` must outlive this. interpolate: false makes every mode near everywhere.
  ModeSplits(const WhitenedRecord& record, std::span<const LikelihoodMode> modes,
             bool interpolate = true);
  ModeSplit of(std::size_t block) const;

 private:
  std::span<const LikelihoodMode> modes_;
  std::vector<std::size_t> order_;                  // N indices a block: near odd, near even, …
  std::vector<std::array<std::size_t, 4>> counts_;  // of each of the four
};

/// Lagrange's polynomials of the nodes at the bins of a block.
struct BlockNodes {
  static constexpr std::size_t kCount = WhitenedRecord::kNodes;
  alignas(64) double weight[kCount][WhitenedRecord::kBlock];
};
const BlockNodes& block_nodes();

}  // namespace modcal
