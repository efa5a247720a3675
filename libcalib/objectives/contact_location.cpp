#include "libcalib/objectives/contact_location.hpp"

#include <cmath>

#include "libsim/base/error.hpp"

namespace modcal {
namespace {

double power_of(const std::vector<Complex>& spectrum) {
  double sum = 0.0;
  for (const Complex& value : spectrum) sum += std::norm(value);
  return sum;
}

double product_of(const std::vector<Complex>& a, const std::vector<Complex>& b) {
  double sum = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += (std::conj(a[k]) * b[k]).real();
  return sum;
}

std::vector<Complex> difference_of(const TwoSidedForce::Pair& pair) {
  std::vector<Complex> difference(pair[0].size());
  for (std::size_t k = 0; k < difference.size(); ++k) difference[k] = pair[0][k] - pair[1][k];
  return difference;
}

class ContactLocationFunction final : public ObjectiveFunction {
 public:
  explicit ContactLocationFunction(TwoSidedForce force) : force_(std::move(force)) {}
  std::string_view name() const override { return "contact_location"; }
  std::size_t dimension() const override { return force_.parameters().size(); }
  Capabilities capabilities() const override { return {.gradient = true}; }

 private:
  // value = √(2 N/P), N = ‖F_1 − F_2‖², P = ‖F_1‖² + ‖F_2‖²; 0/0, no force at all, is not a number.
  void do_evaluate(std::span<const double> x, const ObjectiveOutputs& outputs) const override {
    const auto state = force_.at(x, outputs.gradient != nullptr);
    const std::vector<Complex> difference = difference_of(state.force);
    const double distance = power_of(difference);
    const double power = power_of(state.force[0]) + power_of(state.force[1]);
    const double value = std::sqrt(2.0 * distance / power);
    if (outputs.value) *outputs.value = value;
    TwoSidedForce::Pair slope;
    for (std::size_t i = 0; outputs.gradient && i < dimension(); ++i) {
      outputs.gradient[i] = 0.0;
      if (distance == 0.0) continue;
      force_.force_slope(state, i, slope);
      const double distance_slope = product_of(difference, difference_of(slope));
      const double power_slope =
          product_of(state.force[0], slope[0]) + product_of(state.force[1], slope[1]);
      outputs.gradient[i] = value * (distance_slope / distance - power_slope / power);
    }
  }

  TwoSidedForce force_;
};

}  // namespace

std::unique_ptr<const ObjectiveFunction> ContactLocation::do_bind(
    const CalibrationData& data, const ParameterSet& parameters) const {
  MODCAL_REQUIRE(parameters.has(ParameterKind::kContact),
                 "objective \"contact_location\" looks for x_c: add the contact to the parameters");
  return std::make_unique<ContactLocationFunction>(
      TwoSidedForce(data, parameters, options_.inversion));
}

}  // namespace modcal
