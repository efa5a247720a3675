#include "libcalib/objectives/innovation_misfit.hpp"

#include <algorithm>
#include <cmath>

#include "libcalib/objectives/tuning.hpp"
#include "libinverse/observer/innovation_fit.hpp"
#include "libinverse/observer/model_based_estimator.hpp"
#include "libinverse/observer/observer_runs.hpp"
#include "libsim/base/error.hpp"
#include "libsim/signal/fft.hpp"
#include "libsim/signal/measurement.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

using observer::ObservedRecord;
using observer::ObserverParameters;

std::vector<double> samples_of(const CalibrationData& data, End end) {
  return RealFft(data.samples).inverse(data.reaction(end));
}

// Samples that no delay within the bounds brings to the end of the record.
std::size_t kept_samples(const CalibrationData& data, const ParameterSet& parameters) {
  double longest = std::abs(parameters.initial().sensors.delay);
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (type_of(parameters[i]).moves != Moves::kSensor) continue;
    if (parameters[i].index != Sensor::kDelay) continue;
    const Variable& variable = parameters[i].variable;
    longest = std::max({longest, std::abs(variable.lower), std::abs(variable.upper)});
  }
  if (longest == 0.0) return data.samples;
  const double lost = std::ceil(longest * data.sample_rate) + kShiftFaded;
  MODCAL_REQUIRE(2.0 * lost < static_cast<double>(data.samples),
                 "a delay of up to {:g} s leaves nothing of a record of {} samples: narrow its "
                 "range or take a longer record",
                 longest, data.samples);
  return data.samples - static_cast<std::size_t>(lost);
}

class InnovationFunction final : public ObjectiveFunction {
 public:
  InnovationFunction(const CalibrationData& data, ParameterSet parameters,
                     const InnovationMisfit::Options& options)
      : parameters_(std::move(parameters)),
        options_(options),
        sample_rate_(data.sample_rate),
        left_(samples_of(data, End::kLeft)),
        right_(samples_of(data, End::kRight)),
        kept_(kept_samples(data, parameters_)) {
    const ModelPoint& initial = parameters_.initial();
    const ModelBasedResult start =
        ModelBasedEstimator({.laws = {"exponential"}, .substeps = options.substeps, .rounds = 0})
            .estimate(initial.basis, initial.contact, sample_rate_, left(), right(initial.sensors));
    friction_ = start.parameters;
    negated_ = start.negated;
    static_force_ = friction_.sliding.dynamic_force + friction_.sliding.force_drop;
  }
  std::string_view name() const override { return "innovation_misfit"; }
  std::size_t dimension() const override { return parameters_.size(); }
  std::size_t residual_count() const override { return 2 * kept_; }
  Capabilities capabilities() const override { return {.residuals = true}; }

 private:
  std::span<const double> left() const { return std::span(left_).first(kept_); }

  // The reaction at x = L from what its sensor reads: R₂ = R₂'/S.
  std::vector<double> right(const Sensor& sensors) const {
    std::vector<double> samples = sensors.undone(right_, sample_rate_);
    samples.resize(kept_);
    return samples;
  }

  // The noise is read from the reactions as corrected, so that a gain scales it along with the
  // signal and ν/s stays in units of the noise measured: a gain is not paid for by its noise.
  ObservedRecord record_at(const ModelPoint& point) const {
    ObservedRecord record = observer::observe_record(point.basis, point.contact, sample_rate_,
                                                     left(), right(point.sensors));
    if (negated_) observer::negate(record);
    return record;
  }

  // Where the sensors may differ the level of R₂ as fitted at bind is that of another sensor: it is
  // read from the silent samples again.
  ObserverParameters fitted(const observer::ObserverRuns& runs, const ModelPoint& point) const {
    ObserverParameters start = friction_;
    start.contact = point.contact;
    start.level_growth = point.sensors.corner;
    const ObservedRecord& record = runs.record();
    double deviation[2] = {observer::offset_deviation(record, 0),
                           observer::offset_deviation(record, 1)};
    if (point.sensors.may_differ()) {
      start.offset[1] = record.offset[1];
      deviation[1] = observer::silent_deviation(record, End::kRight, start.bow_velocity);
    }
    const observer::ParameterSpace space(start,
                                         observer::basic_parameters(static_force_, deviation));
    if (options_.iterations == 0) return start;
    observer::FitLimits limits;
    limits.iterations = static_cast<std::size_t>(options_.iterations);
    return space.at(observer::fit_innovations(runs, space, {0}, limits).x);
  }

  void do_evaluate(std::span<const double> x, const ObjectiveOutputs& outputs) const override {
    const ModelPoint point = parameters_.model(x);
    const ObservedRecord record = record_at(point);
    const observer::ObserverRuns runs(
        record, {options_.force_noise * static_force_},
        {.coarse = static_cast<std::size_t>(options_.substeps), .fine = 16});
    const observer::Innovations innovations =
        runs.innovations(fitted(runs, point), {0}, record.samples());
    double value = 0.0;
    std::size_t row = 0;
    for (const auto& scaled : innovations.scaled) {
      for (const double innovation : scaled) {
        const double cost = observer::huber(innovation);
        value += cost;
        if (outputs.residuals) {
          outputs.residuals[row++] = std::copysign(std::sqrt(2.0 * cost), innovation);
        }
      }
    }
    if (outputs.value) *outputs.value = value;
  }

  ParameterSet parameters_;
  InnovationMisfit::Options options_;
  double sample_rate_;
  std::vector<double> left_, right_;
  std::size_t kept_;             // samples predicted
  ObserverParameters friction_;  // fitted with the initial model
  bool negated_ = false;
  double static_force_ = 0.0;
};

}  // namespace

void InnovationMisfit::Options::visit(OptionVisitor& visitor) {
  visitor("substeps", "steps of the observer per sample", {.range = Range::closed(1, 64)},
          substeps);
  visitor("iterations",
          "steps of the friction's fit in every evaluation; 0: as fitted with "
          "the initial model",
          {.range = Range::closed(0, 50)}, iterations);
  visitor("force_noise",
          "noise of the force that the observer allows for, relative to the "
          "static friction force",
          {.range = Range::positive()}, force_noise);
}

InnovationMisfit::InnovationMisfit(const Options& options) : options_(options) {
  MODCAL_REQUIRE(options.substeps >= 1, "{} substeps: at least one is needed", options.substeps);
  MODCAL_REQUIRE(options.iterations >= 0, "iterations {} must be >= 0", options.iterations);
  MODCAL_REQUIRE(options.force_noise > 0.0 && std::isfinite(options.force_noise),
                 "force noise {:g} must be > 0", options.force_noise);
}

Response InnovationMisfit::response(Moves /*what*/) const { return Response::kMoves; }

std::unique_ptr<const ObjectiveFunction> InnovationMisfit::do_bind(
    const CalibrationData& data, const ParameterSet& parameters) const {
  MODCAL_REQUIRE(data.has_both(),
                 "objective \"innovation_misfit\" predicts both reactions: the {} "
                 "one is missing",
                 data.has(End::kLeft) ? "right" : "left");
  return std::make_unique<InnovationFunction>(data, parameters, options_);
}

}  // namespace modcal
