#include "libinverse/observer/auto_estimator.hpp"

#include <cmath>
#include <utility>

#include "libinverse/observer/model_check.hpp"
#include "libsim/base/error.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {

using namespace observer;

namespace {

double square(double x) { return x * x; }

// A signal of both estimates with its deviation at every sample.
struct Combination {
  std::vector<double> samples, deviation;
};

Combination combination_of(std::span<const double> observed, const Reference& joint,
                           std::span<const double> errors, std::span<const double> deviation,
                           double error_square, bool beyond) {
  Combination result{combined(observed, joint, errors, beyond), {}};
  const double shared = sample_square(combined_errors(joint, errors, beyond), observed.size());
  const double share = estimate_share(joint, errors);
  for (const double d : deviation) {
    const double of_noise = std::max(0.0, d * d - error_square);
    result.deviation.push_back(std::sqrt(share * of_noise + shared));
  }
  return result;
}

class PreparedAuto final : public PreparedEstimator {
 public:
  PreparedAuto(const EstimationModel& model, const ModelBasedOptions& options,
               const ModelBasedEstimator& observer)
      : basis_(model.basis),
        contact_(model.contact),
        samples_(model.samples),
        sample_rate_(model.sample_rate),
        recorded_(model.recorded),
        bending_(model.bending),
        options_(options),
        observer_(observer) {}

  std::vector<Estimate> estimate(const EstimationRecord& record,
                                 const InversionMethod& method) const override {
    Estimate estimate = chosen(record);
    estimate.side = "auto";
    estimate.label = "joint or model-based, by evidence";
    InversionResult& signals = estimate.result;
    if (!method.outputs.force) signals.force.clear();
    if (!method.outputs.displacement) signals.displacement.clear();
    if (!method.outputs.velocity) signals.velocity.clear();
    return {std::move(estimate)};
  }

 private:
  Estimate chosen(const EstimationRecord& record) const {
    const auto& [left, right] = record.reactions;
    if (bending_.value_or(false)) {
      return joint_alone(joint_of(record),
                         "the ends feel the bending of the string, and the observer of friction "
                         "laws follows the tension alone");
    }
    try {
      ModelBasedResult model =
          observer_.estimate(basis_, contact_, sample_rate_, left, right, {}, recorded_, bending_);
      const Reference joint = held(model, model.joint.result.force, model.joint.force_variance,
                                   model.joint.force_excess);
      const std::vector<double> errors = errors_of(model.unaliased_force, joint, model);
      const double share = estimate_share(joint, errors);
      const double least = model.explained() ? kToldShare : kTrustedShare;
      if (share >= least) return both(model, errors, share);
      return joint_alone(
          std::move(model.joint),
          fmt::format("no friction law of the list explains the record (the best, {}, leaves a "
                      "misfit of {:.4g}, at most {:.4g} of a right one, and would have a share of "
                      "{:.2g} in the force)",
                      model.laws[0].law, model.steady_misfit, model.misfit_limit, share));
    } catch (const InvalidInput& refusal) {
      return joint_alone(joint_of(record), refusal.what());
    }
  }

  Estimate joint_of(const EstimationRecord& record) const {
    const EstimationModel model{basis_, contact_, samples_, sample_rate_, recorded_, bending_};
    return joint_estimate(model, record.reactions, options_.noise_rms);
  }

  // A signal of the joint estimate, weighted by its noise alone: what else that is off by speaks
  // for it.
  Reference held(const ModelBasedResult& model, const std::vector<double>& samples,
                 const std::vector<double>& variance, std::span<const double> excess) const {
    return {.samples = samples,
            .variance = variance,
            .sample_rate = sample_rate_,
            .band_limit = model.model_error.band_limit,
            .excess = excess};
  }

  static std::vector<double> errors_of(std::span<const double> observed, const Reference& joint,
                                       const ModelBasedResult& model) {
    return bin_errors(observed, band_errors(observed, joint), joint.sample_rate, model.explained());
  }

  static Estimate joint_alone(Estimate joint, const std::string& why) {
    joint.notes.push_back("the joint estimate is taken, which assumes no friction law: " + why);
    joint.figures.emplace_back("observer_share", 0.0);
    return joint;
  }

  Estimate both(ModelBasedResult& model, std::span<const double> force_errors, double share) const {
    Estimate result = std::move(model.joint);
    InversionResult& signals = result.result;
    const bool beyond = model.explained() && share >= kTrustedShare;
    const ModelError& error = model.model_error;
    Combination force =
        combination_of(model.unaliased_force,
                       held(model, signals.force, result.force_variance, result.force_excess),
                       force_errors, model.deviation.force, error.force_square, beyond);
    const Reference joint_velocity =
        held(model, signals.velocity, result.velocity_variance, result.velocity_excess);
    std::vector<double> errors = errors_of(model.velocity, joint_velocity, model);
    Combination velocity = combination_of(model.velocity, joint_velocity, errors,
                                          model.deviation.velocity, error.velocity_square, beyond);
    // An error of velocity is one of displacement, ω less.
    std::vector<double> variance = result.velocity_variance;
    for (std::size_t k = 1; k < errors.size(); ++k) {
      const double omega = 2.0 * std::numbers::pi * sample_rate_ * static_cast<double>(k) /
                           static_cast<double>(samples_);
      variance[k] /= omega * omega;
      errors[k] /= omega * omega;
    }
    signals.displacement = combined(
        model.displacement, held(model, signals.displacement, variance, {}), errors, beyond);
    result.unaliased_force = std::move(force.samples);
    signals.force = result.unaliased_force;
    result.band_limit = error.band_limit;
    if (beyond) {
      for (std::size_t k = 0; k < samples_; ++k) {
        signals.force[k] += model.force[k] - model.unaliased_force[k];
      }
      result.band_limit = std::numeric_limits<double>::quiet_NaN();
    }
    signals.velocity = std::move(velocity.samples);
    result.force_deviations = std::move(force.deviation);
    result.velocity_deviations = std::move(velocity.deviation);
    result.force_deviation = rms_of(result.force_deviations);
    result.velocity_deviation = rms_of(result.velocity_deviations);
    result.force_variance.clear();
    result.velocity_variance.clear();
    result.force_excess.clear();
    result.velocity_excess.clear();
    result.notes = {law_note(model),
                    fmt::format("the model-based estimate has a share of {:.3g} in the bins of the "
                                "force, the joint one the rest",
                                share)};
    result.figures.emplace_back("observer_share", share);
    result.figures.emplace_back("steady_misfit", model.steady_misfit);
    if (!model.explained()) {
      result.warnings.push_back(fmt::format(
          "no friction law of the list explains the record (misfit {:.4g}, at most {:.4g} of a "
          "right one), yet the best ({}) is closer to it than the noise of the joint estimate: "
          "compare with that one, and free what may differ (force_knots, velocity_knots, laws)",
          model.steady_misfit, model.misfit_limit, model.laws[0].law));
    }
    return result;
  }

  static double rms_of(std::span<const double> values) {
    double sum = 0.0;
    for (const double value : values) sum += square(value);
    return std::sqrt(sum / static_cast<double>(values.size()));
  }

  ModalBasis basis_;
  double contact_;
  std::size_t samples_;
  double sample_rate_;
  bool recorded_;
  std::optional<bool> bending_;
  ModelBasedOptions options_;
  ModelBasedEstimator observer_;
};

}  // namespace

std::shared_ptr<const PreparedEstimator> AutoEstimator::do_prepare(
    const EstimationModel& model) const {
  return std::make_shared<const PreparedAuto>(model, options_, observer_);
}

}  // namespace modcal
