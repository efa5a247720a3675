#include "libinverse/spectral/choices/fixed_parameter.hpp"

#include <cmath>

#include "libsim/base/error.hpp"

namespace modcal {

void FixedParameter::Options::visit(OptionVisitor& visitor) {
  visitor.number({.key = "value",
                  .meaning = "regularization parameter, in the unit of the transfer function",
                  .unit = "1",
                  .range = Range::non_negative(),
                  .required = true},
                 value);
  curve.visit(visitor);
}

FixedParameter::FixedParameter(const Options& options)
    : ParameterChoice(options.curve, 0), value_(options.value) {
  MODCAL_REQUIRE(value_ >= 0.0 && std::isfinite(value_),
                 "fixed regularization parameter {:g} must be a finite number >= 0", value_);
}

ParameterChoice::Pick FixedParameter::pick(const Regularizer& /*regularizer*/,
                                           const SpectralData& /*data*/,
                                           std::span<CurvePoint> /*curve*/) const {
  return {value_, ChoiceStatus::kGiven, "the parameter was given"};
}

}  // namespace modcal
