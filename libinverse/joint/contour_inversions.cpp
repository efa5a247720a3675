#include "libinverse/joint/contour_inversions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libsim/base/error.hpp"

namespace modcal {
namespace {

double rms_of(std::span<const double> samples) {
  double sum = 0.0, power = 0.0;
  for (const double value : samples) sum += value;
  const double mean = sum / static_cast<double>(samples.size());
  for (const double value : samples) power += (value - mean) * (value - mean);
  return std::sqrt(power / static_cast<double>(samples.size()));
}

// Noise over signal, the larger of both sides.
double noise_share(const ReactionPair& reactions, const SensorNoiseLevel& noise) {
  double share = 0.0;
  for (std::size_t r = 0; r < 2; ++r) {
    if (reactions[r].empty()) continue;
    const double rms = rms_of(reactions[r]);
    if (rms > 0.0) share = std::max(share, noise.rms[r] / rms);
  }
  return share;
}

}  // namespace

ContourInversions::ContourInversions(const EstimationModel& model, const JointOptions& options)
    : basis_(model.basis),
      contact_(model.contact),
      samples_(model.samples),
      sample_rate_(model.sample_rate),
      options_(options),
      truncation_(truncation_of(options.truncation)),
      support_(options.transfer.support(model.recorded)),
      noise_(basis_, contact_, samples_, sample_rate_, support_, options.sensors) {}

SensorNoiseLevel ContourInversions::noise_of(const EstimationRecord& record) const {
  SensorNoise::Workspace workspace;
  for (std::size_t r = 0; r < 2; ++r) {
    const auto& reaction = record.reactions[r];
    MODCAL_REQUIRE(reaction.empty() || reaction.size() == samples_,
                   "reaction {} has {} samples, the estimator is prepared for {}", r + 1,
                   reaction.size(), samples_);
    for (std::size_t j = 0; j < reaction.size(); ++j) {
      MODCAL_REQUIRE(std::isfinite(reaction[j]),
                     "sample {} of reaction {} is {:g}: cut the record before it or repair it", j,
                     r + 1, reaction[j]);
    }
  }
  SensorNoiseLevel noise = noise_.estimate(record.reactions, workspace);
  for (std::size_t r = 0; r < 2; ++r) {
    if (!std::isnan(options_.noise_rms[r]) && !record.reactions[r].empty()) {
      noise.rms[r] = options_.noise_rms[r];
    }
  }
  return noise;
}

// Quarters of 1/T: few contours serve all records of a length.
double ContourInversions::sigma_for(const ReactionPair& reactions,
                                    const SensorNoiseLevel& noise) const {
  if (truncation_ != Truncation::kShiftedContour) return 0.0;
  if (!std::isnan(options_.sigma)) return options_.sigma;
  const double duration = static_cast<double>(samples_) / sample_rate_;
  const double best = contour_of(basis_, duration, noise_share(reactions, noise));
  return std::round(4.0 * duration * best) / (4.0 * duration);
}

const JointInversion& ContourInversions::of(const ReactionPair& reactions,
                                            const SensorNoiseLevel& noise) const {
  const double sigma = sigma_for(reactions, noise);
  const std::lock_guard lock(mutex_);
  auto& slot = by_sigma_[sigma];
  if (!slot) {
    slot = std::make_unique<const JointInversion>(basis_, contact_, samples_, sample_rate_,
                                                  JointModel{.truncation = truncation_,
                                                             .sigma = sigma,
                                                             .support = support_,
                                                             .sensors = options_.sensors},
                                                  static_cast<std::size_t>(options_.points));
  }
  return *slot;
}

JointMethod ContourInversions::method(const ForcePrior& prior,
                                      const InversionOutputs& outputs) const {
  double limit = options_.band_limit;
  if (options_.limit_to_top_mode) {
    // The flank of the top resonance belongs to it.
    limit = 1.01 * *std::max_element(basis_.omega.begin(), basis_.omega.end()) /
            (2.0 * std::numbers::pi);
  }
  return {.prior = prior,
          .offset = options_.offset == "arrival" ? OffsetRule::kArrival : OffsetRule::kNone,
          .band_limit = limit,
          .outputs = outputs};
}

Estimate estimate_of(JointResult result, const JointInversion& inversion,
                     const SensorNoiseLevel& noise, const EstimationRecord& record) {
  Estimate estimate;
  estimate.result = std::move(result.identified);
  estimate.largest_transfer = inversion.largest_transfer();
  estimate.force_deviation = result.deviation.force;
  estimate.displacement_deviation = result.deviation.displacement;
  estimate.velocity_deviation = result.deviation.velocity;
  const double duration = static_cast<double>(inversion.samples()) / inversion.sample_rate();
  estimate.figures = {{"sigma", inversion.sigma()},
                      {"sigma_T", inversion.sigma() * duration},
                      {"noise_rms_1", noise.rms[0]},
                      {"noise_rms_2", noise.rms[1]},
                      {"noise_share_of_band", noise.noise_share},
                      {"offset_1", result.offset[0]},
                      {"offset_2", result.offset[1]},
                      {"force_deviation", result.deviation.force},
                      {"misfit_of_sides", result.misfit}};
  if (result.misfit > JointInversion::kContradiction) {
    estimate.warnings.push_back(fmt::format(
        "the reactions contradict each other {:.2g} times more than their noise: the model or the "
        "ends of the record limit the estimate, and its error bars are widened",
        std::sqrt(result.misfit)));
  }
  const bool both = !record.reactions[0].empty() && !record.reactions[1].empty();
  if (!both) {
    estimate.warnings.push_back(
        fmt::format("reaction {} is missing: the estimate rests on the other one alone",
                    record.reactions[0].empty() ? 1 : 2));
  }
  if (!noise.measured) {
    estimate.warnings.emplace_back(
        "the sample rate leaves no band above the modes to measure the noise in: 1 % of each "
        "reaction is supposed");
  }
  std::string warning = warning_of(estimate.result.choice);
  if (!warning.empty()) estimate.warnings.push_back(std::move(warning));
  return estimate;
}

}  // namespace modcal
