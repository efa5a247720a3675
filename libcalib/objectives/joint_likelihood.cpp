#include "libcalib/objectives/joint_likelihood.hpp"

#include <numbers>

#include "libcalib/optimizers/staged/continuation.hpp"
#include "libcalib/likelihood/noise_level.hpp"
#include "libcalib/likelihood/projected_likelihood.hpp"
#include "libcalib/likelihood/record_options.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

LikelihoodColumns columns_of(const ParameterSet& parameters, std::span<const double> x,
                             const ModelPoint& point) {
  LikelihoodColumns columns{.count = parameters.size()};
  std::vector<std::vector<ColumnShare>> by_mode(point.basis.size());
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const ParameterKind kind = parameters[i].kind;
    if (kind == ParameterKind::kContact) columns.contact = i;
    if (kind == ParameterKind::kGain) columns.gain = i;
    if (kind == ParameterKind::kDelay) columns.delay = i;
    if (kind == ParameterKind::kCorner) columns.corner = i;
    for (const auto& [mode, slope] : parameters.frequency_slopes(x, i)) {
      by_mode[mode].push_back({i, slope / point.basis.omega[mode], 0.0});
    }
    for (const auto& [mode, slope] : parameters.damping_slopes(x, i)) {
      by_mode[mode].push_back({i, 0.0, slope / point.basis.zeta[mode]});
    }
  }
  columns.share_begin.push_back(0);
  for (const auto& shares : by_mode) {
    columns.shares.insert(columns.shares.end(), shares.begin(), shares.end());
    columns.share_begin.push_back(columns.shares.size());
  }
  return columns;
}

// Factors that turn the columns, by ln gain and corner in rad/s, into those of the parameters.
std::vector<double> column_units(const ParameterSet& parameters, const ModelPoint& point) {
  std::vector<double> units(parameters.size(), std::numbers::sqrt2);
  for (std::size_t i = 0; i < units.size(); ++i) {
    if (parameters[i].kind == ParameterKind::kGain) units[i] /= point.sensors.gain;
    if (parameters[i].kind == ParameterKind::kCorner) units[i] *= 2.0 * std::numbers::pi;
  }
  return units;
}

class JointLikelihoodFunction final : public ObjectiveFunction {
 public:
  JointLikelihoodFunction(ProjectedLikelihood likelihood, ParameterSet parameters)
      : likelihood_(std::move(likelihood)), parameters_(std::move(parameters)) {
    likelihood_.cost(parameters_.initial());  // an undamped mode and the like, before any search
  }
  std::string_view name() const override { return "joint_likelihood"; }
  std::size_t dimension() const override { return parameters_.size(); }
  std::size_t residual_count() const override { return 2 * likelihood_.record().bins; }
  Capabilities capabilities() const override { return {.gradient = true, .least_squares = true}; }

 private:
  void do_evaluate(std::span<const double> x, const ObjectiveOutputs& outputs) const override {
    const ModelPoint point = parameters_.model(x);
    const bool slopes = outputs.gradient != nullptr || outputs.jacobian != nullptr;
    const LikelihoodColumns columns =
        slopes ? columns_of(parameters_, x, point) : LikelihoodColumns{};
    std::vector<double> residuals(outputs.residuals ? residual_count() : 0);
    Eigen::MatrixXd jacobian;
    const LikelihoodPoint at =
        likelihood_.evaluate(point, columns,
                             {.residuals = outputs.residuals ? &residuals : nullptr,
                              .jacobian = outputs.jacobian ? &jacobian : nullptr});
    if (outputs.value) *outputs.value = at.cost;
    const std::vector<double> units = column_units(parameters_, point);
    for (std::size_t i = 0; outputs.gradient && i < dimension(); ++i) {
      outputs.gradient[i] = std::numbers::sqrt2 * units[i] * at.slope[static_cast<Eigen::Index>(i)];
    }
    for (std::size_t j = 0; j < residuals.size(); ++j) {
      outputs.residuals[j] = std::numbers::sqrt2 * residuals[j];
    }
    for (Eigen::Index j = 0; j < jacobian.rows(); ++j) {
      for (Eigen::Index i = 0; i < jacobian.cols(); ++i) {
        *(outputs.jacobian + j * jacobian.cols() + i) =
            units[static_cast<std::size_t>(i)] * jacobian(j, i);
      }
    }
  }

  ProjectedLikelihood likelihood_;
  ParameterSet parameters_;
};

}  // namespace

void JointLikelihood::Options::visit(OptionVisitor& visitor) {
  visitor.number({.key = "damping",
                  .meaning = "the records are multiplied by exp(-damping t): wide basins; 0: the "
                             "whole record, end state projected out",
                  .unit = "Hz",
                  .range = Range::non_negative()},
                 damping);
  visit_record_options(visitor, highest_frequency, left_noise, right_noise);
}

JointLikelihood::JointLikelihood(const Options& options) : options_(options) {
  MODCAL_REQUIRE(options.damping >= 0.0, "damping {:g} 1/s must be >= 0", options.damping);
}

void JointLikelihood::require_record(const ModalBasis& basis, double sample_rate,
                                     std::size_t samples) const {
  require_noise_known({options_.left_noise, options_.right_noise}, basis, sample_rate, samples);
}

std::unique_ptr<const ObjectiveFunction> JointLikelihood::do_bind(
    const CalibrationData& data, const ParameterSet& parameters) const {
  const NoisyRecords records = NoisyRecords::of_data(data, parameters.initial().basis,
                                                     {options_.left_noise, options_.right_noise});
  const double highest =
      likelihood_band(parameters.initial(), options_.highest_frequency, data.sample_rate);
  return std::make_unique<JointLikelihoodFunction>(
      ProjectedLikelihood(WhitenedRecord::of(records, options_.damping, highest)), parameters);
}

}  // namespace modcal
