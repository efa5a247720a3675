#include "libinverse/joint/contour_inversions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libsim/base/error.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

// Noise over signal, the larger of both sides.
double noise_share(const ReactionPair& reactions, const SensorNoiseLevel& noise) {
  double share = 0.0;
  for (std::size_t r = 0; r < 2; ++r) {
    if (reactions[r].empty()) continue;
    const double rms = standard_deviation(reactions[r]);
    if (rms > 0.0) share = std::max(share, noise.rms[r] / rms);
  }
  return share;
}

}  // namespace

Truncation truncation_of(const std::string& name) {
  if (name == "shifted_contour") return Truncation::kShiftedContour;
  if (name == "transient") return Truncation::kTransient;
  MODCAL_REQUIRE(name == "wrapped",
                 "unknown truncation \"{}\": shifted_contour, transient or wrapped", name);
  return Truncation::kWrapped;
}

void JointOptions::require() const {
  truncation_of(truncation);
  MODCAL_REQUIRE(offset == "arrival" || offset == "none",
                 "unknown offset rule \"{}\": arrival or none", offset);
  MODCAL_REQUIRE(points >= 3 && points <= 1280, "{} points on the curve: 3 to 1280 are possible",
                 points);
  MODCAL_REQUIRE(std::isnan(sigma) || sigma > 0.0, "contour at {:g} 1/s must be > 0", sigma);
  MODCAL_REQUIRE(std::isnan(sigma) || truncation == "shifted_contour",
                 "sigma {:g} 1/s is for the shifted contour: leave it out with truncation \"{}\"",
                 sigma, truncation);
}

void JointOptions::visit(OptionVisitor& visitor) {
  visitor.text({.key = "truncation",
                .meaning = "what is done about the ends of the record: shifted_contour (at rest at "
                           "first), transient (any state at either end, unknowns) or wrapped "
                           "(nothing)",
                .choices = {"shifted_contour", "transient", "wrapped"}},
               truncation);
  visitor.number({.key = "sigma",
                  .meaning = "contour's distance from the frequency axis; auto: from length, noise "
                             "and damping, about 2 over the record's length",
                  .unit = "Hz",
                  .range = Range::positive(),
                  .word = "auto"},
                 sigma);
  visitor.text({.key = "offset",
                .meaning = "static level of the sensors; arrival: the mean before the first wave "
                           "arrives, for records that start at rest",
                .choices = {"arrival", "none"}},
               offset);
  for (std::size_t r = 0; r < 2; ++r) {
    visitor.number({.key = r == 0 ? "noise_rms1" : "noise_rms2",
                    .meaning = r == 0 ? "noise of one sample of the reaction at x = 0"
                                      : "noise of one sample of the reaction at x = L",
                    .unit = "N",
                    .range = Range::non_negative(),
                    .word = "measured"},
                   noise_rms[r]);
  }
  visitor.number({.key = "band_limit",
                  .meaning = "nothing is identified above this frequency",
                  .unit = "Hz",
                  .range = Range::positive(),
                  .word = "none"},
                 band_limit);
  visitor.flag({.key = "limit_to_top_mode",
                .meaning = "sharp band limit at the highest mode, in place of band_limit"},
               limit_to_top_mode);
  visitor.integer({.key = "points",
                   .meaning = "points on the curve of evidence over the parameter",
                   .range = Range::closed(3, 1280)},
                  points);
  transfer.visit(visitor);
  sensors.visit(visitor);
}

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

std::vector<Estimate> estimate_with(const JointInversion& inversion, const EstimationRecord& record,
                                    const SensorNoiseLevel& noise, const JointMethod& method,
                                    const char* side, const char* label) {
  JointWorkspace workspace;
  JointResult result;
  inversion.invert(record.reactions, noise, method, workspace, result);
  Estimate estimate;
  estimate.side = side;
  estimate.label = label;
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
  return {std::move(estimate)};
}

}  // namespace modcal
