// The calibration to the bound that starts from a pluck test and ends under it as a prior.

#include "experiments/kinds/section7/pluck_then_bow.hpp"
#include "libcalib/objectives/frequency_prior.hpp"
#include "libcalib/objectives/joint_likelihood.hpp"
#include "libcalib/objectives/weighted_sum.hpp"
#include "libcalib/optimizers/ceres_optimizer.hpp"
#include "libcalib/problem/covariance.hpp"

namespace modcal {
namespace {

struct Prior {
  double frequency = 0.0;
  double deviation = 0.0;
};

/// What the pluck test knows of the modes, by index; deviation 0: nothing.
std::vector<Prior> plucked_modes(const IdentifyOutcome& pluck, std::size_t modes) {
  std::vector<Prior> priors(modes);
  for (const auto& [number, mode] : pluck.found.modes) {
    if (number > modes || !pluck.found.full_rank) continue;
    priors[number - 1] = {mode.pole.frequency, mode.deviation.frequency};
  }
  return priors;
}

ModelStage start_stage(const PluckThenBowOptions& options, const PluckThenBowOutcome& outcome) {
  const auto modes = static_cast<std::size_t>(options.truth.scene.string.modes);
  const DampingFit damping = damping_of(outcome.likelihood.found, options.pluck.damping_degree);
  return {
      .key = "bound_start",
      .title = "law of the pluck test",
      .model = {law_basis(options, *outcome.likelihood.law, damping, modes), options.contact.start},
      .law = *outcome.likelihood.law};
}

ModelStage bound_stage(const ContinuationResult& found, std::int64_t evaluations) {
  ModelStage stage{.key = "bound",
                   .title = "joint likelihood at its bound",
                   .model = {found.model.basis, found.model.contact},
                   .contact_deviation = found.contact_deviation,
                   .evaluations = evaluations};
  stage.law.fundamental = found.found_law.fundamental;
  stage.law.inharmonicity = found.found_law.inharmonicity;
  stage.law.fundamental_deviation = found.found_law.deviation[0];
  stage.law.inharmonicity_deviation = found.found_law.deviation[1];
  for (const ModeVerdict& mode : found.modes) stage.deviation.push_back(mode.deviation);
  return stage;
}

/// Law, contact: both records in one likelihood.
ModelStage law_posterior(const ModelStage& before, const std::vector<Prior>& priors,
                         const ContinuationResult& found, const CalibrationData& data,
                         const SecondsClock& clock) {
  WeightedSum::Options sum;
  sum.terms.resize(2);
  sum.terms[0].objective.assign(Choice<Objective>::of<JointLikelihood>(
      "joint_likelihood", {.left_noise = found.noise[0], .right_noise = found.noise[1]}));
  FrequencyPrior::Options prior;
  for (std::size_t n = 0; n < priors.size(); ++n) {
    if (!(priors[n].deviation > 0.0)) continue;
    prior.modes.push_back(static_cast<std::int64_t>(n + 1));
    prior.frequencies.push_back(priors[n].frequency);
    prior.deviations.push_back(priors[n].deviation);
  }
  sum.terms[1].objective.assign(
      Choice<Objective>::of<FrequencyPrior>("frequency_prior", std::move(prior)));
  const std::vector<std::string> names = {"f0", "B", "x_c"};
  const ParameterSet parameters({before.model.basis, before.model.contact}, names);
  const auto function = WeightedSum(sum).bind(data, parameters);
  const std::vector<Variable> variables = parameters.variables();
  const OptimizationResult search =
      CeresOptimizer({}).minimize(*function, variables, Budget{.evaluations = 200}, clock);
  const Covariance covariance = covariance_at(*function, variables, search.x);
  const ModelPoint model = parameters.model(search.x);
  ModelStage stage = before;
  stage.model = {model.basis, model.contact};
  stage.law.fundamental = search.x[0];
  stage.law.inharmonicity = search.x[1];
  stage.law.fundamental_deviation = covariance.standard_deviation(0);
  stage.law.inharmonicity_deviation = covariance.standard_deviation(1);
  stage.contact_deviation = covariance.standard_deviation(2);
  stage.evaluations = search.evaluations;
  stage.deviation.assign(priors.size(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t n = 0; covariance.full_rank && n < stage.deviation.size(); ++n) {
    // d ln f_n = d ln f0 + n²/(2 (1 + B n²)) dB.
    const double square = std::pow(static_cast<double>(n + 1), 2);
    const double by_f0 = 1.0 / search.x[0];
    const double by_b = 0.5 * square / (1.0 + search.x[1] * square);
    stage.deviation[n] =
        std::sqrt(by_f0 * by_f0 * covariance(0, 0) + 2.0 * by_f0 * by_b * covariance(0, 1) +
                  by_b * by_b * covariance(1, 1));
  }
  return stage;
}

/// Every frequency apart: the means of both measurements by their precisions.
ModelStage mode_posterior(const ModelStage& before, const std::vector<Prior>& priors) {
  ModelStage stage = before;
  for (std::size_t n = 0; n < priors.size(); ++n) {
    if (!(priors[n].deviation > 0.0)) continue;
    const double bowed = stage.model.basis.frequency(n);
    const double bowed_weight = std::pow(stage.deviation[n] * bowed, -2);
    const double plucked_weight = std::pow(priors[n].deviation, -2);
    const double sum = bowed_weight + plucked_weight;
    const double mean = (bowed * bowed_weight + priors[n].frequency * plucked_weight) / sum;
    stage.model.basis.omega[n] *= mean / bowed;
    stage.deviation[n] = 1.0 / (std::sqrt(sum) * mean);
  }
  return stage;
}

}  // namespace

void add_bound_stages(const PluckThenBowOptions& options, const StudyContext& context,
                      PluckThenBowOutcome& outcome) {
  const CalibrationData data = calibration_data(outcome.stroke);
  outcome.bound_stages.push_back(start_stage(options, outcome));
  const AssumedModel start = outcome.bound_stages.back().model;
  outcome.bound =
      *calibrate({start.basis, start.contact}, data, options.bound, polling_clock(context))
           .continuation;
  outcome.bound_stages.push_back(
      bound_stage(outcome.bound, static_cast<std::int64_t>(outcome.bound.evaluations)));
  const std::vector<Prior> priors = plucked_modes(outcome.likelihood, start.basis.size());
  ModelStage posterior = outcome.bound.law.accepted
                             ? law_posterior(outcome.bound_stages.back(), priors, outcome.bound,
                                             data, polling_clock(context))
                             : mode_posterior(outcome.bound_stages.back(), priors);
  posterior.key = "posterior";
  posterior.title = "posterior of stroke and pluck test";
  outcome.bound_stages.push_back(std::move(posterior));
}

}  // namespace modcal
