#include "experiments/study/model_based.hpp"

#include <fmt/format.h>

#include "libsim/base/error.hpp"

namespace modcal {
namespace {

std::vector<ModelScore> scores_of(const ModelBasedResult& result, const Observation& observation,
                                  const ScoreOptions& options) {
  const ScoreReference reference = reference_of(observation);
  const Signal model{"f_c", "N", observation.sample_rate, result.force};
  const Signal linear{"f_c", "N", observation.sample_rate, result.linear_force};
  const auto by_model = score_windows(model, reference, options, result.unaliased_force);
  const auto by_line = score_windows(linear, reference, options);
  std::vector<ModelScore> scores;
  for (std::size_t i = 0; i < by_model.size(); ++i) {
    const bool all = options.windows.empty();
    scores.push_back(
        {all ? "all" : fmt::format("{:g} s", by_model[i].start), by_model[i], by_line[i]});
  }
  if (!options.whole.empty()) {
    scores.push_back({fmt::format("{:g} s to {:g} s", options.whole[0], options.whole[1]),
                      score_whole(model, reference, options, result.unaliased_force),
                      score_whole(linear, reference, options)});
  }
  return scores;
}

}  // namespace

ModelIdentification identify_by_model(const Observation& observation, const AssumedModel& model,
                                      const ModelBasedOptions& options, const ScoreOptions* score,
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
  if (score && observation.reference) {
    identification.scores = scores_of(identification.result, observation, *score);
  }
  return identification;
}

}  // namespace modcal
