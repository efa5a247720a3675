// Unsteadiness of the player's hand: band-limited noise on a gesture.
#pragma once

#include <cstdint>

#include "libsim/base/options.hpp"
#include "libsim/base/random.hpp"
#include "libsim/dynamics/gestures/piecewise_linear.hpp"

namespace modcal {

/// Multiplies a gesture by 1 + level·n(t), n being Gaussian noise of variance 1, white below the
/// cutoff and 0 above: independent draws w_j at the Nyquist rate 2 f_cut with the Lanczos-windowed
/// sinc between them, n(t) = Σ_j w_j sinc(2 f_cut t − j) sinc((2 f_cut t − j)/8), drawn with 8
/// straight pieces a draw. The draws depend on seed and index alone: a longer record starts with
/// the same noise.
struct GestureNoise {
  bool present = false;
  double level = 0.01;   ///< standard deviation over the nominal value [1]
  double cutoff = 20.0;  ///< f_cut [Hz]
  std::int64_t seed = 1;
  void visit(OptionVisitor& visitor);

  /// 1 + level·n(t) on [0, duration] [s]; 1 where not present. `role` names the stream, so that
  /// velocity and force of one seed have draws of their own.
  PiecewiseLinear factor(double duration, std::string_view role) const;
};

}  // namespace modcal
