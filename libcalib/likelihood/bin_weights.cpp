#include "libcalib/likelihood/bin_weights.hpp"

#include <algorithm>

#include "libcalib/likelihood/tuning.hpp"
#include "libsim/base/dense_solvers.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

// Sums over windows of bins by cumulative sums: every window in one step.
class Windows {
 public:
  explicit Windows(const std::vector<double>& values) : cumulative_(values.size() + 1, 0.0) {
    for (std::size_t k = 0; k < values.size(); ++k) cumulative_[k + 1] = cumulative_[k] + values[k];
  }
  double sum(std::size_t center, std::size_t half) const {
    return cumulative_[end(center, half)] - cumulative_[begin(center, half)];
  }
  double mean(std::size_t center, std::size_t half) const {
    return sum(center, half) / static_cast<double>(end(center, half) - begin(center, half));
  }

 private:
  static std::size_t begin(std::size_t center, std::size_t half) {
    return center > half ? center - half : 0;
  }
  std::size_t end(std::size_t center, std::size_t half) const {
    return std::min(center + half + 1, cumulative_.size() - 1);
  }
  std::vector<double> cumulative_;
};

// J_k A⁻¹ J_kᴴ of every bin, A = LLᵀ scaled to a unit diagonal.
class Shares {
 public:
  explicit Shares(const Eigen::MatrixXd& information)
      : scale_(information.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse()) {
    Eigen::MatrixXd scaled = scale_.asDiagonal() * information * scale_.asDiagonal();
    // A mode that nothing excites has no row of its own.
    scaled.diagonal().array() += 1e-9;
    factor_ = PositiveSolver(scaled);
  }
  std::vector<double> of(const Eigen::MatrixXd& jacobian) const {
    const Eigen::MatrixXd scaled = scale_.asDiagonal() * jacobian.transpose();
    const Eigen::MatrixXd rows = whiten(factor_, scaled);
    std::vector<double> shares(static_cast<std::size_t>(rows.cols() / 2));  // not that of √R
    for (std::size_t k = 0; k < shares.size(); ++k) {
      const auto i = static_cast<Eigen::Index>(2 * k);
      shares[k] = rows.col(i).squaredNorm() + rows.col(i + 1).squaredNorm();
    }
    return shares;
  }

 private:
  Eigen::VectorXd scale_;
  PositiveSolver factor_;
};

// S/|h|² of every bin.
std::vector<double> power_of_excess(const std::vector<double>& excess,
                                    const std::vector<double>& gain) {
  const Windows near_excess(excess), near_gain(gain);
  std::vector<double> between(excess.size()), between_gain(excess.size());
  for (std::size_t k = 0; k < excess.size(); ++k) {
    if (near_excess.sum(k, kLineBins) > kExcessProof) continue;
    between[k] = excess[k];
    between_gain[k] = gain[k];
  }
  // Lines by themselves, what is between them smoothed widely: noise does not choose its weight.
  const Windows wide_excess(between), wide_gain(between_gain);
  std::vector<double> power(excess.size());
  for (std::size_t k = 0; k < excess.size(); ++k) {
    const bool line = near_excess.sum(k, kLineBins) > kExcessProof;
    const double total = line ? near_gain.sum(k, kLineBins) : wide_gain.sum(k, kFloorBins);
    const double found = line ? near_excess.sum(k, kLineBins) : wide_excess.sum(k, kFloorBins);
    power[k] = total > 0.0 ? std::max(found / total, 0.0) : 0.0;
  }
  return power;
}

double weight(double signal) { return signal / (1.0 + signal); }

// q/q̄_noise and |h|² of every bin; 1 where nothing, noise included, tells of the unknowns.
struct SharesOverNoise {
  std::vector<double> ratio, gain;
};

// A smooth response of the sensors, which its prior holds, says little of what a bin holds.
SharesOverNoise shares_over_noise(const ProjectedLikelihood& likelihood, const ModelPoint& point,
                                  const LikelihoodColumns& all) {
  const LikelihoodColumns columns = all.without_response();
  const WhitenedRecord& record = likelihood.record();
  MODCAL_REQUIRE(std::all_of(record.root_weight.begin(),
                             record.root_weight.begin() + static_cast<long>(record.bins),
                             [](double root) { return root == 1.0; }),
                 "weights of {} bins are asked of a likelihood that has some already: give the "
                 "one without weights",
                 record.bins);
  SharesOverNoise result;
  Eigen::MatrixXd jacobian;
  const LikelihoodPoint at =
      likelihood.evaluate(point, columns, {.jacobian = &jacobian, .gain = &result.gain});
  const Shares shares(at.information);
  result.ratio = shares.of(jacobian);
  std::vector<double> noise(result.ratio.size(), 0.0);
  for (std::size_t r = 0; r < kWeightRepeats; ++r) {
    ProjectedLikelihood(record.noise(r)).evaluate(point, columns, {.jacobian = &jacobian});
    const std::vector<double> draw = shares.of(jacobian);
    for (std::size_t k = 0; k < noise.size(); ++k) noise[k] += draw[k] / kWeightRepeats;
  }
  const Windows expected(noise);
  for (std::size_t k = 0; k < noise.size(); ++k) {
    const double alone = expected.mean(k, kNoiseBins);
    result.ratio[k] = alone > 0.0 ? result.ratio[k] / alone : 1.0;
  }
  return result;
}

}  // namespace

std::vector<double> weights_of_excess(const std::vector<double>& excess,
                                      const std::vector<double>& gain) {
  std::vector<double> weights = power_of_excess(excess, gain);
  for (std::size_t k = 0; k < weights.size(); ++k) weights[k] = weight(gain[k] * weights[k]);
  return weights;
}

std::vector<double> information_weights(const ProjectedLikelihood& likelihood,
                                        const ModelPoint& point, const LikelihoodColumns& columns) {
  auto [ratio, gain] = shares_over_noise(likelihood, point, columns);
  for (double& excess : ratio) excess -= 1.0;
  return weights_of_excess(ratio, gain);
}

std::vector<double> best_weights(const ProjectedLikelihood& clean, const ModelPoint& point,
                                 const LikelihoodColumns& columns) {
  std::vector<double> weights = shares_over_noise(clean, point, columns).ratio;
  for (double& value : weights) value = weight(value);
  return weights;
}

}  // namespace modcal
