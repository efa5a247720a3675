#include "experiments/study/identification.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "experiments/study/fingerprint.hpp"
#include "libsim/base/error.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

constexpr std::size_t kPreparedKept = 8;

std::string key_of(const AssumedModel& model, const Observation& observation,
                   InversionOptions options) {
  const ModalBasis& basis = model.basis;
  std::string key = fingerprint([&](OptionVisitor& visitor) {
    visitor.plugin({.key = "estimator", .meaning = ""}, options.estimator);
  });
  const auto add = [&key](double value) { key += fmt::format(" {:a}", value); };
  for (const double value :
       {model.contact, observation.sample_rate, static_cast<double>(observation.samples()),
        observation.truth ? 0.0 : 1.0, basis.length, basis.tension}) {
    add(value);
  }
  for (const auto* part : {&basis.omega, &basis.zeta, &basis.mass}) {
    std::for_each(part->begin(), part->end(), add);
  }
  return key;
}

// As stated by a simulated measurement; unknown for a record.
double noise_rms_of(const Observation& observation, End end) {
  if (!observation.truth) return std::numeric_limits<double>::quiet_NaN();
  const Simulation& simulation = observation.truth->simulation;
  const Signal& clean = end == End::kLeft ? simulation.left_reaction : simulation.right_reaction;
  return observation.noise_level * standard_deviation(clean.samples);
}

EstimationRecord record_of(const Observation& observation) {
  EstimationRecord record;
  for (const End end : kEnds) {
    const auto side = static_cast<std::size_t>(end);
    if (observation.reaction(end)) record.reactions[side] = observation.reaction(end)->samples;
    record.stated_noise[side] = noise_rms_of(observation, end);
  }
  if (observation.truth && observation.reference) {
    record.true_force = observation.reference->samples;
  }
  return record;
}

}  // namespace

ForceScores scores_of(const Observation& observation, std::span<const double> force,
                      const ScoreOptions* score, std::span<const double> unaliased) {
  if (score == nullptr || !observation.reference) return {};
  return score_force(force,
                     {.truth = *observation.reference,
                      .anti_aliased = observation.anti_aliased,
                      .anti_alias_cut = observation.anti_alias_cut,
                      .fundamental = observation.fundamental},
                     *score, unaliased);
}

InversionCache::Prepared prepare_estimator(const AssumedModel& model,
                                           const Observation& observation,
                                           const InversionRecipe& recipe) {
  return recipe.estimator().prepare({.basis = model.basis,
                                     .contact = model.contact,
                                     .samples = observation.samples(),
                                     .sample_rate = observation.sample_rate,
                                     .recorded = observation.truth == nullptr});
}

InversionCache::Prepared InversionCache::get(const AssumedModel& model,
                                             const Observation& observation,
                                             const InversionOptions& options,
                                             const InversionRecipe& recipe) {
  const std::string key = key_of(model, observation, options);
  const std::lock_guard lock(mutex_);
  for (const auto& [known, prepared] : prepared_) {
    if (known == key) return prepared;
  }
  prepared_.emplace_back(key, prepare_estimator(model, observation, recipe));
  if (prepared_.size() > kPreparedKept) prepared_.pop_front();
  return prepared_.back().second;
}

std::vector<SideIdentification> identify(const Observation& observation,
                                         const PreparedEstimator& estimator,
                                         const InversionRecipe& recipe,
                                         const InversionOutputs& outputs,
                                         const ScoreOptions* score) {
  std::vector<SideIdentification> sides;
  for (Estimate& estimate : estimator.estimate(record_of(observation), recipe.method(outputs))) {
    const ForceScores scores =
        scores_of(observation, estimate.result.force, score, estimate.unaliased_force);
    sides.push_back({scores, std::move(estimate)});
  }
  return sides;
}

}  // namespace modcal
