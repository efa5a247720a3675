#include "libinverse/modes/damped_sinusoid_fit.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "libinverse/modes/damped_sinusoid_problem.hpp"
#include "libinverse/modes/tuning.hpp"
#include "libsim/base/dense_solvers.hpp"
#include "libsim/base/error.hpp"
#include "libsim/base/stop_scope.hpp"

namespace modcal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Problem = DampedSinusoidProblem;

VectorXd variances_of(const Problem& problem, const Problem::State& state) {
  VectorXd variances = state.residual.colwise().squaredNorm().transpose();
  variances /= std::max(1.0, problem.degrees_of_freedom());
  // Noise-free channels would weigh infinitely: rounding is their noise.
  const VectorXd data =
      (state.residual + state.basis * state.coefficients.topRows(2 * problem.poles()))
          .colwise()
          .squaredNorm();
  return variances.cwiseMax(kRoundedVariance * data / static_cast<double>(problem.samples()));
}

double cost_of(const Problem::State& state, const VectorXd& variances) {
  return (state.residual.colwise().squaredNorm().transpose().array() / variances.array()).sum();
}

/// An undamped step.
struct Whole {
  VectorXd solution;
  MatrixXd covariance;
};

/// Gauss–Newton step with its covariance for noise of the given variances, and the damped one.
class Step {
 public:
  Step(const Problem& problem, const Problem::State& state, const VectorXd& variances)
      : normal_(problem.normal_equations(state, variances)),
        scale_(normal_.matrix.diagonal().cwiseSqrt().cwiseInverse()) {
    // The slopes of two poles that cannot be told apart are dependent to rounding of the sums.
    const double least = 1e-7;
    const Eigen::LLT<MatrixXd> factor = damped_factor(0.0);
    const bool is_whole = scale_.allFinite() && factor.info() == Eigen::Success &&
                          factor.matrixLLT().diagonal().minCoeff() > least;
    if (!is_whole) return;
    const MatrixXd identity = MatrixXd::Identity(scale_.size(), scale_.size());
    whole_ = {.solution = solved(factor),
              .covariance = scale_.asDiagonal() * factor.solve(identity) * scale_.asDiagonal()};
  }

  const std::optional<Whole>& whole() const { return whole_; }
  /// Least ‖J x + e‖² + μ Σ ‖J_k‖² x_k² (Marquardt, 1963).
  VectorXd damped(double damping) const {
    return damping == 0.0 ? whole_->solution : solved(damped_factor(damping));
  }

 private:
  Eigen::LLT<MatrixXd> damped_factor(double damping) const {
    MatrixXd scaled = scale_.asDiagonal() * normal_.matrix * scale_.asDiagonal();
    scaled.diagonal().array() += damping;
    return Eigen::LLT<MatrixXd>(scaled);
  }
  VectorXd solved(const Eigen::LLT<MatrixXd>& factor) const {
    return -(scale_.asDiagonal() * factor.solve(scale_.asDiagonal() * normal_.slope));
  }

  Problem::Normal normal_;
  VectorXd scale_;
  std::optional<Whole> whole_;
};

/// The state after a step by which the cost falls, or the same one; damping is what it took.
bool descend(const Problem& problem, Problem::State& state, const Step& step,
             const VectorXd& variances, double& damping) {
  const double cost = cost_of(state, variances);
  double trial = damping;
  while (trial < 1e8) {
    Problem::State next = problem.at(problem.bounded(state.poles + step.damped(trial)));
    if (next.poles.allFinite() && cost_of(next, variances) <= cost) {
      state = std::move(next);
      damping = trial > 1e-3 ? 0.1 * trial : 0.0;
      return true;
    }
    trial = std::max(1e-3, 10.0 * trial);
  }
  return false;
}

// f = |λ|/2π and ζ = d/|λ| from (d, ν).
DecayPole deviation_of(double d, double nu, const Eigen::Matrix2d& covariance) {
  const double omega = std::hypot(d, nu);
  const Eigen::Vector2d frequency = Eigen::Vector2d(d, nu) / (2.0 * std::numbers::pi * omega);
  const Eigen::Vector2d ratio = Eigen::Vector2d(nu * nu, -d * nu) / (omega * omega * omega);
  return {std::sqrt(frequency.dot(covariance * frequency)),
          std::sqrt(ratio.dot(covariance * ratio))};
}

// aᵀ[(BᵀB)⁻¹_kk]⁻¹a over the channels.
double evidence_of(const Problem::State& state, Index k, const VectorXd& variances) {
  const Eigen::Matrix2d precision =
      Eigen::Matrix2d(state.inverse.block<2, 2>(2 * k, 2 * k)).inverse();
  double sum = 0.0;
  for (Index c = 0; c < variances.size(); ++c) {
    const Eigen::Vector2d a = state.coefficients.col(c).segment<2>(2 * k);
    sum += a.dot(precision * a) / variances[c];
  }
  return std::isfinite(sum) ? sum : std::numeric_limits<double>::quiet_NaN();
}

std::vector<DecayMode> modes_of(const Problem& problem, const Problem::State& state,
                                const std::optional<Whole>& step, const VectorXd& variances,
                                double in_band_variance) {
  const VectorXd noise = in_band_variance * variances;
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
    mode.evidence = evidence_of(state, k, noise);
    mode.departure = problem.departure(state, k, noise);
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
  Step step(problem, state, variances);
  double damping = 0.0;
  while (step.whole() && !fit.converged && fit.iterations < options.iterations) {
    ++fit.iterations;
    throw_if_stopped();
    const VectorXd& solution = step.whole()->solution;
    const VectorXd deviations = step.whole()->covariance.diagonal().cwiseSqrt();
    const double size = solution.cwiseQuotient(deviations).lpNorm<Eigen::Infinity>();
    // Without noise deviations are rounding, and so are the last steps.
    const bool rounding =
        solution.lpNorm<Eigen::Infinity>() <= kRoundedStep * state.poles.lpNorm<Eigen::Infinity>();
    const VectorXd before = state.poles;
    const bool fell = descend(problem, state, step, variances, damping);
    // A pole at its bound does not follow its step.
    const double moved = (state.poles - before).cwiseQuotient(deviations).lpNorm<Eigen::Infinity>();
    fit.converged = std::min(size, moved) <= options.tolerance || rounding || !fell;
    variances = variances_of(problem, state);
    step = Step(problem, state, variances);
  }
  fit.full_rank = step.whole().has_value();
  fit.modes = modes_of(problem, state, step.whole(), variances, options.in_band_variance);
  for (const double variance : variances) fit.noise.push_back(std::sqrt(variance));
  for (const auto channel : state.residual.colwise()) {
    fit.residual.emplace_back(channel.begin(), channel.end());
    fit.squares.push_back(channel.squaredNorm());
  }
  return fit;
}

DecayPole startable(DecayPole pole, double sample_rate) {
  pole.damping_ratio = std::clamp(pole.damping_ratio, 1e-6, 0.5);
  pole.frequency = std::clamp(pole.frequency, 1e-6 * sample_rate, (0.5 - 1e-6) * sample_rate);
  return pole;
}

double chi_square_rise(const DampedSinusoidFit& from, const DampedSinusoidFit& to,
                       double in_band_variance) {
  double sum = 0.0;
  for (std::size_t c = 0; c < from.squares.size(); ++c) {
    sum += static_cast<double>(from.residual[c].size()) * (to.squares[c] / from.squares[c] - 1.0);
  }
  return sum / in_band_variance;
}

double work_of(const DampedSinusoidFit& fit) {
  const std::size_t samples = fit.residual.front().size() * fit.residual.size();
  return static_cast<double>(fit.iterations * fit.modes.size() * samples);
}

}  // namespace modcal
