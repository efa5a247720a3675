// What one pair of poles contributes to a record that begins at rest, the force being known.
#pragma once

#include <array>

#include "libinverse/structure/structure_record.hpp"

namespace modcal {

/// Spectra over the bins of a record for a modal constant of 1 and of i.
using ColumnPair = std::array<std::vector<Complex>, 2>;

/// The columns of one pair of poles for every power of s asked for:
///   numerator(s) F/D + r c U + conj(r c) U',
/// r the residue of numerator/D, U = 1/(1 − exp((λ − s)/f_s)), and c = −exp(−σT)/f_s Σ_j f_j
/// exp(λ(T − t_j)) what has not rung out at the record's end: exact for a record of any length.
class StrikeColumns {
 public:
  /// Both must outlive this; force: samples [N].
  StrikeColumns(const ContourSpectra& spectra, std::span<const double> force);

  /// Columns by power (0, 1, 2), empty where no sensor has it; scaled by ω_n^(2−p), so that all
  /// modal constants are of one size.
  std::array<ColumnPair, 3> of(const ModalPole& pole, const std::array<bool, 3>& powers) const;

 private:
  Complex left_over(Complex rate) const;
  const ContourSpectra& spectra_;
  std::vector<double> force_;
  std::vector<Complex> delay_;  // exp(−s/f_s)
  bool rings_ = true;           // at the record's end, for what the contour leaves of it
};

}  // namespace modcal
