// Many candidates of one modal frequency at once.
#pragma once

#include <array>
#include <vector>

#include "libcalib/objectives/spectral_peak_function.hpp"
#include "libcalib/objectives/two_sided_arrays.hpp"

namespace modcal {

/// Scans of f_n change one term of H_r: the sum of the others is kept, and |F_r| is
/// |R_r| |D| / |S_r D + a_r|. Candidates are spread over the cores; the bits do not depend on their
/// number. Other parameters are scanned by evaluations of the whole objective.
class SpectralPeakScanner final : public EvaluatingScanner {
 public:
  SpectralPeakScanner(const SpectralPeakFunction& function, std::span<const double> x);
  void scan(std::size_t i, std::span<const double> candidates, std::span<double> values) override;
  void move(std::size_t i, double value) override;
  void refresh() override;

 private:
  CandidateBand prepare_band(const TwoSidedTerm& term);

  const SpectralPeakFunction& function_;
  BinRange range_;
  std::vector<TwoSidedTerm> terms_;
  TwoSidedArrays sums_storage_;
  TwoSidedArrays rest_storage_;
  TwoSidedSums sums_;
  std::array<std::vector<double>, 2> band_magnitudes_;
  std::vector<double> omegas_;
};

}  // namespace modcal
