// Where on a structure a force acts that nobody measured: the likelihood of every place.
#pragma once

#include "libinverse/structure/structure_record.hpp"
#include "libinverse/structure/structure_table.hpp"

namespace modcal {

/// Places in the order of their tables.
struct ContactPlaces {
  std::vector<double> left;         ///< rms of what no force there explains, over the responses [1]
  std::vector<double> probability;  ///< all places being equally likely before
  double numbers = 0.0;             ///< real numbers of the residuals that tell independently
  std::size_t best = 0;

  /// The fewest places that hold a probability of `share` together, the likeliest first.
  std::vector<std::size_t> credible(double share) const;
};

/// A table of modes for every place, sensors alike. The force is eliminated in every bin of a
/// contour: e = P y, P = I − h hᴴ/|h|², y weighted by a share of the responses about the bin. With
/// the scale of the errors unknown p(y | place) ∝ |e|^−n, n the numbers that tell independently:
/// 2B(K − 1) over κ = σT, or over the correlation of e from bin to bin where that is longer, as it
/// is where the model and not noise is off. Throws InvalidInput for one sensor (its response can be
/// explained at any place), fewer than two tables, other sensors and bands that share no bin.
ContactPlaces weigh_places(std::span<const StructureTable> tables, const StructureRecord& record,
                           double sigma);

}  // namespace modcal
