#include "libcalib/objectives/joint_likelihood.hpp"

#include <cmath>
#include <mutex>
#include <numbers>
#include <optional>

#include "libcalib/likelihood/all_records.hpp"
#include "libcalib/likelihood/pluck/pluck_likelihood.hpp"
#include "libcalib/likelihood/projected_likelihood.hpp"
#include "libcalib/likelihood/records/noise_level.hpp"
#include "libcalib/likelihood/records/record_options.hpp"
#include "libcalib/optimizers/staged/continuation.hpp"
#include "libcalib/parameters/stiff_string_fit.hpp"
#include "libcalib/problem.hpp"
#include "libcalib/problem/evaluator.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

// Factors that turn the columns of a record, by the coordinates, into those of its parameters.
std::vector<double> column_units(const ParameterSet& parameters, std::span<const double> x,
                                 std::span<const std::size_t> places) {
  std::vector<double> units;
  for (const std::size_t i : places) {
    units.push_back(std::numbers::sqrt2 / type_of(parameters[i]).slope(x[i]));
  }
  return units;
}

// What a stage tells of the parameters, before there is an estimate.
ContinuationResult told_by(const ModelPoint& model, const ModelPoint& initial) {
  ContinuationResult found{.model = model};
  const std::size_t modes = model.basis.size();
  const StiffStringFit law = fit_stiff_string(frequencies_of(model.basis));
  found.found_law = {law.fundamental, law.inharmonicity, {}};
  found.damping = model.basis.zeta.front() / initial.basis.zeta.front();
  const double top = model.basis.zeta.back() / initial.basis.zeta.back();
  if (modes > 1) {
    found.damping_power = std::log(top / found.damping) / std::log(static_cast<double>(modes));
  }
  return found;
}

// A parameter of the estimate in its unit; those of the laws stand beside the model.
double value_in(const ContinuationResult& found, const ParameterName& name) {
  const bool told = name.record < found.values.size();
  if (name.record > 0 && told) {
    const RecordValues& own = found.values[name.record];
    if (name.kind == ParameterKind::kContact) return found.contacts[name.record];
    if (name.kind == ParameterKind::kDampingFactor) return own.damping;
    if (name.kind == ParameterKind::kSensor) return sensor_value(name.index, own.sensors);
  }
  if (name.kind == ParameterKind::kFundamental) return found.found_law.fundamental;
  if (name.kind == ParameterKind::kInharmonicity) return found.found_law.inharmonicity;
  if (name.kind == ParameterKind::kDampingFactor) return found.damping;
  if (name.kind == ParameterKind::kDampingPower) return found.damping_power;
  return value_of(name, found.model);
}

std::vector<double> values_of(const ContinuationResult& found, const ParameterSet& parameters) {
  std::vector<double> x;
  for (std::size_t i = 0; i < parameters.size(); ++i) x.push_back(value_in(found, parameters[i]));
  return x;
}

// Noise stated with the record, else of a stroke with the objective.
std::array<double, 2> noise_of(const CalibrationRecord& record,
                               const JointLikelihood::Options& options) {
  if (record.pluck) return record.noise;
  return {std::isnan(record.noise[0]) ? options.left_noise : record.noise[0],
          std::isnan(record.noise[1]) ? options.right_noise : record.noise[1]};
}

using Likelihood = std::unique_ptr<const RecordLikelihood>;

Likelihood likelihood_of(const CalibrationRecord& record, const ModelPoint& initial,
                         const JointLikelihood::Options& options) {
  const NoisyRecords noisy =
      NoisyRecords::of_data(record.data, initial.basis, noise_of(record, options));
  const double highest =
      likelihood_band(initial, options.highest_frequency, record.data.sample_rate);
  WhitenedRecord whitened = WhitenedRecord::of(noisy, options.damping, highest);
  if (record.pluck) return std::make_unique<PluckLikelihood>(std::move(whitened));
  const ProjectedLikelihood whole(std::move(whitened));
  return std::make_unique<StrokeLikelihood>(whole, whole);
}

// Records are independent: their values, slopes and informations add, their residuals stand one
// after the other.
class JointLikelihoodFunction final : public ObjectiveFunction {
 public:
  JointLikelihoodFunction(Problem problem, ParameterSet parameters,
                          const JointLikelihood::Options& options)
      : problem_(std::move(problem)), parameters_(std::move(parameters)), options_(options) {}
  std::string_view name() const override { return "joint_likelihood"; }
  std::size_t dimension() const override { return parameters_.size(); }
  std::size_t residual_count() const override {
    std::size_t count = 0;
    for (const Likelihood& record : likelihoods()) count += record->residual_count();
    return count;
  }
  Capabilities capabilities() const override {
    return {.gradient = true,
            .least_squares = true,
            .information = true,
            .damped = true,
            .schedule = options_.damping == 0.0};
  }
  std::unique_ptr<const ObjectiveFunction> damped(double sigma) const override {
    JointLikelihood::Options options = options_;
    options.damping += sigma;
    return std::make_unique<JointLikelihoodFunction>(problem_, parameters_, options);
  }
  StopReason follow_schedule(Evaluator& evaluator, const ScheduleOptions& options) const override;
  // Made when they are first asked for: a schedule of stages has likelihoods of its own.
  std::span<const Likelihood> likelihoods() const {
    std::call_once(made_, [this] {
      std::vector<Likelihood> made;
      for (const CalibrationRecord& record : problem_.records) {
        made.push_back(likelihood_of(record, parameters_.initial(), options_));
      }
      likelihoods_ = std::move(made);
    });
    return likelihoods_;
  }

 private:
  void do_evaluate(std::span<const double> x, const ObjectiveOutputs& outputs) const override {
    const auto n = static_cast<Eigen::Index>(dimension());
    if (outputs.value) *outputs.value = 0.0;
    if (outputs.gradient) std::fill_n(outputs.gradient, dimension(), 0.0);
    for (Eigen::MatrixXd* matrix : {outputs.information, outputs.noise}) {
      if (matrix) matrix->setZero(n, n);
    }
    std::size_t row = 0;
    for (std::size_t r = 0; r < likelihoods().size(); ++r) {
      add_record(x, r, row, outputs);
      row += likelihoods()[r]->residual_count();
    }
  }

  // Its residuals begin at `row`.
  void add_record(std::span<const double> x, std::size_t record, std::size_t row,
                  const ObjectiveOutputs& outputs) const {
    const RecordLikelihood& likelihood = *likelihoods()[record];
    const ModelPoint point = parameters_.model(x, record);
    const bool slopes = outputs.gradient || outputs.jacobian || outputs.information;
    const LikelihoodColumns columns = slopes ? parameters_.columns(x, record) : LikelihoodColumns{};
    std::vector<double> residuals(outputs.residuals ? likelihood.residual_count() : 0);
    Eigen::MatrixXd jacobian;
    const bool slope_alone =
        outputs.gradient && !outputs.information && !outputs.residuals && !outputs.jacobian;
    const LikelihoodPoint at =
        slope_alone ? likelihood.slope(point, columns)
                    : likelihood.evaluate(point, columns,
                                          {.residuals = outputs.residuals ? &residuals : nullptr,
                                           .jacobian = outputs.jacobian ? &jacobian : nullptr});
    if (outputs.value) *outputs.value += at.cost;
    const std::span<const std::size_t> places = parameters_.places(record);
    const std::vector<double> units = column_units(parameters_, x, places);
    for (std::size_t i = 0; outputs.gradient && i < places.size(); ++i) {
      outputs.gradient[places[i]] +=
          std::numbers::sqrt2 * units[i] * at.slope[static_cast<Eigen::Index>(i)];
    }
    add_information(point, columns, at, units, record, outputs);
    for (std::size_t j = 0; j < residuals.size(); ++j) {
      outputs.residuals[row + j] = std::numbers::sqrt2 * residuals[j];
    }
    const std::size_t width = dimension();
    for (Eigen::Index j = 0; j < jacobian.rows(); ++j) {
      double* target = outputs.jacobian + (row + static_cast<std::size_t>(j)) * width;
      std::fill_n(target, width, 0.0);
      for (std::size_t i = 0; i < places.size(); ++i) {
        target[places[i]] = units[i] * jacobian(j, static_cast<Eigen::Index>(i));
      }
    }
  }

  // In the units of the parameters, which hold √2 of each residual.
  void add_information(const ModelPoint& point, const LikelihoodColumns& columns,
                       const LikelihoodPoint& at, const std::vector<double>& units,
                       std::size_t record, const ObjectiveOutputs& outputs) const {
    const std::span<const std::size_t> places = parameters_.places(record);
    const auto add = [&](const Eigen::MatrixXd& part, Eigen::MatrixXd& sum) {
      for (std::size_t i = 0; i < places.size(); ++i) {
        for (std::size_t j = 0; j < places.size(); ++j) {
          const auto a = static_cast<Eigen::Index>(i), b = static_cast<Eigen::Index>(j);
          sum(static_cast<Eigen::Index>(places[i]), static_cast<Eigen::Index>(places[j])) +=
              units[i] * part(a, b) * units[j];
        }
      }
    };
    if (outputs.information) add(at.information, *outputs.information);
    if (outputs.noise) {
      add(likelihoods()[record]->noise_information(point, columns), *outputs.noise);
    }
  }

  Problem problem_;
  ParameterSet parameters_;
  JointLikelihood::Options options_;
  mutable std::once_flag made_;
  mutable std::vector<Likelihood> likelihoods_;
};

StopReason JointLikelihoodFunction::follow_schedule(Evaluator& evaluator,
                                                    const ScheduleOptions& schedule) const {
  const ParameterOptions& free = problem_.parameters;
  ContinuationOptions options{.frequencies = free.every_frequency(),
                              .law_width = free.law_width,
                              .highest_frequency = options_.highest_frequency,
                              .left_noise = options_.left_noise,
                              .right_noise = options_.right_noise,
                              .unknowns = free.unknowns,
                              .restarts = schedule.restarts,
                              .ranges = free.ranges};
  if (!free.contact) options.unknowns.fixed.push_back({.parameter = "x_c"});
  options.reached = [&](const ModelPoint& model, double chi2) {
    evaluator.answer(values_of(told_by(model, problem_.model), parameters_), chi2);
  };
  std::vector<CalibrationData> strokes;
  std::vector<PluckRecord> plucks;
  for (const CalibrationRecord& record : problem_.records) {
    if (record.pluck) plucks.push_back({record.data, record.noise});
    if (!record.pluck) strokes.push_back(record.data);
  }
  const std::array<double, 2> noise = noise_of(problem_.records.front(), options_);
  options.left_noise = noise[0];
  options.right_noise = noise[1];
  ContinuationResult found =
      strokes.size() == 1 && plucks.empty()
          ? calibrate_by_continuation(problem_.model, strokes.front(), options, &evaluator)
          : calibrate_records(problem_.model, strokes, options, plucks, &evaluator);
  evaluator.answer(values_of(found, parameters_), found.chi2);
  for (const FitStage& stage : found.stages) evaluator.end_stage(stage);
  const StopReason reason = found.fits ? StopReason::kConverged : StopReason::kNoProgress;
  evaluator.report(std::make_shared<const ContinuationResult>(std::move(found)));
  return reason;
}

}  // namespace

void JointLikelihood::Options::visit(OptionVisitor& visitor) {
  visitor("damping",
          "the records are multiplied by exp(-damping t): wide basins; 0: the "
          "whole record, end state projected out",
          {.unit = "Hz", .range = Range::non_negative()}, damping);
  visit_record_options(visitor, highest_frequency, left_noise, right_noise);
}

JointLikelihood::JointLikelihood(const Options& options) : options_(options) {
  MODCAL_REQUIRE(options.damping >= 0.0, "damping {:g} 1/s must be >= 0", options.damping);
}

void JointLikelihood::require_record(const ModalBasis& basis, double sample_rate,
                                     std::size_t samples) const {
  likelihood_band({basis, 0.0}, options_.highest_frequency, sample_rate);
  require_noise_known({options_.left_noise, options_.right_noise}, basis, sample_rate, samples);
}

std::unique_ptr<const ObjectiveFunction> JointLikelihood::bind_problem(
    const Problem& problem, const ParameterSet& parameters) const {
  return std::make_unique<JointLikelihoodFunction>(problem, parameters, options_);
}

std::unique_ptr<const ObjectiveFunction> JointLikelihood::do_bind(
    const CalibrationData& data, const ParameterSet& parameters) const {
  auto function = std::make_unique<JointLikelihoodFunction>(
      Problem{.model = parameters.initial(), .records = {{.data = data}}}, parameters, options_);
  // An undamped mode and the like, before any search.
  function->likelihoods().front()->slope(parameters.initial(), LikelihoodColumns{});
  return function;
}

}  // namespace modcal
