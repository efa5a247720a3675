#include "libcalib/objectives/force_mismatch.hpp"

#include <cmath>

#include "libsim/base/error.hpp"

namespace modcal {
namespace {

std::vector<double> weights_at(const TwoSidedForce::State& state, bool by_transfer) {
  std::vector<double> weights(state.transfer[0].size(), 1.0);
  if (!by_transfer) return weights;
  for (std::size_t k = 0; k < weights.size(); ++k) {
    const double left = std::norm(state.transfer[0][k]);
    const double right = std::norm(state.transfer[1][k]);
    weights[k] = left > 0.0 && right > 0.0 ? std::sqrt(left / (left + right) * right) : 0.0;
  }
  return weights;
}

class ForceMismatchFunction final : public ObjectiveFunction {
 public:
  ForceMismatchFunction(TwoSidedForce force, bool by_transfer) : force_(std::move(force)) {
    const auto state = force_.at(force_.parameters().start(), false);
    weights_ = weights_at(state, by_transfer);
    double power = 0.0;
    for (std::size_t k = 0; k < weights_.size(); ++k) {
      power += 0.5 * weights_[k] * weights_[k] *
               (std::norm(state.force[0][k]) + std::norm(state.force[1][k]));
    }
    MODCAL_REQUIRE(power > 0.0 && std::isfinite(power),
                   "the forces identified with the initial parameters vanish in the band: nothing "
                   "can be compared");
    for (double& weight : weights_) weight /= std::sqrt(power);
  }
  std::string_view name() const override { return "force_mismatch"; }
  std::size_t dimension() const override { return force_.parameters().size(); }
  std::size_t residual_count() const override { return 2 * weights_.size(); }
  Capabilities capabilities() const override { return {.gradient = true, .least_squares = true}; }

 private:
  void do_evaluate(std::span<const double> x, const ObjectiveOutputs& outputs) const override {
    const bool slopes = outputs.gradient != nullptr || outputs.jacobian != nullptr;
    const auto state = force_.at(x, slopes);
    std::vector<Complex> mismatch(weights_.size());
    double value = 0.0;
    for (std::size_t k = 0; k < mismatch.size(); ++k) {
      mismatch[k] = weights_[k] * (state.force[0][k] - state.force[1][k]);
      value += 0.5 * std::norm(mismatch[k]);
      if (!outputs.residuals) continue;
      outputs.residuals[2 * k] = mismatch[k].real();
      outputs.residuals[2 * k + 1] = mismatch[k].imag();
    }
    if (outputs.value) *outputs.value = value;
    TwoSidedForce::Pair slope;
    for (std::size_t i = 0; slopes && i < dimension(); ++i) {
      force_.force_slope(state, i, slope);
      write_slopes(i, slope, mismatch, outputs);
    }
  }

  void write_slopes(std::size_t i, const TwoSidedForce::Pair& slope,
                    const std::vector<Complex>& mismatch, const ObjectiveOutputs& outputs) const {
    const std::size_t n = dimension();
    double gradient = 0.0;
    for (std::size_t k = 0; k < weights_.size(); ++k) {
      const Complex change = weights_[k] * (slope[0][k] - slope[1][k]);
      gradient += (std::conj(mismatch[k]) * change).real();
      if (!outputs.jacobian) continue;
      outputs.jacobian[2 * k * n + i] = change.real();
      outputs.jacobian[(2 * k + 1) * n + i] = change.imag();
    }
    if (outputs.gradient) outputs.gradient[i] = gradient;
  }

  TwoSidedForce force_;
  std::vector<double> weights_;
};

}  // namespace

void ForceMismatch::Options::visit(OptionVisitor& visitor) {
  inversion.visit(visitor);
  visitor.text({.key = "weights",
                .meaning = "weights of the bins: uniform, or transfer for equal noise in all",
                .choices = {"uniform", "transfer"}},
               weights);
}

ForceMismatch::ForceMismatch(const Options& options) : options_(options) {
  MODCAL_REQUIRE(options.weights == "uniform" || options.weights == "transfer",
                 "unknown weights \"{}\": uniform and transfer are available", options.weights);
}

std::unique_ptr<const ObjectiveFunction> ForceMismatch::do_bind(
    const CalibrationData& data, const ParameterSet& parameters) const {
  return std::make_unique<ForceMismatchFunction>(
      TwoSidedForce(data, parameters, options_.inversion), options_.weights == "transfer");
}

}  // namespace modcal
