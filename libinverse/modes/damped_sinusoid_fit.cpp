#include "libinverse/modes/damped_sinusoid_fit.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "libinverse/modes/decay_hum.hpp"
#include "libsim/base/dense_solvers.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The poles as unknowns: (d_1, ν_1, d_2, ν_2, …) with λ = −d + iν.
class Problem {
 public:
  Problem(const DecayRecord& record, std::size_t poles, std::span<const double> lines)
      : rate_(record.sample_rate),
        poles_(static_cast<Index>(poles)),
        hum_(hum_columns(record.samples(), record.sample_rate, lines)),
        data_(static_cast<Index>(record.samples()), static_cast<Index>(record.channels.size())) {
    if (hum_.cols() > 0) hum_ = ThinQr(hum_).q();
    for (Index c = 0; c < data_.cols(); ++c) {
      for (Index m = 0; m < data_.rows(); ++m) {
        data_(m, c) = record.channels[static_cast<std::size_t>(c)][static_cast<std::size_t>(m)];
      }
    }
    data_ = beside_hum(std::move(data_));
  }

  Index samples() const { return data_.rows(); }
  Index channels() const { return data_.cols(); }
  Index poles() const { return poles_; }
  Index columns() const { return 2 * poles_ + 1 + hum_.cols(); }
  double degrees_of_freedom() const {
    const double shared = 2.0 * static_cast<double>(poles_) / static_cast<double>(channels());
    return static_cast<double>(samples() - columns()) - shared;
  }

  /// What is known at one set of poles.
  struct State {
    VectorXd poles;
    MatrixXd basis;         // exp(−dt) cos νt, exp(−dt) sin νt in turn, and 1
    MatrixXd thin_q;        // orthonormal basis of its columns, the hum projected out
    MatrixXd coefficients;  // per channel: a cos + b sin, so that A = a − ib
    MatrixXd residual;
  };

  State at(const VectorXd& poles) const {
    State state{.poles = poles, .basis = MatrixXd(samples(), 2 * poles_ + 1)};
    for (Index k = 0; k < poles_; ++k) fill_exponential(state, k);
    state.basis.col(2 * poles_).setOnes();
    const MatrixXd beside = beside_hum(state.basis);
    const ThinQr qr(beside);
    state.thin_q = qr.q();
    state.coefficients = qr.solve(data_);
    state.residual = data_ - beside * state.coefficients;
    return state;
  }

  /// Where no pole grows by more than e over the record: one that starts too broad would grow
  /// beyond all numbers, and the columns of the others would be rounding beside it.
  VectorXd bounded(VectorXd poles) const {
    const double least = -rate_ / static_cast<double>(samples());
    for (Index k = 0; k < poles_; ++k) poles[2 * k] = std::max(poles[2 * k], least);
    return poles;
  }

  /// Slopes of the residuals of one channel, over the projector that the linear unknowns leave.
  MatrixXd jacobian(const State& state, Index channel) const {
    MatrixXd slopes(samples(), 2 * poles_);
    for (Index k = 0; k < poles_; ++k) {
      const double a = state.coefficients(2 * k, channel);
      const double b = state.coefficients(2 * k + 1, channel);
      for (Index m = 0; m < samples(); ++m) {
        const double t = static_cast<double>(m) / rate_;
        const double cosine = state.basis(m, 2 * k);
        const double sine = state.basis(m, 2 * k + 1);
        slopes(m, 2 * k) = t * (a * cosine + b * sine);
        slopes(m, 2 * k + 1) = -t * (b * cosine - a * sine);
      }
    }
    slopes = beside_hum(std::move(slopes));
    slopes -= state.thin_q * (state.thin_q.transpose() * slopes);
    return slopes;
  }

 private:
  MatrixXd beside_hum(MatrixXd columns) const {
    if (hum_.cols() > 0) columns -= hum_ * (hum_.transpose() * columns);
    return columns;
  }

  // By recurrence in blocks, restarted so that rounding does not gather.
  void fill_exponential(State& state, Index k) const {
    const std::complex<double> exponent(-state.poles[2 * k], state.poles[2 * k + 1]);
    const std::complex<double> step = std::exp(exponent / rate_);
    std::complex<double> value = 1.0;
    constexpr Index kBlock = 32;
    for (Index m = 0; m < samples(); ++m) {
      value =
          m % kBlock == 0 ? std::exp(exponent * (static_cast<double>(m) / rate_)) : value * step;
      state.basis(m, 2 * k) = value.real();
      state.basis(m, 2 * k + 1) = value.imag();
    }
  }

  double rate_;
  Index poles_;
  MatrixXd hum_;  // orthonormal, of which nothing is left in data, columns and slopes
  MatrixXd data_;
};

VectorXd variances_of(const Problem& problem, const Problem::State& state) {
  VectorXd variances = state.residual.colwise().squaredNorm().transpose();
  variances /= std::max(1.0, problem.degrees_of_freedom());
  // Noise-free channels would weigh infinitely: rounding is their noise.
  const VectorXd data = (state.residual + state.basis * state.coefficients).colwise().squaredNorm();
  constexpr double kRounding = 1e-30;
  return variances.cwiseMax(kRounding * data / static_cast<double>(problem.samples()));
}

double cost_of(const Problem::State& state, const VectorXd& variances) {
  return (state.residual.colwise().squaredNorm().transpose().array() / variances.array()).sum();
}

/// Gauss–Newton step with its covariance for noise of the given variances.
std::optional<LeastSquares> step_at(const Problem& problem, const Problem::State& state,
                                    const VectorXd& variances) {
  const Index unknowns = 2 * problem.poles();
  MatrixXd slopes(problem.samples() * problem.channels(), unknowns);
  VectorXd residual(slopes.rows());
  for (Index c = 0; c < problem.channels(); ++c) {
    const double weight = 1.0 / std::sqrt(variances[c]);
    const Index first = c * problem.samples();
    slopes.middleRows(first, problem.samples()) = weight * problem.jacobian(state, c);
    residual.segment(first, problem.samples()) = weight * state.residual.col(c);
  }
  return least_squares(slopes, -residual);
}

// f = |λ|/2π and ζ = d/|λ| from (d, ν).
DecayPole deviation_of(double d, double nu, const Eigen::Matrix2d& covariance) {
  const double omega = std::hypot(d, nu);
  const Eigen::Vector2d frequency = Eigen::Vector2d(d, nu) / (2.0 * std::numbers::pi * omega);
  const Eigen::Vector2d ratio = Eigen::Vector2d(nu * nu, -d * nu) / (omega * omega * omega);
  return {std::sqrt(frequency.dot(covariance * frequency)),
          std::sqrt(ratio.dot(covariance * ratio))};
}

// aᵀ(RᵀR)_kk a over the channels, R⁻¹R⁻ᵀ the covariance of the linear unknowns.
std::vector<double> evidence_of(const Problem& problem, const Problem::State& state,
                                const VectorXd& variances) {
  const MatrixXd r = state.thin_q.transpose() * state.basis;
  const MatrixXd inverse =
      r.triangularView<Eigen::Upper>().solve(MatrixXd::Identity(r.rows(), r.cols()));
  std::vector<double> evidence;
  for (Index k = 0; k < problem.poles(); ++k) {
    const auto rows = inverse.middleRows(2 * k, 2);
    const Eigen::Matrix2d precision = Eigen::Matrix2d(rows * rows.transpose()).inverse();
    double sum = 0.0;
    for (Index c = 0; c < problem.channels(); ++c) {
      const Eigen::Vector2d a = state.coefficients.col(c).segment<2>(2 * k);
      sum += a.dot(precision * a) / variances[c];
    }
    evidence.push_back(std::isfinite(sum) ? sum : std::numeric_limits<double>::quiet_NaN());
  }
  return evidence;
}

std::vector<DecayMode> modes_of(const Problem& problem, const Problem::State& state,
                                const std::optional<LeastSquares>& step, double in_band_variance) {
  std::vector<DecayMode> modes;
  for (Index k = 0; k < problem.poles(); ++k) {
    const double d = state.poles[2 * k];
    const double nu = state.poles[2 * k + 1];
    DecayMode mode{.pole = DecayPole::of_exponent({-d, nu})};
    if (step) {
      mode.deviation =
          deviation_of(d, nu, in_band_variance * step->covariance.block<2, 2>(2 * k, 2 * k));
    }
    for (Index c = 0; c < problem.channels(); ++c) {
      mode.amplitude.emplace_back(state.coefficients(2 * k, c), -state.coefficients(2 * k + 1, c));
    }
    modes.push_back(std::move(mode));
  }
  return modes;
}

VectorXd start_values(std::span<const DecayPole> start, double rate) {
  VectorXd poles(2 * static_cast<Index>(start.size()));
  for (std::size_t k = 0; k < start.size(); ++k) {
    MODCAL_REQUIRE(start[k].damping_ratio > 0.0 && start[k].damping_ratio < 1.0 &&
                       start[k].frequency > 0.0 && start[k].frequency < 0.5 * rate,
                   "a pole at {:g} Hz with damping ratio {:g} cannot start a fit: frequencies lie "
                   "in (0, {:g}) Hz and ratios in (0, 1)",
                   start[k].frequency, start[k].damping_ratio, 0.5 * rate);
    const auto exponent = start[k].exponent();
    poles[2 * static_cast<Index>(k)] = -exponent.real();
    poles[2 * static_cast<Index>(k) + 1] = exponent.imag();
  }
  return poles;
}

}  // namespace

DampedSinusoidFit fit_damped_sinusoids(const DecayRecord& record, std::span<const DecayPole> start,
                                       const DampedSinusoidOptions& options) {
  record.require_valid();
  MODCAL_REQUIRE(!start.empty(), "a fit without poles: find some first");
  const Problem problem(record, start.size(), options.lines);
  MODCAL_REQUIRE(problem.degrees_of_freedom() >= 1.0,
                 "{} samples a channel cannot determine {} modes: take a longer record",
                 problem.samples(), problem.poles());
  DampedSinusoidFit fit;
  Problem::State state = problem.at(start_values(start, record.sample_rate));
  VectorXd variances = variances_of(problem, state);
  std::optional<LeastSquares> step = step_at(problem, state, variances);
  while (step && !fit.converged && fit.iterations < options.iterations) {
    ++fit.iterations;
    const VectorXd deviations = step->covariance.diagonal().cwiseSqrt();
    const double size = step->solution.cwiseQuotient(deviations).lpNorm<Eigen::Infinity>();
    const double cost = cost_of(state, variances);
    double share = 1.0;
    constexpr double kSmallest = 1e-6;
    while (share > kSmallest) {
      Problem::State next = problem.at(problem.bounded(state.poles + share * step->solution));
      if (next.poles.allFinite() && cost_of(next, variances) <= cost) {
        state = std::move(next);
        break;
      }
      share *= 0.5;
    }
    // Without noise deviations are rounding, and so are the last steps.
    constexpr double kRounding = 1e-12;
    const bool rounding = step->solution.lpNorm<Eigen::Infinity>() <=
                          kRounding * state.poles.lpNorm<Eigen::Infinity>();
    fit.converged = size <= options.tolerance || rounding || share <= kSmallest;
    variances = variances_of(problem, state);
    step = step_at(problem, state, variances);
  }
  fit.full_rank = step.has_value();
  fit.modes = modes_of(problem, state, step, options.in_band_variance);
  fit.evidence = evidence_of(problem, state, options.in_band_variance * variances);
  for (const double variance : variances) fit.noise.push_back(std::sqrt(variance));
  for (const auto channel : state.residual.colwise()) fit.squares.push_back(channel.squaredNorm());
  return fit;
}

}  // namespace modcal
