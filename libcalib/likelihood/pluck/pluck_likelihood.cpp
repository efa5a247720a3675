#include "libcalib/likelihood/pluck/pluck_likelihood.hpp"

#include <algorithm>
#include <cmath>

#include "libcalib/likelihood/pluck/pluck_evaluation.hpp"
#include "libcalib/likelihood/tuning.hpp"
#include "libsim/base/error.hpp"

namespace modcal {

PluckLikelihood::PluckLikelihood(WhitenedRecord record) : record_(std::move(record)) {
  MODCAL_REQUIRE(record_.sigma == 0.0,
                 "a pluck damped by {:g} 1/s: it is compared as it was recorded, at 0 1/s",
                 record_.sigma);
}

LikelihoodPoint PluckLikelihood::evaluate(const ModelPoint& point, const LikelihoodColumns& columns,
                                          const LikelihoodOutputs& outputs) const {
  LikelihoodPoint result = PluckEvaluation(record_, point).differentiate(columns, outputs);
  if (outputs.twice_weighted) result.twice_weighted = result.information;
  return result;
}

Eigen::MatrixXd PluckLikelihood::noise_information(const ModelPoint& point,
                                                   const LikelihoodColumns& columns) const {
  const auto n = static_cast<Eigen::Index>(columns.count);
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(n, n);
  for (std::size_t r = 0; r < kNoiseRepeats; ++r) {
    const WhitenedRecord noise = record_.noise(r);
    sum += PluckEvaluation(noise, point).differentiate(columns, {}).information;
  }
  return sum / static_cast<double>(kNoiseRepeats);
}

LikelihoodPoint PluckLikelihood::unweighted(const ModelPoint& point,
                                            const LikelihoodColumns& columns) const {
  return evaluate(point, columns, {});
}

double PluckLikelihood::cost(const ModelPoint& point) const {
  return PluckEvaluation(record_, point).cost();
}

double PluckLikelihood::degrees_of_freedom(const ModelPoint& point) const {
  const std::size_t linear = 2 * point.basis.size() + plain_transients(record_, point).size();
  return 4.0 * static_cast<double>(record_.bins) - static_cast<double>(linear);
}

double PluckLikelihood::power_about(std::complex<double> pole, double omega) const {
  const auto center = std::min(static_cast<std::size_t>(omega / record_.spacing), record_.bins - 1);
  const std::size_t begin = center > kPluckHalfBand ? center - kPluckHalfBand : 0;
  const std::size_t end = std::min(center + kPluckHalfBand, record_.bins);
  Complex left = 0.0, right = 0.0;
  double norm = 0.0;
  for (std::size_t k = begin; k < end; ++k) {
    const Complex decay = 1.0 / (1.0 - pole * record_.delay.at(k));
    left += std::conj(decay) * record_.left.at(k);
    right += std::conj(decay) * record_.right.at(k);
    norm += std::norm(decay);
  }
  return (std::norm(left) + std::norm(right)) / norm;
}

}  // namespace modcal
