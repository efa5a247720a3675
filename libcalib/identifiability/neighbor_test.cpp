#include "libcalib/identifiability/neighbor_test.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "libcalib/identifiability/neighbor_kernel.hpp"
#include "libcalib/identifiability/tuning.hpp"
#include "libsim/base/task_loop.hpp"

namespace modcal {
namespace {

// The likelihood at θ, from which single modes are moved.
class Field {
 public:
  Field(const ProjectedLikelihood& likelihood, const StringUnknowns& unknowns,
        const Eigen::VectorXd& theta)
      : record_(likelihood.record()),
        point_(unknowns.model(theta)),
        modes_(likelihood_modes(point_, record_.sample_rate)) {
    likelihood.evaluate(point_,
                        {.count = 0, .share_begin = std::vector<std::size_t>(modes_.size() + 1)},
                        {.residuals = &residuals_,
                         .force = &force_,
                         .amplitudes = &amplitudes_,
                         .left = &left_,
                         .right = &right_});
  }

  // Half a width of the damped resonance: finer than its minima are apart.
  double step(std::size_t n) const {
    const double omega = point_.basis.omega[n];
    const double width = (record_.sigma + point_.basis.zeta[n] * omega) / omega;
    return std::max(0.5 * width, kNeighborReach / 32.0);
  }

  ModeSurroundings around(std::size_t n) const {
    const double omega = point_.basis.omega[n];
    const auto center = std::min(static_cast<std::size_t>(omega / record_.spacing), record_.bins);
    const std::size_t begin = center > kNeighborHalfBand ? center - kNeighborHalfBand : 0;
    const std::size_t count = std::min(2 * kNeighborHalfBand, record_.bins - begin);
    ModeSurroundings result(2 * kNeighborHalfBand);
    result.sigma = record_.sigma;
    result.deviation = record_.deviation;
    for (std::size_t j = 0; j < 2 * kNeighborHalfBand; ++j) {
      fill(n, std::min(begin + j, record_.bins - 1), j, result);
      result.weight[j] = j < count ? record_.root_weight[begin + j] : 0.0;
    }
    return result;
  }

  LikelihoodMode moved(std::size_t n, double shift) const {
    LikelihoodMode mode = modes_[n];
    const double omega = point_.basis.omega[n] * std::exp(shift);
    const double zeta = point_.basis.zeta[n];
    mode.omega_squared = omega * omega;
    mode.two_zeta_omega = 2.0 * zeta * omega;
    mode.pole =
        std::exp(Complex(-zeta, std::sqrt(1.0 - zeta * zeta)) * omega / record_.sample_rate);
    return mode;
  }

 private:
  // Bin k without mode n.
  void fill(std::size_t n, std::size_t k, std::size_t j, ModeSurroundings& around) const {
    const LikelihoodMode& mode = modes_[n];
    const double turn = mode.even ? 1.0 : -1.0;
    const Complex s(record_.sigma, record_.omega[k]);
    const Complex sensor = point_.sensors.response(s);
    const Complex receptance =
        mode.residue / (mode.omega_squared + s * s + mode.two_zeta_omega * s);
    const Complex delay = record_.delay.at(k);
    const Complex left = left_[k], right = right_[k];
    // Force and residual make the data again.
    const NoisePair noise = noise_of_residual(record_.noise_at(k), left, right,
                                              Complex(residuals_[2 * k], residuals_[2 * k + 1]));
    Complex left_data = left * force_[k] + noise.left;
    Complex right_data = right * force_[k] + noise.right;
    if (n < amplitudes_.size()) {
      const Complex decay = amplitudes_[n] / (1.0 - mode.pole * delay) +
                            std::conj(amplitudes_[n]) / (1.0 - std::conj(mode.pole) * delay);
      left_data -= decay / record_.deviation[0];
      right_data += turn * sensor * decay / record_.deviation[1];
    }
    around.left.set(j, left + receptance / record_.deviation[0]);
    around.right.set(j, right - turn * sensor * receptance / record_.deviation[1]);
    around.left_data.set(j, left_data);
    around.right_data.set(j, right_data);
    around.sensor.set(j, sensor);
    around.delay.set(j, delay);
    around.omega[j] = record_.omega[k];
    const NoiseCovariance covariance = record_.noise_at(k);
    around.left_noise[j] = covariance.left;
    around.right_noise[j] = covariance.right;
    around.mixed_noise[j] = covariance.mixed;
  }

  const WhitenedRecord& record_;
  ModelPoint point_;
  std::vector<LikelihoodMode> modes_;
  std::vector<double> residuals_;
  std::vector<Complex> force_, amplitudes_, left_, right_;
};

// Bounds [first, last] of the minimum that place `here` of a profile lies in.
std::pair<std::size_t, std::size_t> own_minimum(const std::vector<double>& costs,
                                                std::size_t here) {
  std::size_t first = here, last = here;
  while (first > 0 && costs[first - 1] <= costs[first]) --first;
  while (first > 0 && costs[first - 1] >= costs[first]) --first;
  while (last + 1 < costs.size() && costs[last + 1] <= costs[last]) ++last;
  while (last + 1 < costs.size() && costs[last + 1] >= costs[last]) ++last;
  return {first, last};
}

Neighbor best_of(const std::vector<double>& costs, std::size_t here, double step) {
  const auto [first, last] = own_minimum(costs, here);
  Neighbor best{.gain = -std::numeric_limits<double>::infinity()};
  for (std::size_t j = 0; j < costs.size(); ++j) {
    const double gain = costs[here] - costs[j];
    if (gain <= best.gain || (j >= first && j <= last && gain <= kNeighborMargin)) continue;
    best = {.shift = step * (static_cast<double>(j) - static_cast<double>(here)), .gain = gain};
  }
  return best;
}

}  // namespace

std::vector<Neighbor> neighbors(const ProjectedLikelihood& likelihood,
                                const StringUnknowns& unknowns, const QuadraticPrior& prior,
                                const Eigen::VectorXd& theta) {
  const Field field(likelihood, unknowns, theta);
  const Eigen::VectorXd pull = prior.precision * (theta - prior.mean);
  std::vector<Neighbor> result(unknowns.modes());
  for_each_task(result.size(), [&](std::size_t n) {
    const auto i = static_cast<Eigen::Index>(n);
    if (unknowns.held(i)) return;
    const ModeSurroundings around = field.around(n);
    const double step = field.step(n);
    const auto here = static_cast<std::size_t>(kNeighborReach / step);
    std::vector<double> costs;
    for (std::size_t j = 0; j <= 2 * here; ++j) {
      const double shift = step * (static_cast<double>(j) - static_cast<double>(here));
      const double prior_change = (pull[i] + 0.5 * prior.precision(i, i) * shift) * shift;
      costs.push_back(cost_with(around, field.moved(n, shift)) + prior_change);
    }
    result[n] = best_of(costs, here, step);
  });
  return result;
}

std::size_t leave_false_minima(const std::vector<Neighbor>& neighbors, Eigen::VectorXd& theta) {
  const auto gain = [&](std::size_t n) {
    const bool moves = n < neighbors.size() && neighbors[n].shift != 0.0;
    return moves ? neighbors[n].gain : -std::numeric_limits<double>::infinity();
  };
  std::size_t moved = 0;
  for (std::size_t n = 0; n < neighbors.size(); ++n) {
    if (gain(n) <= kNeighborMargin) continue;
    // Beside a mode that is wrong the next ones seem to be.
    bool most = true;
    for (std::size_t away = 1; away <= kNeighborBeside; ++away) {
      most = most && gain(n) >= gain(n + away) && (n < away || gain(n) >= gain(n - away));
    }
    if (!most) continue;
    theta[static_cast<Eigen::Index>(n)] += neighbors[n].shift;
    ++moved;
  }
  return moved;
}

}  // namespace modcal
