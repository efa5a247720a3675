// What a record holds beside the force and the free decays, known but for its amplitude.
#pragma once

#include <array>
#include <vector>

#include "libcalib/likelihood/records/whitened_record.hpp"
#include "libcalib/parameters/parameters.hpp"

namespace modcal {

/// Something in the record of one end, known but for its real amplitude.
struct PlainTransient {
  bool right = false;
  PlanarVector numbers;  ///< its transform, whitened but for 1/s_r
  /// What is in the record of x = 0 where that at x = L is in `numbers`; empty: nothing.
  PlanarVector left = {};
  /// ∂numbers by the numbers of the sensor at x = L; empty: none.
  std::array<PlanarVector, Sensor::kCount> by_sensor = {};
};
/// σ > 0: static offsets of both records. σ = 0: where the sensor at x = L has a delay or a corner
/// of its own, or may have one, what it holds at the end of the record: one sample and its own
/// decay. Where there are modes above the stated ones, what these leave ringing, smooth in the
/// band: 1, s and s² at both ends; and the signals of the record. At any σ the cosine and sine of
/// every line of the mains, steady and growing in time: the mains wander, and F is known to a
/// fraction of 1/T.
std::vector<PlainTransient> plain_transients(const WhitenedRecord& record, const ModelPoint& point);

}  // namespace modcal
