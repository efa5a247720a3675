#include "libinverse/joint/joint_estimator.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>

#include "libinverse/joint/priors.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

Truncation truncation_of(const std::string& name) {
  if (name == "shifted_contour") return Truncation::kShiftedContour;
  if (name == "transient") return Truncation::kTransient;
  MODCAL_REQUIRE(name == "wrapped",
                 "unknown truncation \"{}\": shifted_contour, transient or wrapped", name);
  return Truncation::kWrapped;
}

void require_options(const JointOptions& options) {
  truncation_of(options.truncation);
  MODCAL_REQUIRE(options.offset == "arrival" || options.offset == "none",
                 "unknown offset rule \"{}\": arrival or none", options.offset);
  MODCAL_REQUIRE(options.points >= 3 && options.points <= 1280,
                 "{} points on the curve: 3 to 1280 are possible", options.points);
  MODCAL_REQUIRE(std::isnan(options.sigma) || options.sigma > 0.0,
                 "contour at {:g} 1/s must be > 0", options.sigma);
  MODCAL_REQUIRE(std::isnan(options.sigma) || options.truncation == "shifted_contour",
                 "sigma {:g} 1/s is for the shifted contour: leave it out with truncation \"{}\"",
                 options.sigma, options.truncation);
}

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

// Joint inversions of one model, one for each contour that records have asked for.
class Inversions {
 public:
  Inversions(const EstimationModel& model, const JointOptions& options)
      : basis_(model.basis),
        contact_(model.contact),
        samples_(model.samples),
        sample_rate_(model.sample_rate),
        options_(options),
        truncation_(truncation_of(options.truncation)),
        remainder_(options.transfer.has_remainder(model.recorded)),
        noise_(basis_, contact_, samples_, sample_rate_, remainder_, options.transfer.bending,
               options.sensors) {}

  SensorNoiseLevel noise_of(const EstimationRecord& record) const {
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

  const JointInversion& of(const ReactionPair& reactions, const SensorNoiseLevel& noise) const {
    const double duration = static_cast<double>(samples_) / sample_rate_;
    double sigma = 0.0;
    if (truncation_ == Truncation::kShiftedContour) {
      // Quarters of 1/T: few contours serve all records of a length.
      sigma = !std::isnan(options_.sigma)
                  ? options_.sigma
                  : std::round(4.0 * duration *
                               contour_of(basis_, duration, noise_share(reactions, noise))) /
                        (4.0 * duration);
    }
    const std::lock_guard lock(mutex_);
    auto& slot = by_sigma_[sigma];
    if (!slot) {
      slot = std::make_unique<const JointInversion>(basis_, contact_, samples_, sample_rate_,
                                                    JointModel{.truncation = truncation_,
                                                               .sigma = sigma,
                                                               .static_remainder = remainder_,
                                                               .bending = options_.transfer.bending,
                                                               .sensors = options_.sensors},
                                                    static_cast<std::size_t>(options_.points));
    }
    return *slot;
  }

  JointMethod method(const ForcePrior& prior, const InversionOutputs& outputs) const {
    double limit = options_.band_limit;
    if (options_.limit_to_top_mode) {
      // The flank of the top resonance belongs to it.
      limit =
          1.01 * *std::max_element(basis_.omega.begin(), basis_.omega.end()) / 6.283185307179586;
    }
    return {.prior = prior,
            .offset = options_.offset == "arrival" ? OffsetRule::kArrival : OffsetRule::kNone,
            .band_limit = limit,
            .outputs = outputs};
  }

  double sample_rate() const { return sample_rate_; }
  std::size_t samples() const { return samples_; }

 private:
  ModalBasis basis_;
  double contact_;
  std::size_t samples_;
  double sample_rate_;
  JointOptions options_;
  Truncation truncation_;
  bool remainder_;
  SensorNoise noise_;
  mutable std::mutex mutex_;
  mutable std::map<double, std::unique_ptr<const JointInversion>> by_sigma_;
};

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

class PreparedJoint final : public PreparedEstimator {
 public:
  PreparedJoint(const EstimationModel& model, const JointOptions& options,
                std::shared_ptr<const ForcePrior> prior)
      : inversions_(model, options), prior_(std::move(prior)) {}

  std::vector<Estimate> estimate(const EstimationRecord& record,
                                 const InversionMethod& method) const override {
    const SensorNoiseLevel noise = inversions_.noise_of(record);
    const JointInversion& inversion = inversions_.of(record.reactions, noise);
    JointWorkspace workspace;
    JointResult result;
    inversion.invert(record.reactions, noise, inversions_.method(*prior_, method.outputs),
                     workspace, result);
    std::vector<Estimate> estimates;
    estimates.push_back(estimate_of(std::move(result), inversion, noise, record));
    estimates[0].side = "joint";
    estimates[0].label = "from both reactions";
    return estimates;
  }

 private:
  Inversions inversions_;
  std::shared_ptr<const ForcePrior> prior_;
};

class PreparedLimit final : public PreparedEstimator {
 public:
  PreparedLimit(const EstimationModel& model, const JointOptions& options, double bandwidth)
      : inversions_(model, options), bandwidth_(bandwidth) {}

  std::vector<Estimate> estimate(const EstimationRecord& record,
                                 const InversionMethod& method) const override {
    MODCAL_REQUIRE(record.true_force.size() == inversions_.samples(),
                   "the linear limit needs the true force: it exists for simulated records only");
    SensorNoiseLevel noise;
    noise.measured = true;
    for (std::size_t r = 0; r < 2; ++r) {
      const double stated = record.stated_noise[r];
      if (std::isfinite(stated)) noise.rms[r] = stated;
    }
    const JointInversion& inversion = inversions_.of(record.reactions, noise);
    const std::vector<double> spectrum = true_spectrum(record.true_force, inversion.sigma());
    JointMethod how = inversions_.method(unused_, method.outputs);
    how.known_variance = spectrum;
    JointWorkspace workspace;
    JointResult result;
    inversion.invert(record.reactions, noise, how, workspace, result);
    std::vector<Estimate> estimates;
    estimates.push_back(estimate_of(std::move(result), inversion, noise, record));
    estimates[0].side = "linear_limit";
    estimates[0].label = "linear limit (true spectra known)";
    return estimates;
  }

 private:
  // |F_k|² of the weighted force over the weights' power, smoothed.
  std::vector<double> true_spectrum(std::span<const double> force, double sigma) const {
    const double rate = inversions_.sample_rate();
    std::vector<double> weighted(force.size());
    double power = 0.0;
    for (std::size_t j = 0; j < force.size(); ++j) {
      const double weight = std::exp(-sigma * static_cast<double>(j) / rate);
      weighted[j] = force[j] * weight;
      power += weight * weight;
    }
    const RealFft fft(force.size());
    const std::vector<Complex> spectrum = fft.forward(weighted);
    std::vector<double> variance(spectrum.size()), scratch(spectrum.size());
    for (std::size_t k = 0; k < variance.size(); ++k) variance[k] = std::norm(spectrum[k]) / power;
    const double bins = bandwidth_ * static_cast<double>(force.size()) / rate;
    smooth_power(variance, scratch, std::max(1.0, 0.25 * bins), 0.0);
    return variance;
  }

  Inversions inversions_;
  double bandwidth_;
  FlatPrior unused_{FlatPrior::Options{}};
};

}  // namespace

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

void JointEstimator::Options::visit(OptionVisitor& visitor) {
  joint.visit(visitor);
  visitor.plugin({.key = "prior", .meaning = "what is supposed about the spectrum of the force"},
                 prior);
}

JointEstimator::JointEstimator(const Options& options)
    : joint_(options.joint), prior_(options.prior.make()) {
  require_options(joint_);
}

std::shared_ptr<const PreparedEstimator> JointEstimator::do_prepare(
    const EstimationModel& model) const {
  return std::make_shared<const PreparedJoint>(model, joint_, prior_);
}

void LinearLimitEstimator::Options::visit(OptionVisitor& visitor) {
  joint.visit(visitor);
  visitor.number({.key = "bandwidth",
                  .meaning = "full width over which the true spectrum is smoothed",
                  .unit = "Hz",
                  .range = Range::positive()},
                 bandwidth);
}

LinearLimitEstimator::LinearLimitEstimator(const Options& options)
    : joint_(options.joint), bandwidth_(options.bandwidth) {
  require_options(joint_);
  MODCAL_REQUIRE(bandwidth_ > 0.0, "bandwidth {:g} Hz must be > 0", bandwidth_);
}

std::shared_ptr<const PreparedEstimator> LinearLimitEstimator::do_prepare(
    const EstimationModel& model) const {
  return std::make_shared<const PreparedLimit>(model, joint_, bandwidth_);
}

}  // namespace modcal
