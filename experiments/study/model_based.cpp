#include "experiments/study/model_based.hpp"

#include <cmath>

#include "libsim/base/error.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

constexpr std::size_t kOversampling = 16;

WindowScore score_part(std::span<const double> identified, std::span<const double> truth,
                       std::size_t first, std::size_t last, double sample_rate) {
  const auto x = identified.subspan(first, last - first), y = truth.subspan(first, last - first);
  return {static_cast<double>(first) / sample_rate, correlation(x, y), relative_rms_error(x, y)};
}

ModelScore score_between(const ModelBasedResult& result, const Signal& truth,
                         const std::vector<double>& mean_truth, std::size_t first,
                         std::size_t last) {
  const double rate = truth.sample_rate;
  ModelScore score;
  score.sampled = score_part(result.force, truth.samples, first, last, rate);
  score.linear = score_part(result.linear_force, truth.samples, first, last, rate);
  if (mean_truth.size() == truth.size()) {
    score.mean = score_part(result.mean_force, mean_truth, first, last, rate);
  }
  return score;
}

std::pair<std::size_t, std::size_t> whole_of(std::size_t samples) {
  const auto count = static_cast<double>(samples);
  return {static_cast<std::size_t>(std::round(kWholeFrom * count)),
          static_cast<std::size_t>(std::round(kWholeTo * count))};
}

}  // namespace

std::vector<double> mean_force_between_samples(const ObservationOptions& options,
                                               TruthCache& cache) {
  const double fast = kOversampling * options.measurement.sample_rate;
  const auto truth = cache.get(options.truth, fast, {.force = true});
  const std::vector<double>& f = truth->simulation.force.samples;
  const std::size_t samples =
      sample_count(options.truth.scene.duration, options.measurement.sample_rate);
  std::vector<double> result(samples);
  for (std::size_t k = 0; k < samples; ++k) {
    const std::size_t first = k * kOversampling;
    double sum = 0.0;
    for (std::size_t i = 0; i < kOversampling; ++i) {
      const std::size_t left = std::min(first + i, f.size() - 1);
      const std::size_t right = std::min(first + i + 1, f.size() - 1);
      sum += 0.5 * (f[left] + f[right]);
    }
    result[k] = sum / kOversampling;
  }
  return result;
}

ModelIdentification identify_by_model(const Observation& observation, const AssumedModel& model,
                                      const ModelBasedOptions& options, const ScoreOptions* score,
                                      const std::vector<double>& mean_truth,
                                      const std::function<bool()>& interrupted) {
  for (const End end : kEnds) {
    MODCAL_REQUIRE(observation.reaction(end).has_value(),
                   "the model-based estimate needs both reactions: the one at {} is missing; leave "
                   "out model_based or record it",
                   label_of(end));
  }
  ModelIdentification identification;
  identification.result = ModelBasedEstimator(options).estimate(
      model.basis, model.contact, observation.sample_rate,
      observation.reaction(End::kLeft)->samples, observation.reaction(End::kRight)->samples,
      interrupted);
  if (!score || !observation.reference) return identification;
  const Signal& truth = *observation.reference;
  const auto length = static_cast<std::size_t>(
      std::round(score->periods / observation.fundamental * truth.sample_rate));
  for (const double start : score->windows) {
    const auto first = static_cast<std::size_t>(std::round(start * truth.sample_rate));
    MODCAL_REQUIRE(length >= 2 && first + length <= truth.size(),
                   "the score window from {:g} s is not inside the record of {:g} s", start,
                   truth.duration());
    identification.scores.push_back(
        score_between(identification.result, truth, mean_truth, first, first + length));
    identification.scores.back().window = fmt::format("{:g} s", start);
  }
  const auto [first, last] = whole_of(truth.size());
  identification.scores.push_back(
      score_between(identification.result, truth, mean_truth, first, last));
  identification.scores.back().window = "whole";
  return identification;
}

}  // namespace modcal
