#include "libinverse/modes/pole_distance.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "libinverse/modes/damped_sinusoid_problem.hpp"
#include "libinverse/modes/second_pole.hpp"
#include "libinverse/modes/tuning.hpp"

namespace modcal {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Problem = DampedSinusoidProblem;

// A fit of a few poles of which the second stands at a stated distance of the first.
class TiedPair {
 public:
  TiedPair(const DecayRecord& record, const std::vector<DecayPole>& poles,
           const Eigen::VectorXd& variances)
      : problem_(record, poles.size(), {}),
        variances_(variances),
        tie_(Eigen::MatrixXd::Zero(2 * problem_.poles(), 2 * problem_.poles() - 2)) {
    const Index size = tie_.rows();
    tie_.topLeftCorner<2, 2>().setIdentity();
    tie_.bottomRows(size - 2).setIdentity();
    Eigen::VectorXd values(size);
    for (Index k = 0; k < problem_.poles(); ++k) {
      const Complex exponent = poles[static_cast<std::size_t>(k)].exponent();
      values.segment<2>(2 * k) << -exponent.real(), exponent.imag();
    }
    state_ = problem_.at(values);
    least_ = cost(state_);
  }

  double rise() const { return cost(state_) - least_; }
  Complex pole(Index k) const { return {-state_.poles[2 * k], state_.poles[2 * k + 1]}; }
  // Of the second over the first, in all channels.
  double share() const {
    return std::sqrt(state_.coefficients.middleRows<2>(2).squaredNorm() /
                     state_.coefficients.topRows<2>().squaredNorm());
  }

  // Gauss–Newton from where the mean of both stays, to a hundredth of χ².
  void fit_at(Complex apart) {
    const double share = this->share();
    const Complex mean = (pole(0) + share * pole(1)) / (1.0 + share);
    const Complex first = mean - apart * share / (1.0 + share), second = first + apart;
    Eigen::VectorXd poles = state_.poles;
    poles.head<4>() << -first.real(), first.imag(), -second.real(), second.imag();
    state_ = problem_.at(problem_.bounded(poles));
    for (int step = 0; step < kDistanceSteps; ++step) {
      const double before = cost(state_);
      if (!descend() || before - cost(state_) < 0.01) return;
    }
  }

 private:
  double cost(const Problem::State& state) const {
    return (state.residual.colwise().squaredNorm().transpose().array() / variances_.array()).sum();
  }

  bool descend() {
    const Problem::Normal normal = problem_.normal_equations(state_, variances_);
    const Eigen::MatrixXd matrix = tie_.transpose() * normal.matrix * tie_;
    const Eigen::VectorXd along = tie_ * matrix.ldlt().solve(-tie_.transpose() * normal.slope);
    double length = 1.0;
    while (length > 1e-2) {
      Problem::State next = problem_.at(problem_.bounded(state_.poles + length * along));
      if (cost(next) <= cost(state_)) {
        state_ = std::move(next);
        return true;
      }
      length *= 0.3;
    }
    return false;
  }

  Problem problem_;
  Eigen::VectorXd variances_;
  Eigen::MatrixXd tie_;  // steps of all poles by those that are free
  Problem::State state_;
  double least_ = 0.0;
};

// How far two poles were seen to stand from where they are, over the deviations that χ² allows.
class Reached {
 public:
  explicit Reached(const TiedPair& found) : found_(found) {}

  // Whether χ² allows the pair. Where the second is the larger, the opposite direction has it.
  bool note(const TiedPair& pair) {
    const double rise = pair.rise();
    if (!(rise < kFarthestRise)) return false;
    if (!(pair.share() <= 1.0)) return true;
    const double deviations = std::sqrt(std::max(1.0, rise));
    for (Index k = 0; k < 2; ++k) {
      const DecayPole at = DecayPole::of_exponent(pair.pole(k));
      const DecayPole from = DecayPole::of_exponent(found_.pole(k));
      DecayPole& most = most_[static_cast<std::size_t>(k)];
      most.frequency =
          std::max(most.frequency, std::abs(at.frequency - from.frequency) / deviations);
      most.damping_ratio = std::max(most.damping_ratio,
                                    std::abs(at.damping_ratio - from.damping_ratio) / deviations);
    }
    return true;
  }

  const std::array<DecayPole, 2>& most() const { return most_; }

 private:
  const TiedPair& found_;
  std::array<DecayPole, 2> most_ = {DecayPole{0.0, 0.0}, DecayPole{0.0, 0.0}};
};

std::array<DecayPole, 2> reached_by(const TiedPair& found, double duration) {
  Reached reached(found);
  const Complex apart = found.pole(1) - found.pole(0);
  const double width = -found.pole(0).real() + 1.0 / duration;
  const double nearest = kNearestDistance * width, farthest = 3.0 * width;
  TiedPair pair = found;
  double size = 1.4;
  pair.fit_at(size * apart);
  while (reached.note(pair) && 1.4 * size < 30.0) {
    size *= 1.4;
    pair.fit_at(size * apart);
  }
  pair = found;
  size = 0.7;
  while (size * std::abs(apart) > nearest) {
    pair.fit_at(size * apart);
    if (!reached.note(pair)) return reached.most();
    size *= 0.7;
  }
  for (int direction = 0; direction < kDirections; ++direction) {
    const Complex towards = std::polar(1.0, 2.0 * std::numbers::pi * direction / kDirections);
    pair = found;
    size = nearest;
    pair.fit_at(size * towards);
    while (reached.note(pair) && 2.0 * size < farthest) {
      size *= 2.0;
      pair.fit_at(size * towards);
    }
  }
  return reached.most();
}

// A mode, one that is smaller, and all others nearer than `reach`.
std::vector<std::size_t> pair_and_near(const DampedSinusoidFit& fit, std::size_t mode,
                                       std::size_t smaller, double reach) {
  std::vector<std::size_t> near = {mode, smaller};
  for (std::size_t j = 0; j < fit.modes.size(); ++j) {
    const double apart = fit.modes[j].pole.frequency - fit.modes[mode].pole.frequency;
    if (j != mode && j != smaller && std::abs(apart) < reach) near.push_back(j);
  }
  return near;
}

}  // namespace

void widen_by_distance(DampedSinusoidFit& fit, double sample_rate, double reach,
                       double in_band_variance, const ResidualLevels& levels) {
  const auto widen = [](DecayPole& deviation, const DecayPole& reached) {
    deviation.frequency = std::max(deviation.frequency, reached.frequency);
    deviation.damping_ratio = std::max(deviation.damping_ratio, reached.damping_ratio);
  };
  for (std::size_t k = 0; k < fit.modes.size(); ++k) {
    for (std::size_t i = 0; i < fit.modes.size(); ++i) {
      DecayMode &mode = fit.modes[k], &other = fit.modes[i];
      const double apart = std::abs(other.pole.frequency - mode.pole.frequency);
      if (i == k || !(apart < reach) || other.power() > mode.power()) continue;
      const std::vector<std::size_t> near = pair_and_near(fit, k, i, reach);
      const DecayRecord record = alone(fit, near, sample_rate);
      std::vector<DecayPole> poles;
      for (const std::size_t j : near) poles.push_back(fit.modes[j].pole);
      Eigen::VectorXd variances =
          Eigen::Map<const Eigen::VectorXd>(fit.noise.data(), std::ssize(fit.noise));
      variances = in_band_variance * levels.largest(mode.pole.frequency) * variances.cwiseAbs2();
      const double duration = static_cast<double>(record.samples()) / sample_rate;
      const auto reached = reached_by(TiedPair(record, poles, variances), duration);
      widen(mode.deviation, reached[0]);
      widen(other.deviation, reached[1]);
    }
  }
}

}  // namespace modcal
