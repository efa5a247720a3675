#pragma once

#include "libsim/dynamics/gestures/gesture.hpp"

namespace modcal {

/// g(t) = from until `start`, then linear to `to` over `duration`, then to.
class RampGesture final : public Gesture {
 public:
  struct Options {
    double from = 0.0;      ///< [1]
    double to = 1.0;        ///< [1]
    double start = 0.0;     ///< [s]
    double duration = 0.1;  ///< [s]
    void visit(OptionVisitor& visitor);
  };
  explicit RampGesture(const Options& options) : options_(options) {}

 private:
  PiecewiseLinear factor(double duration) const override;
  Options options_;
};

}  // namespace modcal
