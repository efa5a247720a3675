#include "libinverse/structure/strikes/pole_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libinverse/structure/tuning.hpp"
#include "libsim/base/task_loop.hpp"

namespace modcal {
namespace {

using Index = Eigen::Index;

// Steps of a fit are small against a mode's width and what damping may be off.
constexpr double kFrequencyStep = 0.02, kDampingStep = 0.5;

ModalPole moved(const ModalPole& pole, double frequency, double damping) {
  return {.omega = pole.omega * std::exp(frequency),
          .zeta = std::clamp(pole.zeta * std::exp(damping), kLeastDampingRatio, kMostDampingRatio)};
}

// AᵀA; half of it is calculated.
Eigen::MatrixXd products_of(const Eigen::MatrixXd& columns) {
  Eigen::MatrixXd half = Eigen::MatrixXd::Zero(columns.cols(), columns.cols());
  half.selfadjointView<Eigen::Lower>().rankUpdate(columns.transpose());
  return half.selfadjointView<Eigen::Lower>();
}

}  // namespace

PoleSearch::PoleSearch(std::span<const SearchedStrike> strikes,
                       const std::vector<SensorKind>& kinds, double grid_numbers)
    : grid_numbers_(grid_numbers), kinds_(kinds) {
  for (const SearchedStrike& strike : strikes) {
    strikes_.push_back({.spectra = strike.spectra,
                        .columns = StrikeColumns(strike.spectra, strike.force),
                        .weights = strike.weights,
                        .first = rows_});
    rows_ += strikes_.back().rows();
  }
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    powers_[power_index(kinds[k])] = true;
    data_.emplace_back(rows_);
    static_.emplace_back(rows_, kStatics);
    for (const Strike& strike : strikes_) {
      const ContourSpectra& spectra = strike.spectra;
      weigh(strike, k, spectra.responses[k], data_[k]);
      for (Index i = 0; i < kStatics; ++i) {
        std::vector<Complex> column(spectra.count());
        for (std::size_t m = 0; m < column.size(); ++m) {
          const Complex s = spectra.s(m);
          const int p = power_of_s(kinds[k]);
          const Complex own = p == 0 ? 1.0 : p == 1 ? s : s * s;
          column[m] = own * (i == 0 ? 1.0 / (s * s) : 1.0) * spectra.force[m];
        }
        weigh(strike, k, column, static_[k].col(i));
      }
    }
  }
}

void PoleSearch::weigh(const Strike& strike, std::size_t k, const std::vector<Complex>& spectrum,
                       Eigen::Ref<Eigen::VectorXd> rows) const {
  const auto count = static_cast<Index>(spectrum.size());
  for (Index m = 0; m < count; ++m) {
    const auto i = static_cast<std::size_t>(m);
    rows[strike.first + m] = strike.weights[k][i] * spectrum[i].real();
    rows[strike.first + m + count] = strike.weights[k][i] * spectrum[i].imag();
  }
}

PoleSearch::Columns PoleSearch::columns_of(const ModalPole& pole) const {
  Columns columns;
  for (const Strike& strike : strikes_) columns.push_back(strike.columns.of(pole, powers_));
  return columns;
}

Eigen::VectorXd PoleSearch::weighted(std::size_t k, const Columns& columns, bool turned) const {
  Eigen::VectorXd rows(rows_);
  for (std::size_t i = 0; i < strikes_.size(); ++i) {
    weigh(strikes_[i], k, columns[i][power_index(kinds_[k])][turned ? 1 : 0], rows);
  }
  return rows;
}

SensorFit PoleSearch::sensor_at(std::size_t k, const std::vector<Columns>& columns,
                                const std::vector<ModalPole>& poles) const {
  SensorFit fit;
  const Index modes = std::ssize(poles);
  fit.columns.resize(data_[k].size(), 2 * modes + kStatics);
  for (Index n = 0; n < modes; ++n) {
    for (const bool turned : {false, true}) {
      fit.columns.col(2 * n + (turned ? 1 : 0)) =
          weighted(k, columns[static_cast<std::size_t>(n)], turned);
    }
  }
  fit.columns.rightCols(kStatics) = static_[k];
  fit.norms = fit.columns.colwise().norm();
  fit.columns.array().rowwise() /= fit.norms.transpose().array();
  Eigen::MatrixXd gram = products_of(fit.columns);
  gram.diagonal().array() += 1e-12;
  fit.gram = SemidefiniteSolver(gram);
  fit.amplitudes = fit.gram.solve(fit.columns.transpose() * data_[k]);
  fit.residual = data_[k] - fit.columns * fit.amplitudes;
  return fit;
}

std::vector<SensorFit> PoleSearch::at(const std::vector<ModalPole>& poles) const {
  std::vector<Columns> columns(poles.size());
  for_each_task(poles.size(), [&](std::size_t n) { columns[n] = columns_of(poles[n]); });
  std::vector<SensorFit> result(sensors());
  for_each_task(sensors(), [&](std::size_t k) { result[k] = sensor_at(k, columns, poles); });
  return result;
}

double PoleSearch::cost(const std::vector<ModalPole>& poles) const {
  double sum = 0.0;
  for (const SensorFit& fit : at(poles)) sum += fit.cost();
  return sum;
}

std::vector<Eigen::MatrixXd> PoleSearch::jacobians(const std::vector<ModalPole>& poles,
                                                   const std::vector<SensorFit>& fits) const {
  // Where the errors of central differences by rounding and by curvature are alike; damping changes
  // a column by a hundredth of what a frequency does.
  const double near = std::cbrt(std::numeric_limits<double>::epsilon()), far = 100.0 * near;
  const Index unknowns = 2 * std::ssize(poles);
  std::vector<std::array<Columns, 4>> beside(poles.size());
  for_each_task(poles.size(), [&](std::size_t n) {
    beside[n] = {columns_of(moved(poles[n], near, 0.0)), columns_of(moved(poles[n], -near, 0.0)),
                 columns_of(moved(poles[n], 0.0, far)), columns_of(moved(poles[n], 0.0, -far))};
  });
  std::vector<Eigen::MatrixXd> result(sensors());
  for_each_task(sensors(), [&](std::size_t k) {
    Eigen::MatrixXd slopes(data_[k].size(), unknowns);
    for (Index i = 0; i < unknowns; ++i) {
      const auto n = static_cast<std::size_t>(i / 2);
      const auto up = static_cast<std::size_t>(2 * (i % 2));
      const double step = 2.0 * (i % 2 == 0 ? near : far);
      slopes.col(i).setZero();
      for (const bool turned : {false, true}) {
        const Index at = 2 * static_cast<Index>(n) + (turned ? 1 : 0);
        slopes.col(i) +=
            fits[k].amplitudes[at] / fits[k].norms[at] / step *
            (weighted(k, beside[n][up], turned) - weighted(k, beside[n][up + 1], turned));
      }
    }
    result[k] = -fits[k].project(slopes);
  });
  return result;
}

PoleSearch::Equations PoleSearch::equations(const std::vector<ModalPole>& poles) const {
  const std::vector<SensorFit> fits = at(poles);
  const std::vector<Eigen::MatrixXd> slopes = jacobians(poles, fits);
  const Index unknowns = 2 * std::ssize(poles);
  std::vector<Equations> parts(sensors());
  for_each_task(sensors(), [&](std::size_t k) {
    parts[k] = {products_of(slopes[k]), slopes[k].transpose() * fits[k].residual};
  });
  Equations sum{Eigen::MatrixXd::Zero(unknowns, unknowns), Eigen::VectorXd::Zero(unknowns)};
  for (const Equations& part : parts) {
    sum.matrix += part.matrix;
    sum.slope += part.slope;
  }
  return sum;
}

namespace {

// Jᵀ r for noise of a deviation of 1 in every sample, J as complex numbers at the bins, as columns
// over the samples. On a contour the noise dies away with exp(−σt), and J, the slope of what rings,
// is large later: to take a share κ of the bins for independent would double the variance.
Eigen::MatrixXd noise_seen_by(const ContourSpectra& spectra, const Eigen::MatrixXcd& slopes) {
  const RealFft fft(spectra.samples);
  Eigen::MatrixXd result(static_cast<Index>(spectra.samples), slopes.cols());
  for_each_task(static_cast<std::size_t>(slopes.cols()), [&](std::size_t i) {
    const auto at = static_cast<Index>(i);
    std::vector<Complex> spectrum(fft.bins());
    std::ranges::copy(slopes.col(at),
                      spectrum.begin() + static_cast<std::ptrdiff_t>(spectra.bins.first));
    // Re Σ_m c_m exp(iω_m t): half of what a real signal of these bins has.
    fft.inverse(spectrum, {result.col(at).data(), spectra.samples});
    result.col(at) *= 0.5 * static_cast<double>(spectra.samples);
  });
  const double decay = std::exp(-spectra.grid.sigma / spectra.sample_rate);
  double left = 1.0;
  for (Index j = 0; j < result.rows(); ++j, left *= decay) result.row(j) *= left;
  return result;
}

}  // namespace

Eigen::MatrixXcd PoleSearch::weighted_slopes(const Strike& strike, std::size_t k,
                                             const Eigen::MatrixXd& slopes) const {
  const auto count = static_cast<Index>(strike.spectra.count());
  Eigen::MatrixXcd result(count, slopes.cols());
  result.real() = slopes.middleRows(strike.first, count);
  result.imag() = slopes.middleRows(strike.first + count, count);
  const Eigen::Map<const Eigen::VectorXd> weights(strike.weights[k].data(), count);
  return weights.asDiagonal() * result;
}

Eigen::MatrixXd PoleSearch::covariance(const std::vector<Eigen::MatrixXd>& slopes,
                                       const std::vector<Eigen::VectorXd>& variances,
                                       std::span<const double> noise,
                                       const ForceNoise& force) const {
  const Index unknowns = slopes.front().cols();
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(unknowns, unknowns), spread = information;
  const auto add = [&spread](double deviation, const Eigen::MatrixXd& seen) {
    spread += deviation * deviation * (seen.transpose() * seen);
  };
  for (const Eigen::MatrixXd& own : slopes) information += products_of(own);
  for (std::size_t i = 0; i < strikes_.size(); ++i) {
    const Strike& strike = strikes_[i];
    const auto count = static_cast<Index>(strike.spectra.count());
    Eigen::MatrixXcd of_force = Eigen::MatrixXcd::Zero(count, unknowns);
    for (std::size_t k = 0; k < sensors(); ++k) {
      const auto own = slopes[k].middleRows(strike.first, 2 * count);
      const auto variance = variances[k].segment(strike.first / 2, count);
      spread += own.transpose() * variance.replicate(2, 1).asDiagonal() * own;
      if (noise[k] == 0.0 && force.deviation == 0.0) continue;
      const Eigen::MatrixXcd weighted = weighted_slopes(strike, k, slopes[k]);
      if (noise[k] > 0.0) add(noise[k], noise_seen_by(strike.spectra, weighted));
      if (force.deviation == 0.0) continue;
      const Eigen::Map<const Eigen::VectorXcd> transfer(force.transfers[i][k].data(), count);
      of_force += transfer.conjugate().asDiagonal() * weighted;
    }
    if (force.deviation > 0.0) add(force.deviation, noise_seen_by(strike.spectra, of_force));
  }
  const SemidefiniteSolver solver(information);
  const Eigen::MatrixXd half = solver.solve(spread);
  return solver.solve(half.transpose());
}

Eigen::VectorXd PoleSearch::variance_between(const std::vector<Eigen::MatrixXd>& slopes,
                                             const std::vector<SensorFit>& fits) const {
  Eigen::MatrixXd information = products_of(slopes.front());
  for (std::size_t k = 1; k < sensors(); ++k) information += products_of(slopes[k]);
  const SemidefiniteSolver solver(information);
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(information.rows());
  for (std::size_t k = 0; k < sensors(); ++k) {
    sum += solver.solve(slopes[k].transpose() * fits[k].residual).cwiseAbs2();
  }
  return sum;
}

double PoleSearch::fit(std::vector<ModalPole>& poles, int steps) const {
  double here = cost(poles), damping = 1e-3;
  for (int step = 0; step < steps; ++step) {
    const Equations equations = this->equations(poles);
    bool better = false;
    for (int round = 0; round < 8 && !better; ++round) {
      Eigen::MatrixXd matrix = equations.matrix;
      matrix.diagonal() *= 1.0 + damping;
      matrix.diagonal().array() += 1e-12 * matrix.diagonal().maxCoeff();
      const Eigen::VectorXd change = -SemidefiniteSolver(matrix).solve(equations.slope);
      std::vector<ModalPole> next = poles;
      for (std::size_t n = 0; n < poles.size(); ++n) {
        const auto i = static_cast<Index>(2 * n);
        next[n] = moved(poles[n], std::clamp(change[i], -kFrequencyStep, kFrequencyStep),
                        std::clamp(change[i + 1], -kDampingStep, kDampingStep));
      }
      const double there = cost(next);
      better = there < here;
      damping = better ? 0.1 * damping : 10.0 * damping;
      if (!better) continue;
      const double gain = here - there;
      poles = std::move(next);
      here = there;
      if (gain < 1e-7 * here) return here;
    }
    if (!better) break;
  }
  return here;
}

}  // namespace modcal
