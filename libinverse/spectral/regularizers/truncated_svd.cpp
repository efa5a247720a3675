#include "libinverse/spectral/regularizers/truncated_svd.hpp"

namespace modcal {

void TruncatedSvd::do_filter_factors(std::span<const double> sigma, double parameter,
                                     std::span<double> kept, std::span<double> lost) const {
  for (std::size_t i = 0; i < sigma.size(); ++i) {
    kept[i] = sigma[i] > 0.0 && sigma[i] >= parameter ? 1.0 : 0.0;
  }
  for (std::size_t i = 0; i < lost.size(); ++i) lost[i] = 1.0 - kept[i];
}

}  // namespace modcal
