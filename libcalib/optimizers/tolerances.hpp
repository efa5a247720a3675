// When a search with slopes ends.
#pragma once

#include <cmath>

#include "libcalib/optimizers/tuning.hpp"
#include "libsim/base/options.hpp"

namespace modcal {

/// Visits the keys gradient_tolerance, step_tolerance and value_tolerance.
inline void visit_tolerances(OptionVisitor& visitor, double& gradient, double& step,
                             double& value) {
  const auto tolerance = [&visitor](std::string_view key, std::string_view meaning,
                                    double& number) {
    visitor(key, meaning, {.range = Range::non_negative()}, number);
  };
  tolerance("gradient_tolerance", "largest entry of the scaled gradient at an optimum", gradient);
  tolerance("step_tolerance", "smallest step, relative to the scaled variables", step);
  tolerance("value_tolerance", "smallest decrease, relative to the value", value);
}

/// Watches the decreases of a value. One that is small may follow from a short step after a
/// rejected one or along a bad direction, and says little about how far the optimum is; two in a
/// row do.
class SmallDecreases {
 public:
  explicit SmallDecreases(double tolerance) : tolerance_(tolerance) {}
  bool are_small(double decrease, double value) {
    in_a_row_ = decrease <= tolerance_ * std::abs(value) ? in_a_row_ + 1 : 0;
    return in_a_row_ >= kSmallDecreasesInARow;
  }

 private:
  double tolerance_;
  int in_a_row_ = 0;
};

}  // namespace modcal
