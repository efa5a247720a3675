// Tolerances at which a search with slopes ends.
#pragma once

#include "libsim/base/options.hpp"

namespace modcal {

/// Visits the keys gradient_tolerance, step_tolerance and value_tolerance.
inline void visit_tolerances(OptionVisitor& visitor, double& gradient, double& step,
                             double& value) {
  const auto tolerance = [&visitor](std::string_view key, std::string_view meaning,
                                    double& number) {
    visitor.number({.key = key, .meaning = meaning, .unit = "1", .range = Range::non_negative()},
                   number);
  };
  tolerance("gradient_tolerance", "largest entry of the scaled gradient at an optimum", gradient);
  tolerance("step_tolerance", "smallest step, relative to the scaled variables", step);
  tolerance("value_tolerance", "smallest decrease, relative to the value", value);
}

}  // namespace modcal
