#include "libinverse/structure/pole_search.hpp"

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

PoleSearch::PoleSearch(const ContourSpectra& spectra, std::span<const double> force,
                       const std::vector<SensorKind>& kinds,
                       const std::vector<std::vector<double>>& weights)
    : spectra_(spectra), strike_(spectra, force), kinds_(kinds), weights_(weights) {
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    powers_[power_index(kinds[k])] = true;
    data_.push_back(weighted(k, spectra.responses[k]));
    Eigen::MatrixXd columns(data_[k].size(), kStatics);
    for (Index i = 0; i < kStatics; ++i) {
      std::vector<Complex> column(spectra.count());
      for (std::size_t m = 0; m < column.size(); ++m) {
        const Complex s = spectra.s(m);
        const Complex own = power_of_s(kinds[k]) == 0 ? 1.0 : power_of_s(kinds[k]) == 1 ? s : s * s;
        column[m] = own * (i == 0 ? 1.0 / (s * s) : 1.0) * spectra.force[m];
      }
      columns.col(i) = weighted(k, column);
    }
    static_.push_back(std::move(columns));
  }
}

Eigen::VectorXd PoleSearch::weighted(std::size_t k, const std::vector<Complex>& spectrum) const {
  const auto count = static_cast<Index>(spectrum.size());
  Eigen::VectorXd result(2 * count);
  for (Index m = 0; m < count; ++m) {
    const auto i = static_cast<std::size_t>(m);
    result[m] = weights_[k][i] * spectrum[i].real();
    result[m + count] = weights_[k][i] * spectrum[i].imag();
  }
  return result;
}

SensorFit PoleSearch::sensor_at(std::size_t k, const std::vector<Columns>& columns,
                                const std::vector<ModalPole>& poles) const {
  SensorFit fit;
  const Index modes = std::ssize(poles);
  fit.columns.resize(data_[k].size(), 2 * modes + kStatics);
  for (Index n = 0; n < modes; ++n) {
    const ColumnPair& pair = columns[static_cast<std::size_t>(n)][power_index(kinds_[k])];
    for (const std::size_t turned : {0, 1}) {
      fit.columns.col(2 * n + static_cast<Index>(turned)) = weighted(k, pair[turned]);
    }
  }
  fit.columns.rightCols(kStatics) = static_[k];
  fit.norms = fit.columns.colwise().norm();
  fit.columns.array().rowwise() /= fit.norms.transpose().array();
  Eigen::MatrixXd gram = products_of(fit.columns);
  gram.diagonal().array() += 1e-12;
  fit.gram.compute(gram);
  fit.amplitudes = fit.gram.solve(fit.columns.transpose() * data_[k]);
  fit.residual = data_[k] - fit.columns * fit.amplitudes;
  return fit;
}

std::vector<SensorFit> PoleSearch::at(const std::vector<ModalPole>& poles) const {
  std::vector<Columns> columns(poles.size());
  for_each_task(poles.size(), [&](std::size_t n) { columns[n] = strike_.of(poles[n], powers_); });
  std::vector<SensorFit> result(sensors());
  for_each_task(sensors(), [&](std::size_t k) { result[k] = sensor_at(k, columns, poles); });
  return result;
}

double PoleSearch::cost(const std::vector<ModalPole>& poles) const {
  double sum = 0.0;
  for (const SensorFit& fit : at(poles)) sum += fit.cost();
  return sum;
}

// Slopes of every sensor's residual by ln f and ln ζ of the modes.
std::vector<Eigen::MatrixXd> PoleSearch::jacobians(const std::vector<ModalPole>& poles,
                                                   const std::vector<SensorFit>& fits) const {
  // Where the errors of central differences by rounding and by curvature are alike; damping changes
  // a column by a hundredth of what a frequency does.
  const double near = std::cbrt(std::numeric_limits<double>::epsilon()), far = 100.0 * near;
  const Index unknowns = 2 * std::ssize(poles);
  std::vector<std::array<Columns, 4>> beside(poles.size());
  for_each_task(poles.size(), [&](std::size_t n) {
    beside[n] = {strike_.of(moved(poles[n], near, 0.0), powers_),
                 strike_.of(moved(poles[n], -near, 0.0), powers_),
                 strike_.of(moved(poles[n], 0.0, far), powers_),
                 strike_.of(moved(poles[n], 0.0, -far), powers_)};
  });
  std::vector<Eigen::MatrixXd> result(sensors());
  for_each_task(sensors(), [&](std::size_t k) {
    Eigen::MatrixXd slopes(data_[k].size(), unknowns);
    for (Index i = 0; i < unknowns; ++i) {
      const auto n = static_cast<std::size_t>(i / 2);
      const auto up = static_cast<std::size_t>(2 * (i % 2));
      const double step = 2.0 * (i % 2 == 0 ? near : far);
      slopes.col(i).setZero();
      for (const std::size_t turned : {0, 1}) {
        const Index at = 2 * static_cast<Index>(n) + static_cast<Index>(turned);
        const std::size_t p = power_index(kinds_[k]);
        slopes.col(i) +=
            fits[k].amplitudes[at] / fits[k].norms[at] / step *
            (weighted(k, beside[n][up][p][turned]) - weighted(k, beside[n][up + 1][p][turned]));
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

// Jᵀ r for noise of a deviation of 1 in every sample of a sensor, as columns over the samples. On a
// contour the noise dies away with exp(−σt), and J, the slope of what rings, is large later: to
// take a share κ of the bins for independent would double the variance.
Eigen::MatrixXd PoleSearch::noise_seen_by(std::size_t k, const Eigen::MatrixXd& slopes) const {
  const RealFft fft(spectra_.samples);
  const auto count = static_cast<Index>(spectra_.count());
  Eigen::MatrixXd result(static_cast<Index>(spectra_.samples), slopes.cols());
  for_each_task(static_cast<std::size_t>(slopes.cols()), [&](std::size_t i) {
    const auto at = static_cast<Index>(i);
    std::vector<Complex> spectrum(fft.bins());
    for (Index m = 0; m < count; ++m) {
      const auto bin = static_cast<std::size_t>(m);
      spectrum[spectra_.bins.first + bin] =
          weights_[k][bin] * Complex(slopes(m, at), slopes(m + count, at));
    }
    // Re Σ_m c_m exp(iω_m t): half of what a real signal of these bins has.
    fft.inverse(spectrum, {result.col(at).data(), spectra_.samples});
    result.col(at) *= 0.5 * static_cast<double>(spectra_.samples);
  });
  const double decay = std::exp(-spectra_.grid.sigma / spectra_.sample_rate);
  double left = 1.0;
  for (Index j = 0; j < result.rows(); ++j, left *= decay) result.row(j) *= left;
  return result;
}

Eigen::MatrixXd PoleSearch::covariance(const std::vector<ModalPole>& poles,
                                       const std::vector<Eigen::VectorXd>& variances,
                                       std::span<const double> noise) const {
  const std::vector<Eigen::MatrixXd> slopes = jacobians(poles, at(poles));
  const Index unknowns = 2 * std::ssize(poles);
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(unknowns, unknowns), spread = information;
  for (std::size_t k = 0; k < sensors(); ++k) {
    information += products_of(slopes[k]);
    // Real over imaginary parts.
    spread += slopes[k].transpose() * variances[k].replicate(2, 1).asDiagonal() * slopes[k];
    if (noise[k] == 0.0) continue;
    const Eigen::MatrixXd seen = noise_seen_by(k, slopes[k]);
    spread += noise[k] * noise[k] * (seen.transpose() * seen);
  }
  const Eigen::LDLT<Eigen::MatrixXd> solver(information);
  const Eigen::MatrixXd half = solver.solve(spread);
  return solver.solve(half.transpose());
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
      const Eigen::VectorXd change = -matrix.ldlt().solve(equations.slope);
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
