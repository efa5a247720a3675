// What rang before the record, and what its end cuts off, beside the force.
#include <algorithm>
#include <cmath>

#include "libinverse/structure/force/force_search.hpp"
#include "libinverse/structure/tuning.hpp"

namespace modcal {

BinVariances ForceSearch::variances() const {
  BinVariances result = variances_of(table_, spectra_, transfers_, others_);
  for (std::size_t k = 0; k < of_change_.size(); ++k) {
    for (std::size_t m = 0; m < spectra_.count(); ++m) {
      double& own = result.of_transfer[k][m];
      own = std::max(own, of_change_[k][m]);
    }
  }
  return result;
}

std::vector<std::vector<double>> ForceSearch::spread_of_change() const {
  std::vector<std::vector<double>> result(transfers_.size(), std::vector<double>(spectra_.count()));
  const DrawnModels models{table_, result_.refined, 1.0, options_.seed};
  for (std::size_t draw = 0; draw < options_.draws; ++draw) {
    const Transfers drawn = models.at(draw, spectra_);
    for (std::size_t k = 0; k < drawn.size(); ++k) {
      for (std::size_t m = 0; m < spectra_.count(); ++m) {
        result[k][m] +=
            std::norm(drawn[k][m] - transfers_[k][m]) / static_cast<double>(options_.draws);
      }
    }
  }
  return result;
}

Eigen::VectorXd ForceSearch::state_widths(const InitialState& state) const {
  // What rang before the record may be larger than what is left at its end.
  if (transfers_.size() > 1 || result_.rang) return {};
  const double rms = std::exp(-result_.sigma * spectra_.duration()) * last_rms_;
  const double noise = table_.scatters.front().noise;
  // A decay of a tenth of what noise has in all samples of it is not seen.
  const bool shows = rms * std::sqrt(static_cast<double>(spectra_.samples)) > 0.1 * noise;
  return shows ? state.widths_of(rms) : Eigen::VectorXd();
}

void ForceSearch::take_state_out() {
  recorded_.clear();
  if (!table_.measured.empty()) return;
  const Transfers recorded = spectra_.responses;
  const InitialState state(table_.model, spectra_);
  const bool may_ring = !(options_.rests && transfers_.size() == 1);
  for (int round = 0; round < kStateRounds; ++round) {
    find_power(evidence_of(spectra_, transfers_, variances_, kNoSensor));
    spectra_.responses = recorded;
    if (round == 0) {
      result_.rang = may_ring && state.is_told(state.fit(transfers_, variances_, power_));
    }
    const Eigen::VectorXd widths = state_widths(state);
    if (!result_.rang && widths.size() == 0) return;
    spectra_.responses = state.without(state.fit(transfers_, variances_, power_, widths).state);
    variances_ = variances();
  }
  recorded_ = recorded;
}

}  // namespace modcal
