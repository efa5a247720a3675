#pragma once

#include <limits>

#include "libsim/dynamics/scene/initial_motion.hpp"

namespace modcal {

/// The string is released at t = 0 from the triangle with its corner at x_p, of height h, rounded
/// as by a plectrum of width w that presses evenly on the flexible string:
/// q_n = 2 h L²/(n²π² x_p (L − x_p)) sin(nπx_p/L) sinc(n w/(2L)), sinc(u) = sin(πu)/(πu)
/// (Fletcher and Rossing, 1998, section 2.8, for w = 0); 0 < x_p < L, w/2 within the nearer end.
class Pluck final : public InitialMotion {
 public:
  struct Options {
    double position = std::numeric_limits<double>::quiet_NaN();      ///< x_p [m]
    double displacement = std::numeric_limits<double>::quiet_NaN();  ///< h [m]
    double width = 0.0;                                              ///< w [m]
    void visit(OptionVisitor& visitor);
  };
  explicit Pluck(const Options& options) : options_(options) {}

 private:
  ModalState make_state(const ModalBasis& basis) const override;
  Options options_;
};

}  // namespace modcal
