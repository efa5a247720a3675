#pragma once

#include "libsim/dynamics/gestures/gesture.hpp"

namespace modcal {

/// g(t) = 1.
class SteadyGesture final : public Gesture {
 public:
  struct Options {
    void visit(OptionVisitor& /*visitor*/) {}
  };
  explicit SteadyGesture(const Options& /*options*/) {}

 private:
  PiecewiseLinear factor(double /*duration*/) const override { return PiecewiseLinear(1.0); }
};

}  // namespace modcal
