#include "libinverse/observer/model_check.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "libinverse/invert.hpp"
#include "libinverse/joint/joint_estimators.hpp"
#include "libinverse/observer/tuning.hpp"
#include "libsim/base/error.hpp"
#include "libsim/signal/fft.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal::observer {
namespace {

constexpr std::array kEnds = {End::kLeft, End::kRight};
constexpr std::array kEndNames = {"x = 0", "x = L"};

}  // namespace

void judge_misfit(const ObservedRecord& record, const GainSchedule& schedule,
                  std::span<const double> quiet_misfit, ModelBasedResult& result) {
  double quiet = 0.0, level = 0.0, relative = 0.0;
  for (const std::size_t gain : schedule) quiet += quiet_misfit[gain];
  for (int r = 0; r < 2; ++r) {
    const double share = record.raw_noise[r] / record.noise[r];
    level += 0.5 * share * share;
    relative += 0.25 * record.noise_deviation[r] * record.noise_deviation[r];
  }
  result.expected_misfit = level * quiet / static_cast<double>(schedule.size());
  const double samples = 2.0 * static_cast<double>(record.samples());
  result.misfit_deviation =
      result.expected_misfit * std::sqrt(relative + std::numbers::pi / samples);
}

StaticRecovery static_recovery(const ObservedRecord& record, const ModelBasedResult& result) {
  const double xi = record.contact / record.basis.length;
  const double share[2] = {1.0 - xi, xi};
  double precision = 0.0;
  for (int r = 0; r < 2; ++r) {
    const double weight =
        share[r] / silent_deviation(record, kEnds[r], result.parameters.bow_velocity);
    precision += weight * weight;
  }
  return {mean(result.force), 1.0 / std::sqrt(precision)};
}

std::string law_note(const ModelBasedResult& result) {
  const std::vector<FrictionCandidate>& laws = result.laws;
  std::string text = fmt::format("friction law: {}", laws[0].law);
  for (std::size_t i = 1; i < laws.size(); ++i) {
    text += fmt::format("{} {} (BIC {:+.4g}, z {:.2g})", i == 1 ? "; others:" : ",", laws[i].law,
                        laws[i].criterion - laws[0].criterion, laws[i].distance - laws[0].distance);
  }
  return text;
}

void add_warnings(const ModelBasedOptions& options, const ObservedRecord& record,
                  std::span<const double> offset_deviation, ModelBasedResult& result) {
  // Below the floor under the noise the observer's own discretization is all there is to see.
  const double calibrated = std::max(1.0, result.expected_misfit) + 4.0 * result.misfit_deviation;
  result.misfit_limit = std::isnan(options.misfit_limit) ? calibrated : options.misfit_limit;
  if (!result.explained()) {
    result.warnings.push_back(fmt::format(
        "innovation misfit {:.4g} (median over blocks) is above {:.4g}, a right model leaves "
        "{:.3f} ± {:.3f}: the model does not explain the reactions to their noise; compare with "
        "the linear estimate, and free what may differ (force_knots, velocity_knots, laws, "
        "delay, gain, contact, frequencies)",
        result.steady_misfit, result.misfit_limit, result.expected_misfit,
        result.misfit_deviation));
  }
  for (int r = 0; r < 2; ++r) {
    const double level = std::abs(mean(std::span(record.reaction[r]).first(record.silent[r])) -
                                  result.parameters.offset[r]);
    const double deviation = std::max(
        offset_deviation[r], silent_deviation(record, kEnds[r], result.parameters.bow_velocity));
    if (level > 5.0 * deviation) {
      result.warnings.push_back(fmt::format(
          "the fitted offset of the reaction at {} is {:.3g} N away from its level before the "
          "first wave, {:.2g} standard deviations: the record may not start at rest: "
          "begin it before the bow moves, or compare with the joint estimate, which need not",
          kEndNames[r], level, level / deviation));
    }
  }
}

Estimate joint_estimate(const EstimationModel& model, const ReactionPair& reactions,
                        const double (&noise_rms)[2]) {
  JointEstimator::Options joint;
  std::ranges::copy(noise_rms, joint.joint.noise_rms);
  InversionOptions options;
  options.estimator = Choice<Estimator>::of<JointEstimator>("joint", joint);
  const InversionRecipe recipe(options);
  InversionMethod method = recipe.method({.force = true, .displacement = true, .velocity = true});
  method.variances = true;
  EstimationRecord record;
  record.reactions = reactions;
  return recipe.estimator().prepare(model)->estimate(record, method).front();
}

void take_noise(const Estimate& joint, const double (&stated)[2], ObservedRecord& record) {
  constexpr std::array kNames = {"noise_rms_1", "noise_rms_2"};
  for (std::size_t r = 0; r < 2; ++r) {
    const auto level =
        std::ranges::find(joint.figures, kNames[r], &std::pair<std::string, double>::first);
    if (!std::isnan(stated[r]) || level == joint.figures.end()) continue;
    record.raw_noise[r] = level->second;
    record.noise[r] = std::max(level->second, kNoiseFloor * standard_deviation(record.reaction[r]));
  }
}

void add_model_error(Estimate joint, const ObservedRecord& record, ModelBasedResult& result) {
  ModelError& error = result.model_error;
  const double top = record.basis.frequency(record.basis.size() - 1);
  error.band_limit = std::isnan(joint.band_limit) ? top : joint.band_limit;
  const double rate = record.sample_rate;
  const double unexplained = std::sqrt(std::max(1.0, result.steady_misfit / result.misfit_limit));
  for (auto* deviation : {&result.deviation.force, &result.deviation.velocity}) {
    for (double& value : *deviation) value *= unexplained;
  }
  const auto measure = [&](std::span<const double> estimate, const Reference& reference,
                           std::vector<BandError>& bands, std::vector<double>& deviation) {
    bands = band_errors(estimate, reference);
    // A law that explains both reactions to their noise has no error but theirs, which is more
    // than noise where they contradict each other.
    std::vector<double> errors(reference.variance.size(), 0.0);
    if (!result.explained()) errors = bin_errors(estimate, bands, rate, false);
    const double square = sample_square(with_excess(std::move(errors), reference), estimate.size());
    for (double& value : deviation) value = std::sqrt(value * value + square);
    return square;
  };
  const auto held = [&](const std::vector<double>& samples, const std::vector<double>& variance,
                        const std::vector<double>& excess) {
    return Reference{.samples = samples,
                     .variance = variance,
                     .sample_rate = rate,
                     .band_limit = error.band_limit,
                     .begin = kBeforeSteady,
                     .excess = excess};
  };
  error.force_square = measure(result.unaliased_force,
                               held(joint.result.force, joint.force_variance, joint.force_excess),
                               error.force_bands, result.deviation.force);
  error.velocity_square = measure(
      result.velocity, held(joint.result.velocity, joint.velocity_variance, joint.velocity_excess),
      error.velocity_bands, result.deviation.velocity);
  result.joint = std::move(joint);
}

double rigid_stiffness(const ObserverRuns& runs) {
  const double top = runs.record().basis.omega.back();
  return kRigid * kRigid * runs.string().effective_mass * top * top;
}

void require_finite_stiffness(const ObserverRuns& runs, const ObserverParameters& parameters,
                              const GainSchedule& schedule) {
  const double rigid = rigid_stiffness(runs);
  if (parameters.stiffness <= rigid) return;
  const std::size_t samples = runs.record().samples();
  ObserverParameters stiffer = parameters;
  stiffer.stiffness *= 4.0;
  const double here = misfit(runs.innovations(parameters, schedule, samples));
  const double there = misfit(runs.innovations(stiffer, schedule, samples));
  // Half the logarithm of the likelihood ratio that tells one parameter at two deviations.
  if (0.5 * 2.0 * static_cast<double>(samples) * (there / here - 1.0) > 2.0) return;
  throw_invalid_input(
      "the contact stiffness of the model-based estimate runs away: at {:.3g} N/m, above the "
      "{:.3g} N/m from which on a contact is rigid to all {} modes, four times as much fits as "
      "well (misfit {:.4g} and {:.4g}); take fewer modes (modes: auto), or estimator: joint, which "
      "assumes no contact",
      parameters.stiffness, rigid, runs.record().basis.size(), here, there);
}

double ringing(std::span<const double> force) {
  std::vector<double> power;
  for (const Complex bin : hann_spectrum(force)) power.push_back(std::norm(bin));
  const auto between = [&power](double low, double high) {
    const auto first = static_cast<std::size_t>(low * static_cast<double>(power.size()));
    const auto last = static_cast<std::size_t>(high * static_cast<double>(power.size()));
    return mean(std::span(power).subspan(first, std::max<std::size_t>(1, last - first)));
  };
  const double below = between(0.6, 0.85);
  return below > 0.0 ? between(0.9, 1.0) / below : 0.0;
}

void require_no_ringing(std::span<const double> force, double sample_rate) {
  const double ratio = ringing(force);
  MODCAL_REQUIRE(
      ratio <= kMostRinging,
      "the force of the model-based estimate rings between {:.5g} and {:.5g} Hz, half "
      "the sample rate: its power there is {:.3g} times that of lower frequencies, where "
      "{:g} is the most of a force that slides and sticks; take fewer modes (modes: "
      "auto), or estimator: joint, which assumes no contact",
      0.45 * sample_rate, 0.5 * sample_rate, ratio, kMostRinging);
}

}  // namespace modcal::observer
