// How the string moves at t = 0.
#pragma once

#include <limits>
#include <string_view>
#include <vector>

#include "libsim/base/registry.hpp"
#include "libsim/model/modal_basis.hpp"

namespace modcal {

/// Modal displacements q_n [m] and velocities q̇_n [m/s] at t = 0; empty: at rest.
struct ModalState {
  std::vector<double> displacement;
  std::vector<double> velocity;
};

class InitialMotion {
 public:
  static constexpr std::string_view kKind = "initial";
  static Registry<InitialMotion> registry();

  virtual ~InitialMotion() = default;
  /// Modal state of the string at t = 0: empty or as many values as modes.
  virtual ModalState state(const ModalBasis& basis) const = 0;
};

/// The string lies straight and at rest.
class Rest final : public InitialMotion {
 public:
  struct Options {
    void visit(OptionVisitor& /*visitor*/) {}
  };
  explicit Rest(const Options& /*options*/) {}
  ModalState state(const ModalBasis& /*basis*/) const override { return {}; }
};

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
  ModalState state(const ModalBasis& basis) const override;

 private:
  Options options_;
};

}  // namespace modcal
