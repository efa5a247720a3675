#include "libinverse/structure/strikes/force_noise.hpp"

#include <algorithm>
#include <cmath>

#include "libinverse/structure/bin_evidence.hpp"
#include "libinverse/structure/strikes/tuning.hpp"
#include "libsim/base/random.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

using Index = Eigen::Index;

class CommonNoise {
 public:
  CommonNoise(std::span<const FittedStrike> strikes, std::span<const BinWeights> weights,
              const ModalModel& model, std::span<const SensorFit> fits,
              std::span<const Eigen::MatrixXd> slopes)
      : strikes_(strikes), weights_(weights), fits_(fits), slopes_(slopes) {
    for (const FittedStrike& strike : strikes) {
      transfers_.push_back(transfers_of(model, strike.spectra));
    }
  }

  // quiet: what the forces read while nothing strikes [N].
  ForceNoise found(double quiet) const {
    ForceNoise result{.deviation = quiet, .transfers = transfers_};
    if (fits_.size() < 2) return result;
    std::vector<Eigen::VectorXd> residuals;
    for (const SensorFit& fit : fits_) residuals.push_back(fit.residual);
    const double alike = alike_in(residuals), least = 3.0 * std::sqrt(chance());
    if (!(alike > least) && quiet == 0.0) return result;
    double expected = 0.0;
    for (std::uint64_t draw = 0; draw < kForceNoiseDraws; ++draw) expected += alike_in(drawn(draw));
    if (!(expected > 0.0)) return result;
    const double most =
        std::sqrt(std::max(alike, least) * static_cast<double>(kForceNoiseDraws) / expected);
    result.deviation = alike > least ? most : std::min(quiet, most);
    return result;
  }

 private:
  // Calls visit(strike, bin, row of the real part, that of the imaginary part).
  template <typename Visit>
  void for_each_bin(const Visit& visit) const {
    Index first = 0;
    for (std::size_t i = 0; i < strikes_.size(); ++i) {
      const auto count = static_cast<Index>(strikes_[i].spectra.count());
      for (Index m = 0; m < count; ++m)
        visit(i, static_cast<std::size_t>(m), first + m, first + m + count);
      first += 2 * count;
    }
  }

  // Σ over bins and pairs of sensors, of rows that are divided by σ_k: (|Σ a|² − Σ |a|²)/2.
  double alike_in(const std::vector<Eigen::VectorXd>& rows) const {
    double alike = 0.0;
    for_each_bin([&](std::size_t i, std::size_t m, Index re, Index im) {
      Complex sum;
      double squares = 0.0;
      for (std::size_t k = 0; k < fits_.size(); ++k) {
        const Complex own =
            weights_[i][k][m] * std::conj(transfers_[i][k][m]) * Complex(rows[k][re], rows[k][im]);
        sum += own;
        squares += std::norm(own);
      }
      alike += 0.5 * (std::norm(sum) - squares);
    });
    return alike;
  }

  // Variance of that sum for residuals of σ_k that are not alike: half of Σ |H_k H_l|²/(σ_k σ_l)².
  double chance() const {
    double sum = 0.0;
    for_each_bin([&](std::size_t i, std::size_t m, Index, Index) {
      double told = 0.0, squares = 0.0;
      for (std::size_t k = 0; k < fits_.size(); ++k) {
        const double own = std::norm(weights_[i][k][m] * transfers_[i][k][m]);
        told += own;
        squares += own * own;
      }
      sum += 0.25 * strikes_[i].spectra.correlated() * (told * told - squares);
    });
    return sum;
  }

  // What noise of 1 N leaves of every sensor beside its columns.
  std::vector<Eigen::VectorXd> drawn(std::uint64_t draw) const {
    std::vector<Eigen::VectorXd> rows(fits_.size(), Eigen::VectorXd(fits_.front().residual.size()));
    std::vector<std::vector<Complex>> noise;
    for (std::size_t i = 0; i < strikes_.size(); ++i) {
      const ContourSpectra& spectra = strikes_[i].spectra;
      std::vector<double> samples(spectra.samples);
      fill_standard_normal(StreamKey(draw).with("force noise").with(i), samples);
      for (std::size_t j = 0; j < samples.size(); ++j) {
        samples[j] *= std::exp(-spectra.grid.sigma * static_cast<double>(j) / spectra.sample_rate);
      }
      noise.push_back(RealFft(spectra.samples).forward(samples));
    }
    for_each_bin([&](std::size_t i, std::size_t m, Index re, Index im) {
      for (std::size_t k = 0; k < fits_.size(); ++k) {
        const Complex own =
            weights_[i][k][m] * transfers_[i][k][m] * noise[i][strikes_[i].spectra.bins.first + m];
        rows[k][re] = own.real(), rows[k][im] = own.imag();
      }
    });
    take_unknowns(rows);
    return rows;
  }

  // Columns of each sensor, and poles of all.
  void take_unknowns(std::vector<Eigen::VectorXd>& rows) const {
    const Index poles = slopes_.front().cols();
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(poles, poles);
    Eigen::VectorXd score = Eigen::VectorXd::Zero(poles);
    for (std::size_t k = 0; k < fits_.size(); ++k) {
      rows[k] = fits_[k].project(rows[k]);
      matrix += slopes_[k].transpose() * slopes_[k];
      score += slopes_[k].transpose() * rows[k];
    }
    const Eigen::VectorXd change = SemidefiniteSolver(matrix).solve(score);
    for (std::size_t k = 0; k < fits_.size(); ++k) rows[k] -= slopes_[k] * change;
  }

  std::span<const FittedStrike> strikes_;
  std::span<const BinWeights> weights_;
  std::span<const SensorFit> fits_;
  std::span<const Eigen::MatrixXd> slopes_;
  std::vector<Transfers> transfers_;  // by strike
};

}  // namespace

double quiet_level(std::span<const double> force) {
  const std::size_t length = force.size() / kQuietParts;
  if (length < 2) return 0.0;
  std::vector<double> deviations;
  for (std::size_t i = 0; i < kQuietParts; ++i) {
    deviations.push_back(standard_deviation(force.subspan(i * length, length)));
  }
  const double level = quantile(std::move(deviations), 0.25);
  return level < kQuietShare * largest_magnitude(force) ? level : 0.0;
}

ForceNoise force_noise_of(std::span<const StructureRecord> records,
                          std::span<const FittedStrike> strikes,
                          std::span<const BinWeights> weights, const ModalModel& model,
                          std::span<const SensorFit> fits,
                          std::span<const Eigen::MatrixXd> slopes) {
  double quiet = 0.0;
  for (const StructureRecord& record : records) quiet = std::max(quiet, quiet_level(record.force));
  return CommonNoise(strikes, weights, model, fits, slopes).found(quiet);
}

}  // namespace modcal
