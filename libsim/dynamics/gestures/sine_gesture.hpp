#pragma once

#include "libsim/dynamics/gestures/gesture.hpp"

namespace modcal {

/// g(t) = mean + amplitude sin(2π f t + phase), drawn with 128 straight pieces a period: within
/// amplitude·(2π/128)²/8 = 3e-4 amplitude of the sine. Several strokes to and fro with mean 0.
class SineGesture final : public Gesture {
 public:
  struct Options {
    double mean = 1.0;       ///< [1]
    double amplitude = 0.1;  ///< [1]
    double frequency = 5.0;  ///< f [Hz]
    double phase = 0.0;      ///< [rad]
    void visit(OptionVisitor& visitor);
  };
  explicit SineGesture(const Options& options) : options_(options) {}

 private:
  PiecewiseLinear factor(double duration) const override;
  Options options_;
};

}  // namespace modcal
