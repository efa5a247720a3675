// Many candidates of one modal frequency at once.
#pragma once

#include <array>
#include <vector>

#include "libcalib/objectives/spectral_peak_function.hpp"
#include "libcalib/objectives/two_sided_arrays.hpp"

namespace modcal {

/// Scans of f_n change one term of H_r: with S_r, the sum of the others over the mode's band,
/// |F_r| is |R_r| |D| / |S_r D + a_r|. Blocks of bins are spread over the cores and added up in
/// their order; the bits do not depend on the number of cores. Other parameters are scanned by
/// evaluations of the whole objective.
///
/// Of the frequencies, those within twice the half band h of f_n reach it: a resonance farther away
/// that shifts by a share s of its frequency changes its term by s/h at most in the bins of f_n.
class SpectralPeakScanner final : public EvaluatingScanner {
 public:
  SpectralPeakScanner(const SpectralPeakFunction& function, std::span<const double> x);
  void scan(std::size_t i, std::span<const double> candidates, std::span<double> values) override;
  void move(std::size_t i, double value) override;
  bool reaches(std::size_t j, std::size_t i) const override;
  void refresh() override;

 private:
  CandidateBand prepare_band(std::size_t mode);
  void integrate_block(const CandidateBand& band, std::size_t block);

  const SpectralPeakFunction& function_;
  std::vector<TwoSidedTerm> terms_;
  std::vector<TwoSidedTerm> others_;  // without the scanned mode
  TwoSidedArrays rest_storage_;
  std::array<std::vector<double>, 2> magnitudes_;
  std::vector<double> band_omegas_;
  std::vector<double> omegas_;
  std::vector<double> partial_;  // blocks × candidates
};

}  // namespace modcal
