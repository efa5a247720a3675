#include "libcalib/objectives/force_difference.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libcalib/objectives/model_slopes.hpp"
#include "libsim/base/error.hpp"
#include "libsim/base/words.hpp"

namespace modcal {
namespace {

BinRange band_of(const FrequencyGrid& grid, const ModalBasis& basis,
                 const TwoSidedForceOptions& options) {
  const auto [low, high] = std::minmax_element(basis.omega.begin(), basis.omega.end());
  const double two_pi = 2.0 * std::numbers::pi;
  const double from = std::isnan(options.lowest) ? 0.5 * *low : two_pi * options.lowest;
  const double to = std::isnan(options.highest) ? 1.04 * *high : two_pi * options.highest;
  BinRange band = bins_between(grid, from, to);
  // The Nyquist bin holds only part of what a complex transfer function says.
  band.last = std::min(band.last, grid.bins - 1);
  MODCAL_REQUIRE(band.first < band.last,
                 "the band from {:g} to {:g} Hz holds no bin: bins are {:g} Hz apart",
                 from / two_pi, to / two_pi, grid.spacing / two_pi);
  return band;
}

ForceKernel kernel_of(const CalibrationData& data, const ParameterSet& parameters,
                      const TwoSidedForceOptions& options) {
  RecordBand record = band_of(data, band_of(data.grid(), parameters.initial().basis, options));
  const auto regularizer = options.regularizer.make();
  MODCAL_REQUIRE(data.has_both(),
                 "this objective compares the forces identified from the two ends: the {} reaction "
                 "is missing",
                 data.has(End::kLeft) ? "right" : "left");
  MODCAL_REQUIRE(options.parameter >= 0.0 && std::isfinite(options.parameter),
                 "regularization parameter {:g} must be finite and >= 0", options.parameter);
  return ForceKernel(std::move(record), {regularizer, options.parameter, options.common_filter});
}

enum class Weights { kUniform, kTransfer };
constexpr std::array<std::string_view, 2> kWeights = {"uniform", "transfer"};
Weights weights_of(std::string_view word) { return enum_of<Weights>(kWeights, "weights", word); }

std::vector<double> transfer_weights(const ForceKernel::State& state) {
  std::vector<double> weights(state.transfer[0].size());
  for (std::size_t k = 0; k < weights.size(); ++k) {
    const double left = std::norm(state.transfer[0][k]);
    const double right = std::norm(state.transfer[1][k]);
    weights[k] = left > 0.0 && right > 0.0 ? std::sqrt(left / (left + right) * right) : 0.0;
  }
  return weights;
}

// r = w (F_1 − F_2)/√P, P = ½ Σ w² (|F_1|² + |F_2|²), of the initial parameters or of each point.
class ForceDifference final : public ObjectiveFunction {
 public:
  enum class Power { kOfStart, kOfPoint };
  // kRoot: √‖r‖² in place of ½ ‖r‖².
  enum class Value { kHalfSquare, kRoot };

  ForceDifference(std::string_view name, ForceKernel kernel, const ParameterSet& parameters,
                  Power power, Value value)
      : name_(name),
        kernel_(std::move(kernel)),
        parameters_(parameters),
        power_(power),
        value_(value),
        weights_(kernel_.record().bins.size(), 1.0) {}

  void weigh_and_scale_at_start(bool by_transfer) {
    const auto state =
        kernel_.at(end_reactions(parameters_.model(parameters_.start())), /*with_slopes=*/false);
    if (by_transfer) weights_ = transfer_weights(state);
    const double power = power_of(state);
    MODCAL_REQUIRE(power > 0.0 && std::isfinite(power),
                   "the forces identified with the initial parameters vanish in the band: nothing "
                   "can be compared");
    for (double& weight : weights_) weight /= std::sqrt(power);
  }

  std::string_view name() const override { return name_; }
  std::size_t dimension() const override { return parameters_.size(); }
  std::size_t residual_count() const override {
    return value_ == Value::kRoot ? 0 : 2 * weights_.size();
  }
  Capabilities capabilities() const override {
    return {.gradient = true, .least_squares = value_ != Value::kRoot};
  }

 private:
  double power_of(const ForceKernel::State& state) const {
    double power = 0.0;
    for (std::size_t k = 0; k < weights_.size(); ++k) {
      power += 0.5 * weights_[k] * weights_[k] *
               (std::norm(state.force[0][k]) + std::norm(state.force[1][k]));
    }
    return power;
  }

  // No force at all is 0/0, not a number.
  void do_evaluate(std::span<const double> x, const ObjectiveOutputs& outputs) const override {
    const bool slopes = outputs.gradient != nullptr || outputs.jacobian != nullptr;
    const auto state = kernel_.at(end_reactions(parameters_.model(x)), slopes);
    const double power = power_ == Power::kOfPoint ? power_of(state) : 1.0;
    const double scale = 1.0 / std::sqrt(power);
    std::vector<Complex> r(weights_.size());
    double value = 0.0;
    for (std::size_t k = 0; k < r.size(); ++k) {
      r[k] = scale * weights_[k] * (state.force[0][k] - state.force[1][k]);
      value += 0.5 * std::norm(r[k]);
      if (!outputs.residuals) continue;
      outputs.residuals[2 * k] = r[k].real();
      outputs.residuals[2 * k + 1] = r[k].imag();
    }
    if (value_ == Value::kRoot) value = std::sqrt(2.0 * value);
    if (outputs.value) *outputs.value = value;
    if (!slopes) return;
    const ModelSlopes model(parameters_, x, kernel_.record());
    SensorSpectra slope;
    for (std::size_t i = 0; i < dimension(); ++i) {
      model.write(i, slope);
      kernel_.force_slope(state, slope);
      const double gradient = write_slopes(i, state, slope, r, power, outputs);
      if (!outputs.gradient) continue;
      outputs.gradient[i] = value_ != Value::kRoot ? gradient
                            : value == 0.0         ? 0.0
                                                   : gradient / value;
    }
  }

  // dr = w (dF_1 − dF_2)/√P − r dP/(2P); returns Σ Re(r* dr).
  double write_slopes(std::size_t i, const ForceKernel::State& state, const SensorSpectra& slope,
                      const std::vector<Complex>& r, double power,
                      const ObjectiveOutputs& outputs) const {
    double power_slope = 0.0;
    for (std::size_t k = 0; power_ == Power::kOfPoint && k < r.size(); ++k) {
      for (std::size_t e = 0; e < 2; ++e) {
        power_slope +=
            weights_[k] * weights_[k] * (std::conj(state.force[e][k]) * slope[e][k]).real();
      }
    }
    const double scale = 1.0 / std::sqrt(power), shrink = 0.5 * power_slope / power;
    double gradient = 0.0;
    for (std::size_t k = 0; k < r.size(); ++k) {
      const Complex change = scale * weights_[k] * (slope[0][k] - slope[1][k]) - shrink * r[k];
      gradient += (std::conj(r[k]) * change).real();
      if (!outputs.jacobian) continue;
      outputs.jacobian[2 * k * dimension() + i] = change.real();
      outputs.jacobian[(2 * k + 1) * dimension() + i] = change.imag();
    }
    return gradient;
  }

  std::string_view name_;
  ForceKernel kernel_;
  ParameterSet parameters_;
  Power power_;
  Value value_;
  std::vector<double> weights_;
};

std::unique_ptr<const ObjectiveFunction> bind_contact_location(
    std::string_view name, ForceDifference::Value value, const CalibrationData& data,
    const ParameterSet& parameters, const TwoSidedForceOptions& options) {
  MODCAL_REQUIRE(parameters.has(ParameterKind::kContact),
                 "objective \"{}\" looks for x_c: add the contact to the parameters", name);
  return std::make_unique<ForceDifference>(name, kernel_of(data, parameters, options), parameters,
                                           ForceDifference::Power::kOfPoint, value);
}

}  // namespace

void TwoSidedForceOptions::visit(OptionVisitor& visitor) {
  visitor("regularizer", "filter of the inversions that are compared", regularizer);
  visitor("parameter", "regularization parameter, in the unit of the transfer function",
          {.range = Range::non_negative()}, parameter);
  visitor("common_filter", "filter both forces alike, so that only the model makes a difference",
          common_filter);
  visitor("lowest_frequency", "lower end of the band compared; automatic: half the lowest mode's",
          {.unit = "Hz", .range = Range::non_negative(), .word = "automatic"}, lowest);
  visitor("highest_frequency",
          "upper end of the band compared; automatic: 4 % above the highest mode",
          {.unit = "Hz", .range = Range::positive(), .word = "automatic"}, highest);
}

void ForceMismatch::Options::visit(OptionVisitor& visitor) {
  inversion.visit(visitor);
  visitor("weights", "weights of the bins: uniform, or transfer for equal noise in all",
          {.choices = choices_of(kWeights)}, weights);
}

ForceMismatch::ForceMismatch(const Options& options) : options_(options) {
  weights_of(options.weights);
}

std::unique_ptr<const ObjectiveFunction> ForceMismatch::do_bind(
    const CalibrationData& data, const ParameterSet& parameters) const {
  auto function = std::make_unique<ForceDifference>(
      "force_mismatch", kernel_of(data, parameters, options_.inversion), parameters,
      ForceDifference::Power::kOfStart, ForceDifference::Value::kHalfSquare);
  function->weigh_and_scale_at_start(weights_of(options_.weights) == Weights::kTransfer);
  return function;
}

std::unique_ptr<const ObjectiveFunction> ContactLocationSquares::do_bind(
    const CalibrationData& data, const ParameterSet& parameters) const {
  return bind_contact_location("contact_location_squares", ForceDifference::Value::kHalfSquare,
                               data, parameters, options_.inversion);
}

std::unique_ptr<const ObjectiveFunction> ContactLocation::do_bind(
    const CalibrationData& data, const ParameterSet& parameters) const {
  return bind_contact_location("contact_location", ForceDifference::Value::kRoot, data, parameters,
                               options_.inversion);
}

}  // namespace modcal
