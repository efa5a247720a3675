#include "libcalib/objectives/contact_location_squares.hpp"

#include <cmath>

#include "libsim/base/error.hpp"

namespace modcal {
namespace {

class Function final : public ObjectiveFunction {
 public:
  explicit Function(TwoSidedForce force) : force_(std::move(force)) {}
  std::string_view name() const override { return "contact_location_squares"; }
  std::size_t dimension() const override { return force_.parameters().size(); }
  std::size_t residual_count() const override { return 2 * force_.bins(); }
  Capabilities capabilities() const override { return {.gradient = true, .least_squares = true}; }

 private:
  // No force at all is 0/0, not a number.
  void do_evaluate(std::span<const double> x, const ObjectiveOutputs& outputs) const override {
    const bool slopes = outputs.gradient != nullptr || outputs.jacobian != nullptr;
    const auto state = force_.at(x, slopes);
    double power = 0.0;
    for (const auto& force : state.force) {
      for (const Complex& bin : force) power += std::norm(bin);
    }
    const double scale = std::sqrt(2.0 / power);
    std::vector<Complex> r(force_.bins());
    double value = 0.0;
    for (std::size_t k = 0; k < r.size(); ++k) {
      r[k] = scale * (state.force[0][k] - state.force[1][k]);
      value += 0.5 * std::norm(r[k]);
      if (!outputs.residuals) continue;
      outputs.residuals[2 * k] = r[k].real();
      outputs.residuals[2 * k + 1] = r[k].imag();
    }
    if (outputs.value) *outputs.value = value;
    TwoSidedForce::Pair slope;
    for (std::size_t i = 0; slopes && i < dimension(); ++i) {
      force_.force_slope(state, i, slope);
      write_slopes(i, state, slope, r, scale, outputs);
    }
  }

  // dr = scale (dF_1 − dF_2) − r dP/(2P), P = ‖F_1‖² + ‖F_2‖².
  void write_slopes(std::size_t i, const TwoSidedForce::State& state,
                    const TwoSidedForce::Pair& slope, const std::vector<Complex>& r, double scale,
                    const ObjectiveOutputs& outputs) const {
    double half_power_slope = 0.0;
    for (std::size_t e = 0; e < 2; ++e) {
      for (std::size_t k = 0; k < r.size(); ++k) {
        half_power_slope += (std::conj(state.force[e][k]) * slope[e][k]).real();
      }
    }
    const double shrink = half_power_slope * 0.5 * scale * scale;  // dP/(2P)
    double gradient = 0.0;
    for (std::size_t k = 0; k < r.size(); ++k) {
      const Complex change = scale * (slope[0][k] - slope[1][k]) - shrink * r[k];
      gradient += (std::conj(r[k]) * change).real();
      if (!outputs.jacobian) continue;
      outputs.jacobian[2 * k * dimension() + i] = change.real();
      outputs.jacobian[(2 * k + 1) * dimension() + i] = change.imag();
    }
    if (outputs.gradient) outputs.gradient[i] = gradient;
  }

  TwoSidedForce force_;
};

}  // namespace

std::unique_ptr<const ObjectiveFunction> ContactLocationSquares::do_bind(
    const CalibrationData& data, const ParameterSet& parameters) const {
  MODCAL_REQUIRE(parameters.has(ParameterKind::kContact),
                 "objective \"contact_location_squares\" looks for x_c: add the contact to the "
                 "parameters");
  return std::make_unique<Function>(TwoSidedForce(data, parameters, options_.inversion));
}

}  // namespace modcal
