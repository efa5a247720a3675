// Where in the band a fit leaves more than noise.
#pragma once

#include <cstddef>
#include <vector>

#include "libcalib/likelihood/projected_likelihood.hpp"

namespace modcal {

/// Mean of |e|² over the bins of a band: 1 ± 1/√bins of noise alone.
struct MisfitBand {
  double frequency = 0.0;  ///< middle of the band [Hz]
  double chi2 = 0.0;       ///< [1]
  std::size_t bins = 0;
  double deviation() const;  ///< of chi2, of noise alone [1]
};

struct LocalMisfit {
  std::vector<MisfitBand> modes;  ///< of every mode the bins that are nearest to it
  std::vector<MisfitBand> bands;  ///< a quarter of f_1 wide or eight bins, from 0 on
};
/// Of a likelihood without weights.
LocalMisfit local_misfit(const ProjectedLikelihood& likelihood, const ModelPoint& point);

}  // namespace modcal
