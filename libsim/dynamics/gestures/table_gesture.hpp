#pragma once

#include <vector>

#include "libsim/dynamics/gestures/gesture.hpp"

namespace modcal {

/// g(t) linear through the points (time, factor), constant outside them.
class TableGesture final : public Gesture {
 public:
  struct Options {
    std::vector<double> times;    ///< [s], strictly rising
    std::vector<double> factors;  ///< [1], as many
    void visit(OptionVisitor& visitor);
  };
  /// Throws InvalidInput where times and factors do not pair up or the times do not rise.
  explicit TableGesture(const Options& options) : factor_(options.times, options.factors) {}

 private:
  PiecewiseLinear factor(double /*duration*/) const override { return factor_; }
  PiecewiseLinear factor_;
};

}  // namespace modcal
