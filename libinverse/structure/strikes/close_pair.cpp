#include "libinverse/structure/strikes/close_pair.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "libinverse/structure/strikes/tuning.hpp"
#include "libsim/base/turn.hpp"

namespace modcal {
namespace {

using Index = Eigen::Index;

struct NearStrike {
  ContourSpectra spectra;
  std::vector<std::vector<double>> weights;
};

// The bins about a mode. `made`: what it makes and what is left in all bins, weighted, by sensor;
// `row`: where those of the strike begin.
NearStrike near(const SearchedStrike& strike, const ModalPole& pole,
                const std::vector<Eigen::VectorXd>& made, Index row) {
  NearStrike result{.spectra = strike.spectra, .weights = strike.weights};
  ContourSpectra& spectra = result.spectra;
  const BinRange all = strike.spectra.bins;
  // On a contour a resonance is wider by σ.
  const double reach = kReachOfPair * (pole.zeta * pole.omega + spectra.grid.sigma);
  const BinRange about = bins_between(spectra.grid, pole.omega - reach, pole.omega + reach);
  spectra.bins = {.first = std::clamp(about.first, all.first, all.last),
                  .last = std::clamp(about.last, all.first, all.last)};
  const auto from = static_cast<std::ptrdiff_t>(spectra.bins.first - all.first);
  const auto to = from + static_cast<std::ptrdiff_t>(spectra.count());
  const auto cut = [from, to](auto& values) {
    values = {values.begin() + from, values.begin() + to};
  };
  cut(spectra.force);
  const auto count = static_cast<Index>(strike.spectra.count());
  for (std::size_t k = 0; k < made.size(); ++k) {
    cut(spectra.responses[k]);
    cut(result.weights[k]);
    for (std::size_t m = 0; m < spectra.count(); ++m) {
      const Index at = row + from + static_cast<Index>(m);
      spectra.responses[k][m] = Complex(made[k][at], made[k][at + count]) / result.weights[k][m];
    }
  }
  return result;
}

// By a fit's two columns of a mode, what it makes.
Eigen::VectorXd made_by(const SensorFit& fit, std::size_t mode) {
  const auto at = 2 * static_cast<Index>(mode);
  return fit.columns.middleCols<2>(at) * fit.amplitudes.segment<2>(at);
}

}  // namespace

std::array<double, 2> ClosePair::distance_of(const ModalPole& one) const {
  double frequency = 0.0, damping = 0.0;
  for (const std::size_t i : {0U, 1U}) {
    frequency = std::hypot(frequency, shares[i] * std::log(poles[i].omega / one.omega));
    damping = std::hypot(damping, shares[i] * std::log(poles[i].zeta / one.zeta));
  }
  const double all = std::hypot(shares[0], shares[1]);
  return {frequency / all, damping / all};
}

ClosePairs::ClosePairs(const PoleSearch& search, std::span<const SearchedStrike> strikes,
                       const std::vector<SensorKind>& kinds, const std::vector<ModalPole>& poles)
    : strikes_(strikes), kinds_(kinds), poles_(poles), fits_(search.at(poles)) {}

ClosePair ClosePairs::of(std::size_t mode) const {
  std::vector<Eigen::VectorXd> made;
  for (const SensorFit& fit : fits_) made.emplace_back(made_by(fit, mode) + fit.residual);
  std::vector<NearStrike> about;
  Index row = 0;
  for (const SearchedStrike& strike : strikes_) {
    about.push_back(near(strike, poles_[mode], made, row));
    row += 2 * static_cast<Index>(strike.spectra.count());
  }
  std::vector<SearchedStrike> searched;
  for (std::size_t i = 0; i < about.size(); ++i) {
    searched.push_back({about[i].spectra, strikes_[i].force, about[i].weights});
  }
  const PoleSearch search(searched, kinds_);
  std::vector<ModalPole> one = {poles_[mode]};
  const double before = search.fit(one, kPairSteps);
  ClosePair result{.poles = {one[0], one[0]}};
  std::vector<ModalPole> best;
  for (const double apart : {1.0, 3.0}) {
    std::vector<ModalPole> two = {one[0], one[0]};
    two[0].omega *= 1.0 - apart * one[0].zeta;
    two[1].omega *= 1.0 + apart * one[0].zeta;
    const double gain = before - search.fit(two, kPairSteps);
    if (gain > result.gain) result.gain = gain, best = std::move(two);
  }
  if (best.empty()) return result;
  result.poles = {best[0], best[1]};
  result.shares = {0.0, 0.0};
  for (const SensorFit& fit : search.at(best)) {
    for (const std::size_t i : {0U, 1U}) result.shares[i] += made_by(fit, i).squaredNorm();
  }
  const double all = result.shares[0] + result.shares[1];
  for (double& share : result.shares) share /= all;
  return result;
}

std::vector<ModalPole> ClosePairs::parted(double low, double high) const {
  ClosePair most;
  std::size_t mode = 0;
  for (std::size_t n = 0; n < poles_.size(); ++n) {
    if (poles_[n].omega < kTurn * low || poles_[n].omega > kTurn * high) continue;
    const ClosePair pair = of(n);
    if (pair.gain > most.gain) most = pair, mode = n;
  }
  if (most.gain == 0.0) return {};
  std::vector<ModalPole> result = poles_;
  result[mode] = most.poles[0];
  result.push_back(most.poles[1]);
  return result;
}

LatePairs::LatePairs(const std::vector<LateStrike>& late, const std::vector<SensorKind>& kinds,
                     const ModalModel& model, const std::vector<SensorScatter>& scatters)
    : poles_(model.poles) {
  double bins = 0.0, counted_twice = 1.0;
  for (const LateStrike& strike : late) {
    weights_.push_back(weights_of(strike.spectra, model, scatters));
    bins += static_cast<double>(strike.spectra.count());
    counted_twice = std::max(counted_twice, strike.spectra.correlated());
  }
  for (std::size_t i = 0; i < late.size(); ++i) {
    strikes_.push_back({late[i].spectra, late[i].force, weights_[i]});
  }
  const PoleSearch search(strikes_, kinds);
  cost_ = search.fit(poles_, kLateSteps);
  pairs_.emplace(search, strikes_, kinds, poles_);
  numbers_ = 2.0 * bins * static_cast<double>(kinds.size()) / counted_twice;
}

}  // namespace modcal
