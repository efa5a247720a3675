#include "libinverse/joint/joint_estimators.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <mutex>
#include <numbers>
#include <utility>

#include "libinverse/joint/force_prior.hpp"
#include "libinverse/joint/tuning.hpp"
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

// What the model says of the ends holds where the estimator says nothing.
StringSupport support_of(const EstimationModel& model, const SupportOptions& stated) {
  StringSupport support = stated.support(model.recorded);
  if (stated.bending() || !model.bending) return support;
  support.bending = *model.bending;
  support.bending_open = false;
  return support;
}

// Prepares an inversion when a record asks for its contour; safe to use from several threads.
class PreparedJoint : public PreparedEstimator {
 public:
  PreparedJoint(const EstimationModel& model, const JointOptions& options,
                std::shared_ptr<const ForcePrior> prior)
      : basis_(model.basis),
        contact_(model.contact),
        samples_(model.samples),
        sample_rate_(model.sample_rate),
        options_(options),
        recorded_(model.recorded),
        arrival_(first_arrivals(basis_, contact_, options.sensors)),
        support_(support_of(model, options.transfer)),
        noise_(basis_, contact_, samples_, sample_rate_, support_, options.sensors),
        prior_(std::move(prior)) {}

  std::vector<Estimate> estimate(const EstimationRecord& record,
                                 const InversionMethod& method) const override {
    SensorNoiseLevel noise = noise_of(record);
    const RecordEnds ends = ends_of(record.reactions, noise);
    if (recorded_ && noise.measured && ends.at_rest) noise = lowered(record.reactions, noise);
    JointMethod how = this->method(method.outputs, ends);
    how.variances = method.variances;
    std::vector<Estimate> estimates = estimate_with(of(record.reactions, noise, ends), record,
                                                    noise, how, "joint", "from both reactions");
    report_ends(ends, estimates[0]);
    if (limited_by_default()) {
      estimates[0].notes.push_back(fmt::format(
          "the force is identified up to {:.5g} Hz, {} modes below the highest of {}, next to "
          "which "
          "the resonance of the next one is missing; its deviation is that of the part below; "
          "band_limit states another frequency",
          how.band_limit, modes_kept_off(), basis_.size()));
    }
    return estimates;
  }

 protected:
  std::size_t samples() const { return samples_; }
  double sample_rate() const { return sample_rate_; }

  struct RecordEnds {
    Truncation truncation;
    OffsetRule offset;
    bool at_rest;  // at first
  };
  // As stated, else what suits the record: unknown ends for those of real strings, which cost a
  // few times as much and leave nothing of the wrap, and for one reaction, whose H_r has zeros
  // between its poles, lines of what wraps around; else the contour, where the record permits it.
  RecordEnds ends_of(const ReactionPair& reactions, const SensorNoiseLevel& noise) const {
    const bool both = !reactions[0].empty() && !reactions[1].empty();
    const bool at_rest = record_start(reactions, noise.rms, arrival_, basis_.frequency(0),
                                      sample_rate_) == RecordStart::kRest;
    const auto stated = truncation_of(options_.truncation);
    Truncation truncation = stated.value_or(Truncation::kTransient);
    const bool contour = (both && at_rest && !recorded_) || !std::isnan(options_.sigma);
    if (!stated && contour) truncation = Truncation::kShiftedContour;
    const bool level_known = truncation == Truncation::kShiftedContour || (!stated && at_rest);
    return {truncation, level_known ? offset_rule_of(options_.offset) : OffsetRule::kNone, at_rest};
  }

  // The inversion on the contour that suits the record, see contour_of.
  const JointInversion& of(const ReactionPair& reactions, const SensorNoiseLevel& noise,
                           const RecordEnds& ends) const {
    return at(ends.truncation, sigma_for(reactions, noise, ends.truncation));
  }

  const JointInversion& at(Truncation truncation, double sigma) const {
    const std::lock_guard lock(mutex_);
    auto& slot = prepared_[{truncation, sigma}];
    if (!slot) {
      slot = std::make_unique<const JointInversion>(basis_, contact_, samples_, sample_rate_,
                                                    JointModel{.truncation = truncation,
                                                               .sigma = sigma,
                                                               .support = support_,
                                                               .sensors = options_.sensors},
                                                    static_cast<std::size_t>(options_.points));
    }
    return *slot;
  }

  JointMethod method(const InversionOutputs& outputs, const RecordEnds& ends) const {
    double limit = options_.band_limit;
    if (limited_by_default()) {
      limit = basis_.frequency(basis_.size() - 1 - modes_kept_off());
    } else if (options_.limit_to_top_mode) {
      // The flank of the top resonance belongs to it.
      limit = 1.01 * *std::max_element(basis_.omega.begin(), basis_.omega.end()) /
              (2.0 * std::numbers::pi);
    }
    return {.prior = *prior_, .offset = ends.offset, .band_limit = limit, .outputs = outputs};
  }

 private:
  void report_ends(const RecordEnds& ends, Estimate& estimate) const {
    if (ends.at_rest) return;
    if (ends.truncation == Truncation::kTransient) {
      estimate.notes.emplace_back(
          "nothing shows that the record starts at rest: the mean of the force, which sensors do "
          "not "
          "give, is left out");
    } else if (ends.truncation == Truncation::kShiftedContour) {
      estimate.warnings.emplace_back(
          "nothing shows that the record starts at rest, as the shifted contour supposes: "
          "truncation transient takes any state");
    }
  }

  // What lies above the modes of a real string the data do not tell.
  bool limited_by_default() const {
    return recorded_ && std::isnan(options_.band_limit) && !options_.limit_to_top_mode;
  }
  std::size_t modes_kept_off() const { return std::min<std::size_t>(3, basis_.size() - 1); }

  // What is above the modes of a real string is no noise alone.
  SensorNoiseLevel lowered(const ReactionPair& reactions, const SensorNoiseLevel& noise) const {
    JointWorkspace workspace;
    const double duration = static_cast<double>(samples_) / sample_rate_;
    SensorNoiseLevel result =
        at(Truncation::kShiftedContour, kNoiseContour / duration)
            .lowered_noise(reactions, noise, offset_rule_of(options_.offset), workspace);
    for (std::size_t r = 0; r < 2; ++r) {
      if (!std::isnan(options_.noise_rms[r])) result.rms[r] = noise.rms[r];
    }
    return result;
  }

  // As stated in the options, else measured.
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

  // Quarters of 1/T: few contours serve all records of a length.
  double sigma_for(const ReactionPair& reactions, const SensorNoiseLevel& noise,
                   Truncation truncation) const {
    if (truncation != Truncation::kShiftedContour) return 0.0;
    if (!std::isnan(options_.sigma)) return options_.sigma;
    const double duration = static_cast<double>(samples_) / sample_rate_;
    const double best = contour_of(basis_, duration, noise_share(reactions, noise));
    return std::round(4.0 * duration * best) / (4.0 * duration);
  }

  ModalBasis basis_;
  double contact_;
  std::size_t samples_;
  double sample_rate_;
  JointOptions options_;
  bool recorded_;
  std::array<double, 2> arrival_;
  StringSupport support_;
  SensorNoise noise_;
  std::shared_ptr<const ForcePrior> prior_;
  mutable std::mutex mutex_;
  mutable std::map<std::pair<Truncation, double>, std::unique_ptr<const JointInversion>> prepared_;
};

class PreparedLimit final : public PreparedJoint {
 public:
  PreparedLimit(const EstimationModel& model, const JointOptions& options, double bandwidth)
      : PreparedJoint(model, options, std::make_shared<const FlatPrior>(FlatPrior::Options{})),
        bandwidth_(bandwidth) {}

  std::vector<Estimate> estimate(const EstimationRecord& record,
                                 const InversionMethod& method) const override {
    MODCAL_REQUIRE(record.true_force.size() == samples(),
                   "the linear limit needs the true force: it exists for simulated records only");
    SensorNoiseLevel noise;
    noise.measured = true;
    for (std::size_t r = 0; r < 2; ++r) {
      const double stated = record.stated_noise[r];
      if (std::isfinite(stated)) noise.rms[r] = stated;
    }
    const RecordEnds ends = ends_of(record.reactions, noise);
    const JointInversion& inversion = of(record.reactions, noise, ends);
    const std::vector<double> spectrum = true_spectrum(record.true_force, inversion.sigma());
    JointMethod how = this->method(method.outputs, ends);
    how.known_variance = spectrum;
    return estimate_with(inversion, record, noise, how, "linear_limit",
                         "linear limit (true spectra known)");
  }

 private:
  // |F_k|² of the weighted force over the weights' power, smoothed.
  std::vector<double> true_spectrum(std::span<const double> force, double sigma) const {
    const double rate = sample_rate();
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

  double bandwidth_;
};

}  // namespace

void JointEstimator::Options::visit(OptionVisitor& visitor) {
  joint.visit(visitor);
  visitor("prior", "what is supposed about the spectrum of the force", prior);
}

JointEstimator::JointEstimator(const Options& options)
    : joint_(options.joint), prior_(options.prior.make()) {
  joint_.require();
}

std::shared_ptr<const PreparedEstimator> JointEstimator::do_prepare(
    const EstimationModel& model) const {
  return std::make_shared<const PreparedJoint>(model, joint_, prior_);
}

void LinearLimitEstimator::Options::visit(OptionVisitor& visitor) {
  joint.visit(visitor);
  visitor("bandwidth", "full width over which the true spectrum is smoothed",
          {.unit = "Hz", .range = Range::positive()}, bandwidth);
}

LinearLimitEstimator::LinearLimitEstimator(const Options& options)
    : joint_(options.joint), bandwidth_(options.bandwidth) {
  joint_.require();
  MODCAL_REQUIRE(bandwidth_ > 0.0, "bandwidth {:g} Hz must be > 0", bandwidth_);
}

std::shared_ptr<const PreparedEstimator> LinearLimitEstimator::do_prepare(
    const EstimationModel& model) const {
  return std::make_shared<const PreparedLimit>(model, joint_, bandwidth_);
}

}  // namespace modcal
