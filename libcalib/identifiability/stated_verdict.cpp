#include "libcalib/identifiability/stated_verdict.hpp"

namespace modcal {

void trust_stated_frequencies(const StatedPriors& priors, const Eigen::VectorXd& deviation,
                              std::vector<ModeVerdict>& modes) {
  for (std::size_t n = 0; n < modes.size(); ++n) {
    ModeVerdict& verdict = modes[n];
    if (priors.fixes_frequency(n)) {
      verdict.source = ModeSource::kFixed;
      verdict.reason = WeakReason::kNone;
      verdict.deviation = verdict.data_deviation = 0.0;
    }
    if (verdict.source == ModeSource::kIdentified || deviation.size() == 0) continue;
    if (!priors.has({.kind = ParameterKind::kFrequency, .index = n})) continue;
    verdict.source = ModeSource::kPrior;
    verdict.deviation = deviation[static_cast<Eigen::Index>(n)];
  }
}

void widen_stated(const StatedPriors& priors, double width, Eigen::VectorXd& widths) {
  for (Eigen::Index i = 0; i < widths.size(); ++i) {
    const auto n = static_cast<std::size_t>(i);
    const bool stated = priors.has({.kind = ParameterKind::kFrequency, .index = n});
    if (stated || priors.fixes_frequency(n)) widths[i] = width;
  }
}

}  // namespace modcal
