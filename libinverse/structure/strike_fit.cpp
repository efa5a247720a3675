#include "libinverse/structure/strike_fit.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "libinverse/structure/pole_search.hpp"
#include "libinverse/structure/strike_weights.hpp"
#include "libinverse/structure/tuning.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

using Index = Eigen::Index;

class Fit {
 public:
  Fit(const StructureRecord& record, const std::vector<SensorKind>& kinds,
      const StrikeFitOptions& options)
      : record_(record), kinds_(kinds), options_(options) {
    const double sigma = std::isnan(options.sigma)
                             ? std::min(20.0 / record.duration(), options.high / 50.0)
                             : options.sigma;
    // What comes later has a part of e^−12 in the power, and the columns know of the end.
    const auto count = static_cast<std::size_t>(6.0 / sigma * record.sample_rate);
    if (count < record.samples()) {
      record_.force.resize(count);
      for (std::vector<double>& response : record_.responses) response.resize(count);
    }
    result_.spectra = ContourSpectra::of(record_, sigma, options.low, options.high);
  }
  Fit(const ContourSpectra& spectra, const std::vector<SensorKind>& kinds,
      const StrikeFitOptions& options)
      : kinds_(kinds), options_(options) {
    result_.spectra = spectra;
  }

  StrikeFit run() {
    weights_ = weights_of(result_.spectra, options_.relative_error);
    PoleSearch search(result_.spectra, record_.force, kinds_, weights_);
    std::vector<ModalPole> poles, best;
    double least = std::numeric_limits<double>::infinity();
    while (poles.size() < options_.most_modes && parameters(poles.size() + 1) < 0.75 * numbers()) {
      poles.push_back(search.best_addition(poles));
      const double cost = search.fit(poles, 3);
      const double told = parameters(poles.size());
      const double criterion =
          numbers() * std::log(cost / counted_twice() / numbers()) + told * std::log(numbers());
      result_.steps.push_back({.modes = poles.size(),
                               .misfit = cost / counted_twice() / (numbers() - told),
                               .criterion = criterion,
                               .poles = poles});
      if (criterion < least) least = criterion, best = poles;
      if (poles.size() > best.size() + 3) break;
    }
    MODCAL_REQUIRE(!best.empty(),
                   "the record tells {:.3g} numbers in its band, a mode takes {:g}: state a wider "
                   "band or a smaller contour",
                   numbers(), parameters(1));
    const double cost = search.fit(best, 30);
    result_.misfit = cost / counted_twice() / (numbers() - parameters(best.size()));
    tell(search, best);
    // Now the residuals say how right a bin is: twice, as they depend on it.
    for (int round = 0; round < 2; ++round) {
      weights_ = weights_of(result_.spectra, result_.table.model, scatters_);
      const PoleSearch again(result_.spectra, record_.force, kinds_, weights_);
      again.fit(best, 30);
      std::ranges::sort(best, {}, &ModalPole::omega);
      tell(again, best);
      if (round == 1) tell_deviations(again, best);
    }
    tell_pulse();
    return std::move(result_);
  }

 private:
  // Bins that tell alike count as one; of real and imaginary part each.
  double numbers() const {
    return 2.0 * static_cast<double>(result_.spectra.count() * kinds_.size()) /
           result_.spectra.correlated();
  }
  double counted_twice() const { return result_.spectra.correlated(); }
  double parameters(std::size_t modes) const {
    const auto n = static_cast<double>(modes), k = static_cast<double>(kinds_.size());
    return n * (2.0 + 2.0 * k) + 2.0 * k;
  }

  // |G| of the largest pulse, ten periods of the band's top to either side of its peak, fading out.
  void tell_pulse() {
    const std::vector<double>& force = record_.force;
    if (force.empty()) return;
    const auto larger = [](double a, double b) { return std::abs(a) < std::abs(b); };
    const auto peak = std::max_element(force.begin(), force.end(), larger) - force.begin();
    const auto reach = static_cast<std::ptrdiff_t>(10.0 * record_.sample_rate / options_.high);
    const RealFft fft(static_cast<std::size_t>(4 * reach));
    std::vector<double> pulse(fft.length(), 0.0);
    for (std::ptrdiff_t j = -reach; j <= reach; ++j) {
      if (peak + j < 0 || peak + j >= std::ssize(force)) continue;
      const double fading = std::cos(0.5 * std::numbers::pi * static_cast<double>(j) /
                                     (static_cast<double>(reach) + 1.0));
      pulse[static_cast<std::size_t>(j + reach)] =
          fading * fading * force[static_cast<std::size_t>(peak + j)];
    }
    const std::vector<Complex> spectrum = fft.forward(pulse);
    StructureTable& table = result_.table;
    table.lag = record_.sample_rate / static_cast<double>(fft.length());
    for (const Complex& g : spectrum) {
      table.pulse.push_back(std::abs(g) / std::max(std::abs(spectrum[0]), 1e-300));
    }
  }

  void tell(const PoleSearch& search, const std::vector<ModalPole>& poles) {
    StructureTable& table = result_.table;
    const std::size_t modes = poles.size();
    result_.residuals.clear();
    result_.modeled.clear();
    table.scatters.clear();
    scatters_.clear();
    table.low = options_.low, table.high = options_.high;
    table.model = {.poles = poles, .sensors = kinds_};
    const std::vector<SensorFit> fits = search.at(poles);
    for (std::size_t k = 0; k < kinds_.size(); ++k) {
      const Eigen::VectorXd x = fits[k].amplitudes.cwiseQuotient(fits[k].norms);
      for (std::size_t n = 0; n < modes; ++n) {
        const double scale = std::pow(poles[n].omega, 2 - power_of_s(kinds_[k]));
        table.model.constants.push_back(scale * x[static_cast<Index>(2 * n)]);
        table.model.quadrature.push_back(scale * x[static_cast<Index>(2 * n + 1)]);
      }
      const auto first = static_cast<Index>(2 * modes);
      table.model.residuals.push_back({.below = x[first], .constant = x[first + 1]});
      tell_rest(k, fits[k]);
    }
  }

  // By what scatter and noise expect of the residuals: a share of the response everywhere, as the
  // weights have it, would make a sharp resonance as uncertain as its flanks.
  void tell_deviations(const PoleSearch& search, const std::vector<ModalPole>& poles) {
    const ContourSpectra& spectra = result_.spectra;
    StructureTable& table = result_.table;
    // Unknowns took their share of the residuals.
    const double share = numbers() / (numbers() - parameters(poles.size()));
    std::vector<Eigen::VectorXd> variances;
    std::vector<double> noise;
    for (std::size_t k = 0; k < kinds_.size(); ++k) {
      noise.push_back(scatters_[k].noise * std::sqrt(share));
      Eigen::VectorXd& own = variances.emplace_back(static_cast<Index>(spectra.count()));
      const std::vector<double> made = made_by_modes(spectra, table.model, k);
      for (std::size_t m = 0; m < spectra.count(); ++m) {
        const double off = scatters_[k].modal * weights_[k][m];
        own[static_cast<Index>(m)] = 0.5 * share * counted_twice() * off * off * made[m];
      }
    }
    const Eigen::MatrixXd covariance = search.covariance(poles, variances, noise);
    for (std::size_t n = 0; n < poles.size(); ++n) {
      const auto i = static_cast<Index>(2 * n);
      MODCAL_REQUIRE(covariance(i, i) >= 0.0 && covariance(i + 1, i + 1) >= 0.0,
                     "nothing tells the mode at {:g} Hz from the others: state a narrower band or "
                     "fewer modes",
                     table.frequency(n));
      table.frequency_deviations.push_back(std::sqrt(covariance(i, i)));
      table.damping_deviations.push_back(std::sqrt(covariance(i + 1, i + 1)));
    }
  }

  void tell_rest(std::size_t k, const SensorFit& fit) {
    const ContourSpectra& spectra = result_.spectra;
    const ModalModel& model = result_.table.model;
    std::vector<double> left;
    const std::vector<double> modal = made_by_modes(spectra, model, k);
    std::vector<Complex>& modeled = result_.modeled.emplace_back();
    double rest = 0.0;
    for (std::size_t m = 0; m < spectra.count(); ++m) {
      const auto i = static_cast<Index>(m), count = static_cast<Index>(spectra.count());
      const Complex residual = Complex(fit.residual[i], fit.residual[i + count]) / weights_[k][m];
      modeled.push_back(spectra.responses[k][m] - residual);
      left.push_back(std::norm(residual));
      rest += std::norm(residual);
    }
    result_.residuals.push_back(
        std::sqrt(rest / static_cast<double>(left.size()) / mean_power(spectra.responses[k])));
    scatters_.push_back(scatter_of(left, modal, spectra.noise_power(), counted_twice()));
    // A response function tells nothing of the noise of other records.
    const double share = rest / std::accumulate(modal.begin(), modal.end(), 0.0);
    result_.table.scatters.push_back(
        record_.force.empty() ? SensorScatter{.modal = std::sqrt(share)} : scatters_.back());
  }

  StructureRecord record_;
  const std::vector<SensorKind>& kinds_;
  const StrikeFitOptions& options_;
  std::vector<SensorScatter> scatters_;  // by which the bins weigh
  BinWeights weights_;
  StrikeFit result_;
};

}  // namespace

bool stays(const ModalPole& pole, std::span<const ModalPole> others) {
  return std::ranges::any_of(others, [&](const ModalPole& other) {
    return std::abs(other.omega - pole.omega) < 0.01 * pole.omega &&
           std::abs(other.zeta - pole.zeta) < 0.2 * pole.zeta;
  });
}

std::string StrikeFit::rejection() const {
  const double most = std::ranges::max(residuals);
  if (most <= 0.5) return {};
  return fmt::format(
      "rejected: the modes leave {:.0f} % of a response: compare the channels and their units, and "
      "whether the structure rests when the record begins; a smaller contour tells more modes",
      100.0 * most);
}

std::string StrikeFit::without_damping() const {
  for (std::size_t n = 0; n < table.model.poles.size(); ++n) {
    if (table.model.poles[n].zeta > 1.01 * kLeastDampingRatio) continue;
    return fmt::format("rejected: no damping is left of the mode at {:.5g} Hz", table.frequency(n));
  }
  return {};
}

StrikeFit fit_strike(const StructureRecord& record, const std::vector<SensorKind>& kinds,
                     const StrikeFitOptions& options) {
  MODCAL_REQUIRE(!record.force.empty(),
                 "modes from a strike need the force of {} record: name its channel", 1);
  MODCAL_REQUIRE(kinds.size() == record.responses.size(), "{} kinds of sensors for {} responses",
                 kinds.size(), record.responses.size());
  return Fit(record, kinds, options).run();
}

StrikeFit fit_response(const MeasuredFunctions& measured, const StrikeFitOptions& options) {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  const FrequencyGrid& grid = measured.grid;
  MODCAL_REQUIRE(measured.sessions.size() == 1,
                 "modes are fitted to one session of response functions, not to {}: what changes "
                 "between sessions moves whole resonances",
                 measured.sessions.size());
  const Transfers& response = measured.sessions.front();
  MODCAL_REQUIRE(!response.empty() && measured.sensors.size() == response.size(),
                 "{} kinds of sensors for {} response functions", measured.sensors.size(),
                 response.size());
  ContourSpectra spectra{.grid = grid,
                         .bins = bins_between(grid, kTurn * options.low, kTurn * options.high)};
  spectra.samples = 2 * (grid.bins - 1);
  spectra.sample_rate = static_cast<double>(spectra.samples) * grid.spacing / kTurn;
  MODCAL_REQUIRE(spectra.count() > 0, "no line of the response lies from {:g} Hz to {:g} Hz",
                 options.low, options.high);
  spectra.force.assign(spectra.count(), 1.0);
  for (std::size_t k = 0; k < response.size(); ++k) {
    MODCAL_REQUIRE(response[k].size() == grid.bins, "response {} has {} lines in the place of {}",
                   k + 1, response[k].size(), grid.bins);
    const auto first = response[k].begin() + static_cast<std::ptrdiff_t>(spectra.bins.first);
    spectra.responses.emplace_back(first, first + static_cast<std::ptrdiff_t>(spectra.count()));
    for (std::size_t m = 0; m < spectra.count(); ++m) {
      const Complex h = spectra.responses.back()[m];
      MODCAL_REQUIRE(std::isfinite(h.real()) && std::isfinite(h.imag()),
                     "response {} is not finite at {:g} Hz: leave that line out of the band", k + 1,
                     spectra.s(m).imag() / kTurn);
    }
  }
  return Fit(spectra, measured.sensors, options).run();
}

}  // namespace modcal
