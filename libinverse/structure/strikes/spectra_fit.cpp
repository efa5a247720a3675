#include "libinverse/structure/strikes/spectra_fit.hpp"

#include <algorithm>
#include <cmath>

#include "libinverse/structure/strikes/force_noise.hpp"
#include "libinverse/structure/strikes/pole_scatter.hpp"
#include "libinverse/structure/tuning.hpp"
#include "libsim/base/error.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

using Index = Eigen::Index;

class Fit {
 public:
  /// records: of the forces; empty: of response functions, which have none. late: of each strike,
  /// or of none.
  Fit(std::vector<StructureRecord> records, std::vector<ContourSpectra> spectra,
      std::vector<LateStrike> late, const std::vector<SensorKind>& kinds,
      const StrikeFitOptions& options)
      : records_(std::move(records)), late_(std::move(late)), kinds_(kinds), options_(options) {
    records_.resize(spectra.size());
    for (ContourSpectra& own : spectra) {
      bins_ += own.count();
      counted_twice_ = std::max(counted_twice_, own.correlated());
      result_.strikes.push_back({.spectra = std::move(own)});
    }
  }

  StrikeFit run() {
    for (const FittedStrike& strike : result_.strikes) {
      weights_.push_back(weights_of(strike.spectra, options_.relative_error));
    }
    std::vector<ModalPole> best = chosen();
    part_pairs(best);
    // Now the residuals say how right a bin is: twice, as they depend on it.
    for (int round = 0; round < 2; ++round) {
      weigh_by_scatter();
      const PoleSearch again(searched(), kinds_);
      again.fit(best, 30);
      std::ranges::sort(best, {}, &ModalPole::omega);
      tell(again, best);
      if (round == 1) tell_deviations(again, best);
    }
    if (result_.strikes.size() > 1) tell_further(best);
    tell_late(best);
    // What pulls a mode apart is the same in every strike.
    for (const std::size_t n : result_.disputed) {
      const auto i = static_cast<Index>(2 * n);
      widen(n, between_[i], between_[i + 1]);
    }
    if (!records_.front().force.empty()) result_.table.take_pulse(records_.front());
    return std::move(result_);
  }

 private:
  std::vector<SearchedStrike> searched() const {
    std::vector<SearchedStrike> strikes;
    for (std::size_t i = 0; i < records_.size(); ++i) {
      strikes.push_back({result_.strikes[i].spectra, records_[i].force, weights_[i]});
    }
    return strikes;
  }

  // The poles of least BIC.
  std::vector<ModalPole> chosen() {
    PoleSearch search(searched(), kinds_);
    std::vector<ModalPole> poles, best;
    double least = std::numeric_limits<double>::infinity();
    while (poles.size() < options_.most_modes && parameters(poles.size() + 1) < 0.75 * numbers()) {
      poles.push_back(search.best_addition(poles));
      const double cost = search.fit(poles, 3), criterion = this->criterion(cost, poles.size());
      result_.steps.push_back({.modes = poles.size(),
                               .misfit = misfit(cost, poles.size()),
                               .criterion = criterion,
                               .poles = poles});
      if (criterion < least) least = criterion, best = poles;
      if (poles.size() > best.size() + 3) break;
    }
    MODCAL_REQUIRE(!best.empty(),
                   "the record tells {:.3g} numbers in its band, a mode takes {:g}: state a wider "
                   "band or a smaller contour",
                   numbers(), parameters(1));
    result_.misfit = misfit(search.fit(best, 30), best.size());
    tell(search, best);
    return best;
  }

  // Bins that tell alike count as one; of real and imaginary part each.
  double numbers() const {
    return 2.0 * static_cast<double>(bins_ * kinds_.size()) / counted_twice_;
  }
  double parameters(std::size_t modes) const {
    const auto n = static_cast<double>(modes), k = static_cast<double>(kinds_.size());
    return n * (2.0 + 2.0 * k) + 2.0 * k;
  }
  // Over its degrees of freedom.
  double misfit(double cost, std::size_t modes) const {
    return cost / counted_twice_ / (numbers() - parameters(modes));
  }
  double criterion(double cost, std::size_t modes) const {
    return numbers() * std::log(cost / counted_twice_ / numbers()) +
           parameters(modes) * std::log(numbers());
  }
  void weigh_by_scatter() {
    for (std::size_t i = 0; i < weights_.size(); ++i) {
      weights_[i] = weights_of(result_.strikes[i].spectra, result_.table.model, scatters_);
    }
  }

  // A search that adds one pair of poles to others as they are does not see that two would take
  // more on either side of where one is. As long as BIC falls.
  void part_pairs(std::vector<ModalPole>& poles) {
    while (poles.size() < options_.most_modes && parameters(poles.size() + 1) < 0.75 * numbers()) {
      weigh_by_scatter();
      const std::vector<SearchedStrike> strikes = searched();
      const PoleSearch search(strikes, kinds_);
      const double before = search.fit(poles, 30);
      std::vector<ModalPole> parted =
          ClosePairs(search, strikes, kinds_, poles).parted(options_.low, options_.high);
      if (parted.empty()) return;
      const double after = search.fit(parted, 30);
      if (!(criterion(after, parted.size()) < criterion(before, poles.size()))) return;
      poles = std::move(parted);
      tell(search, poles);
    }
  }

  // What rings late parts modes that are one at first, or tells that the frequency of one falls
  // with its amplitude. Either way a mode is as uncertain as its two are apart, each by its share.
  void tell_late(const std::vector<ModalPole>& poles) {
    if (late_.empty()) return;
    const LatePairs pairs(late_, kinds_, result_.table.model, scatters_);
    for (std::size_t n = 0; n < poles.size(); ++n) {
      if (std::ranges::count(result_.stand_ins, n) > 0) continue;
      const ClosePair pair = pairs.of(n);
      if (!(pairs.information(pair) > parameters(1) - parameters(0))) continue;
      const auto [frequency, damping] = pair.distance_of(poles[n]);
      if (widen(n, frequency, damping)) result_.doubled.push_back(n);
    }
  }
  // Whether either deviation was less.
  bool widen(std::size_t mode, double frequency, double damping) {
    double& of_frequency = result_.table.frequency_deviations[mode];
    double& of_damping = result_.table.damping_deviations[mode];
    const bool was_less = of_frequency < frequency || of_damping < damping;
    of_frequency = std::max(of_frequency, frequency), of_damping = std::max(of_damping, damping);
    return was_less;
  }

  void tell(const PoleSearch& search, const std::vector<ModalPole>& poles) {
    StructureTable& table = result_.table;
    result_.residuals.clear();
    for (FittedStrike& strike : result_.strikes) strike.modeled.clear(), strike.residuals.clear();
    table.scatters.clear();
    scatters_.clear();
    table.low = options_.low, table.high = options_.high;
    table.model = {.poles = poles, .sensors = kinds_};
    const std::vector<SensorFit> fits = search.at(poles);
    for (std::size_t k = 0; k < kinds_.size(); ++k) {
      const Eigen::VectorXd x = fits[k].amplitudes.cwiseQuotient(fits[k].norms);
      for (std::size_t n = 0; n < poles.size(); ++n) {
        const double scale = std::pow(poles[n].omega, 2 - power_of_s(kinds_[k]));
        table.model.constants.push_back(scale * x[static_cast<Index>(2 * n)]);
        table.model.quadrature.push_back(scale * x[static_cast<Index>(2 * n + 1)]);
      }
      table.model.residuals.push_back(
          {.below = x[2 * std::ssize(poles)], .constant = x[2 * std::ssize(poles) + 1]});
      tell_rest(k, fits[k]);
    }
  }

  // By what scatter and noise expect of the residuals: a share of the response everywhere, as the
  // weights have it, would make a sharp resonance as uncertain as its flanks.
  void tell_deviations(const PoleSearch& search, const std::vector<ModalPole>& poles) {
    StructureTable& table = result_.table;
    // Unknowns took their share of the residuals.
    const double share = numbers() / (numbers() - parameters(poles.size()));
    const std::vector<SensorFit> fits = search.at(poles);
    const std::vector<Eigen::MatrixXd> slopes = search.jacobians(poles, fits);
    // Response functions have no force.
    ForceNoise force;
    if (!records_.front().force.empty()) {
      force = force_noise_of(records_, result_.strikes, weights_, table.model, fits, slopes);
    }
    std::vector<Eigen::VectorXd> variances;
    std::vector<double> noise;
    for (std::size_t k = 0; k < kinds_.size(); ++k) {
      noise.push_back(scatters_[k].noise * std::sqrt(share));
      Eigen::VectorXd& own = variances.emplace_back(static_cast<Index>(bins_));
      Index row = 0;
      for (std::size_t i = 0; i < weights_.size(); ++i) {
        const ContourSpectra& spectra = result_.strikes[i].spectra;
        const double of_force = force.deviation * force.deviation * spectra.noise_power();
        const std::vector<double> made = made_by_modes(spectra, table.model, k);
        for (std::size_t m = 0; m < made.size(); ++m, ++row) {
          const double weight = weights_[i][k][m];
          double off = share * scatters_[k].modal * scatters_[k].modal * made[m];
          if (of_force > 0.0) off -= of_force * std::norm(force.transfers[i][k][m]);
          own[row] = 0.5 * counted_twice_ * weight * weight * std::max(0.0, off);
        }
      }
    }
    const Eigen::MatrixXd covariance = search.covariance(slopes, variances, noise, force);
    const Eigen::VectorXd between = search.variance_between(slopes, fits);
    between_ = between.cwiseSqrt() * student_quantile(kinds_.size() - 1) / student_quantile(0);
    for (std::size_t n = 0; n < poles.size(); ++n) {
      const auto i = static_cast<Index>(2 * n);
      MODCAL_REQUIRE(covariance(i, i) >= 0.0 && covariance(i + 1, i + 1) >= 0.0,
                     "nothing tells the mode at {:g} Hz from the others: state a narrower band or "
                     "fewer modes",
                     table.frequency(n));
      if (kinds_.size() >= kFewestThatPull &&
          (between.segment<2>(i).array() > covariance.diagonal().segment<2>(i).array()).any()) {
        result_.disputed.push_back(n);
      }
      table.frequency_deviations.push_back(std::sqrt(covariance(i, i)));
      table.damping_deviations.push_back(std::sqrt(covariance(i + 1, i + 1)));
      const double f = table.frequency(n);
      const bool is_told = table.frequency_deviations[n] <= kToldWidth * poles[n].zeta;
      if (f < table.low || f > table.high || !is_told) result_.stand_ins.push_back(n);
    }
  }

  // What the structure changes from strike to strike no residual of one tells.
  void tell_further(const std::vector<ModalPole>& poles) {
    const std::vector<std::vector<ModalPole>> each = poles_of_each(searched(), kinds_, poles);
    for (std::size_t i = 0; i < each.size(); ++i) result_.strikes[i].poles = each[i];
    const auto take = [&](double ModalPole::*quantity, std::vector<double>& deviations) {
      const FurtherStrike further = further_strike(each, poles, quantity, deviations);
      deviations.assign(further.deviations.begin(), further.deviations.end());
      return quantile({further.scatters.begin(), further.scatters.end()}, 0.5);
    };
    result_.frequency_scatter = take(&ModalPole::omega, result_.table.frequency_deviations);
    result_.damping_scatter = take(&ModalPole::zeta, result_.table.damping_deviations);
  }

  void tell_rest(std::size_t k, const SensorFit& fit) {
    const ModalModel& model = result_.table.model;
    // Of noise of a deviation of 1 in every sample.
    std::vector<double> left, made;
    double rest = 0.0, all = 0.0, modal = 0.0;
    Index row = 0;
    for (std::size_t i = 0; i < weights_.size(); ++i) {
      FittedStrike& strike = result_.strikes[i];
      const ContourSpectra& spectra = strike.spectra;
      const double power = spectra.noise_power();
      const std::vector<double> own = made_by_modes(spectra, model, k);
      std::vector<Complex>& modeled = strike.modeled.emplace_back();
      const auto count = static_cast<Index>(spectra.count());
      double of_strike = 0.0;
      for (std::size_t m = 0; m < spectra.count(); ++m, ++row) {
        const Complex residual =
            Complex(fit.residual[row], fit.residual[row + count]) / weights_[i][k][m];
        modeled.push_back(spectra.responses[k][m] - residual);
        left.push_back(std::norm(residual) / power);
        made.push_back(own[m] / power);
        of_strike += std::norm(residual);
        modal += own[m];
      }
      row += count;
      const double total = mean_power(spectra.responses[k]) * static_cast<double>(count);
      strike.residuals.push_back(std::sqrt(of_strike / total));
      rest += of_strike;
      all += total;
    }
    result_.residuals.push_back(std::sqrt(rest / all));
    scatters_.push_back(scatter_of(left, made, 1.0, counted_twice_));
    // A response function tells nothing of the noise of other records.
    result_.table.scatters.push_back(records_.front().force.empty()
                                         ? SensorScatter{.modal = std::sqrt(rest / modal)}
                                         : scatters_.back());
  }

  std::vector<StructureRecord> records_;
  std::vector<LateStrike> late_;
  const std::vector<SensorKind>& kinds_;
  const StrikeFitOptions& options_;
  std::vector<SensorScatter> scatters_;  // by which the bins weigh
  std::vector<BinWeights> weights_;      // by strike
  std::size_t bins_ = 0;                 // of all strikes
  double counted_twice_ = 1.0;           // of records of several lengths the most
  Eigen::VectorXd between_;              // how far the sensors pull ln f_n and ln ζ_n apart
  StrikeFit result_;
};

}  // namespace

StrikeFit fit_spectra(std::vector<StructureRecord> records, std::vector<ContourSpectra> spectra,
                      std::vector<LateStrike> late, const std::vector<SensorKind>& kinds,
                      const StrikeFitOptions& options) {
  return Fit(std::move(records), std::move(spectra), std::move(late), kinds, options).run();
}

}  // namespace modcal
