#include "libcalib/likelihood/stated_verdict.hpp"

namespace modcal {

void trust_stated_frequencies(const StatedPriors& priors, const Eigen::VectorXd& deviation,
                              std::vector<ModeVerdict>& modes) {
  for (std::size_t n = 0; n < modes.size(); ++n) {
    ModeVerdict& verdict = modes[n];
    if (verdict.source == ModeSource::kIdentified) continue;
    if (!priors.has({.kind = UnknownKind::kFrequency, .mode = n})) continue;
    verdict.source = ModeSource::kPrior;
    verdict.deviation = deviation[static_cast<Eigen::Index>(n)];
  }
}

}  // namespace modcal
