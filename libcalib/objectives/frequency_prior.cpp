#include "libcalib/objectives/frequency_prior.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "libsim/base/error.hpp"

namespace modcal {
namespace {

struct Measured {
  std::size_t mode = 0;  // index
  double frequency = 0.0;
  double deviation = 1.0;
};

class PriorFunction final : public ObjectiveFunction {
 public:
  PriorFunction(ParameterSet parameters, std::vector<Measured> measured)
      : parameters_(std::move(parameters)), measured_(std::move(measured)) {}
  std::string_view name() const override { return "frequency_prior"; }
  std::size_t dimension() const override { return parameters_.size(); }
  std::size_t residual_count() const override { return measured_.size(); }
  Capabilities capabilities() const override { return {.gradient = true, .least_squares = true}; }

 private:
  void do_evaluate(std::span<const double> x, const ObjectiveOutputs& outputs) const override {
    const ModelPoint point = parameters_.model(x);
    std::vector<double> residuals;
    double value = 0.0;
    for (const Measured& line : measured_) {
      residuals.push_back((point.basis.frequency(line.mode) - line.frequency) / line.deviation);
      value += 0.5 * residuals.back() * residuals.back();
    }
    if (outputs.value) *outputs.value = value;
    if (outputs.residuals) std::copy(residuals.begin(), residuals.end(), outputs.residuals);
    if (!outputs.gradient && !outputs.jacobian) return;
    for (std::size_t i = 0; i < dimension(); ++i) write_slopes(x, i, residuals, outputs);
  }

  void write_slopes(std::span<const double> x, std::size_t i, const std::vector<double>& residuals,
                    const ObjectiveOutputs& outputs) const {
    std::vector<double> slope_of_mode(parameters_.initial().basis.size(), 0.0);
    for (const auto& [mode, slope] : parameters_.frequency_slopes(x, i)) {
      slope_of_mode[mode] = slope / (2.0 * std::numbers::pi);
    }
    double gradient = 0.0;
    for (std::size_t j = 0; j < measured_.size(); ++j) {
      const double change = slope_of_mode[measured_[j].mode] / measured_[j].deviation;
      gradient += change * residuals[j];
      if (outputs.jacobian) outputs.jacobian[j * dimension() + i] = change;
    }
    if (outputs.gradient) outputs.gradient[i] = gradient;
  }

  ParameterSet parameters_;
  std::vector<Measured> measured_;
};

void require_positive(const std::vector<double>& values, std::string_view what) {
  for (const double value : values) {
    MODCAL_REQUIRE(value > 0.0 && std::isfinite(value), "{} {:g} Hz must be > 0", what, value);
  }
}

}  // namespace

void FrequencyPrior::Options::visit(OptionVisitor& visitor) {
  visitor("modes", "numbers of the modes that were measured",
          {.range = Range::at_least(1), .required = true}, modes);
  visitor("frequencies", "their frequencies",
          {.unit = "Hz", .range = Range::positive(), .required = true}, frequencies);
  visitor("deviations", "the standard deviations of these",
          {.unit = "Hz", .range = Range::positive(), .required = true}, deviations);
}

FrequencyPrior::FrequencyPrior(const Options& options) : options_(options) {
  MODCAL_REQUIRE(options.frequencies.size() == options.modes.size() &&
                     options.deviations.size() == options.modes.size(),
                 "{} modes, {} frequencies and {} deviations: give one of each for every mode",
                 options.modes.size(), options.frequencies.size(), options.deviations.size());
  const std::set<std::int64_t> distinct(options.modes.begin(), options.modes.end());
  MODCAL_REQUIRE(
      distinct.size() == options.modes.size() && (distinct.empty() || *distinct.begin() >= 1),
      "modes are numbered from 1 and named once");
  require_positive(options.frequencies, "frequency");
  require_positive(options.deviations, "deviation");
}

Response FrequencyPrior::response(Moves what) const {
  return what == Moves::kFrequencies ? Response::kMoves : Response::kNone;
}

std::unique_ptr<const ObjectiveFunction> FrequencyPrior::do_bind(
    const CalibrationData& /*data*/, const ParameterSet& parameters) const {
  MODCAL_REQUIRE(!options_.modes.empty(), "a frequency_prior without modes: name at least one");
  const std::size_t modes = parameters.initial().basis.size();
  std::vector<Measured> measured;
  for (std::size_t j = 0; j < options_.modes.size(); ++j) {
    const auto n = static_cast<std::size_t>(options_.modes[j]);
    MODCAL_REQUIRE(n <= modes, "mode {} was measured, the model has {} modes", n, modes);
    measured.push_back({n - 1, options_.frequencies[j], options_.deviations[j]});
  }
  return std::make_unique<PriorFunction>(parameters, std::move(measured));
}

}  // namespace modcal
