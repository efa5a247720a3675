#pragma once

#include "libsim/dynamics/scene/initial_motion.hpp"

namespace modcal {

/// The string lies straight and at rest.
class Rest final : public InitialMotion {
 public:
  struct Options {
    void visit(OptionVisitor& /*visitor*/) {}
  };
  explicit Rest(const Options& /*options*/) {}

 private:
  ModalState make_state(const ModalBasis& /*basis*/) const override { return {}; }
};

}  // namespace modcal
