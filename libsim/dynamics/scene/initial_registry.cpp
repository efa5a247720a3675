#include <array>

#include "libsim/dynamics/scene/pluck.hpp"
#include "libsim/dynamics/scene/rest.hpp"

namespace modcal {

Registry<InitialMotion> InitialMotion::registry() {
  static constexpr std::array kTable = {
      entry_of<InitialMotion, Pluck>("pluck", "released from a triangle"),
      entry_of<InitialMotion, Rest>("rest", "straight and at rest"),
  };
  return kTable;
}

}  // namespace modcal
