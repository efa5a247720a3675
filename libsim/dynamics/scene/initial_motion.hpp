// How the string moves at t = 0.
#pragma once

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
  ModalState state(const ModalBasis& basis) const { return make_state(basis); }

 private:
  virtual ModalState make_state(const ModalBasis& basis) const = 0;
};

}  // namespace modcal
